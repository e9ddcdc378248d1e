"""Many solves at once: a batch that does not wait for its slowest, on every device."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, PartitionSpec
from jaxtyping import Array, Bool, Float, Int, PyTree

from symjax.l2e.solvers.base import Minimum, Solver, State, solve

WIDTH = 256  # lanes that step together: their matrix products are then of a size that runs at full speed
REFILL = 32  # lanes that are exchanged together, and that the last stragglers are gathered into

Parameters: TypeAlias = PyTree
Make = Callable[[Parameters], Solver]


class _Slots(NamedTuple):
    """The lanes that step together.

    Attributes:
        lane: number of the lane in each slot; past the last lane for none.
        state: its solver's state.
        next: the first lane that has not begun.
        found: what every lane has found so far.
    """

    lane: Int[Array, "w"]
    state: State
    next: Int[Array, ""]
    found: Minimum


def solve_lanes(make: Make, parameters: Parameters, starts: Float[Array, "lanes d"]) -> Minimum:
    """Solves from many starts, `vmap(solve)` with another order of work.

    Under `vmap` a while loop goes on until its slowest lane is done. Here `WIDTH` lanes step together, and whenever
    `REFILL` of them are done others take their slots.

    Args:
        make: gives the solver of a lane from its parameters.
        parameters: what differs between lanes besides the start, in leading axes.
        starts: the starts.
    """
    num = len(starts)

    def alone(parameters: Parameters, start: Float[Array, "d"]) -> Minimum:
        return solve(make(parameters), start)

    if num <= REFILL:
        return jax.vmap(alone)(parameters, starts)
    width = min(WIDTH, -(-num // REFILL) * REFILL)

    finish = jax.vmap(lambda parameters, state: make(parameters).finish(state))

    def of(lane: Int[Array, "k"]) -> Parameters:
        return jax.tree.map(lambda leaf: leaf[jnp.minimum(lane, num - 1)], parameters)

    def init(lane: Int[Array, "k"]) -> State:
        begin = jax.vmap(lambda parameters, start: make(parameters).init(start))
        return begin(of(lane), starts[jnp.minimum(lane, num - 1)])

    def going(lane: Int[Array, "k"], state: State) -> Bool[Array, "k"]:
        return (lane < num) & jax.vmap(lambda parameters, state: make(parameters).going(state))(of(lane), state)

    def write(slots: _Slots) -> Minimum:
        new = finish(of(slots.lane), slots.state)
        return jax.tree.map(lambda whole, part: whole.at[slots.lane].set(part, mode="drop"), slots.found, new)

    def run(slots: _Slots, until: Int[Array, ""] | int) -> _Slots:
        """Steps until at most so many lanes go on."""
        own = of(slots.lane)

        def step(state: State) -> State:
            stepped = jax.vmap(lambda parameters, state: make(parameters).step(state))(own, state)
            on = going(slots.lane, state)
            return jax.tree.map(lambda a, b: jnp.where(on.reshape(-1, *[1] * (a.ndim - 1)), a, b), stepped, state)

        def more(state: State) -> Bool[Array, ""]:
            return jnp.sum(going(slots.lane, state)) > until

        return slots._replace(state=jax.lax.while_loop(more, step, slots.state))

    def going_first(slots: _Slots) -> _Slots:
        order = jnp.argsort(~going(slots.lane, slots.state), stable=True)
        return slots._replace(**jax.tree.map(lambda leaf: leaf[order], {"lane": slots.lane, "state": slots.state}))

    def exchange(slots: _Slots) -> _Slots:
        """Steps until `REFILL` lanes are done, writes them down, and begins as many others."""
        slots = run(slots, jnp.where(slots.next < num, width - REFILL, REFILL))
        slots = going_first(slots._replace(found=write(slots)))
        lane = slots.next + jnp.arange(REFILL)
        # past the last lane the slots stay idle
        new = jax.tree.map(lambda leaf, last: leaf.at[-REFILL:].set(last), slots.state, init(lane))
        return slots._replace(lane=slots.lane.at[-REFILL:].set(lane), state=new, next=slots.next + REFILL)

    def blank(shape: jax.ShapeDtypeStruct) -> Array:
        return jnp.zeros((num, *shape.shape[1:]), shape.dtype)

    lane = jnp.arange(width)
    state = init(lane)
    found = jax.tree.map(blank, jax.eval_shape(finish, of(lane), state))
    slots = _Slots(lane, state, jnp.asarray(width), found)
    # one round more than there are lanes to begin: it runs until the stragglers fit into REFILL slots
    rounds = -(-(num - width) // REFILL) + 1
    slots = jax.lax.fori_loop(0, rounds, lambda _, slots: exchange(slots), slots)
    last = slots._replace(**jax.tree.map(lambda leaf: leaf[:REFILL], {"lane": slots.lane, "state": slots.state}))
    return write(run(last, 0))


def sharded(make: Make, parameters: Parameters, starts: Float[Array, "lanes d"]) -> Minimum:
    """`solve_lanes` with the lanes dealt out to all devices that JAX sees."""
    devices = jax.devices()
    if len(devices) == 1 or len(starts) < len(devices):
        return solve_lanes(make, parameters, starts)
    extra = -len(starts) % len(devices)
    mesh = Mesh(np.asarray(devices), ("lane",))

    def deal(leaf: Array) -> Array:
        """Lane by lane in turn: neighbours, which are alike in cost, go to different devices."""
        padded = jnp.concatenate([leaf, leaf[:extra]])
        return padded.reshape(-1, len(devices), *leaf.shape[1:]).swapaxes(0, 1)

    def collect(leaf: Array) -> Array:
        return leaf.swapaxes(0, 1).reshape(-1, *leaf.shape[2:])[: len(starts)]

    def on_one(parameters: Parameters, starts: Float[Array, "1 lanes d"]) -> Minimum:
        found = solve_lanes(make, jax.tree.map(lambda leaf: leaf[0], parameters), starts[0])
        return jax.tree.map(lambda leaf: leaf[None], found)

    spec = PartitionSpec("lane")
    split = jax.shard_map(on_one, mesh=mesh, in_specs=(spec, spec), out_specs=spec, check_vma=False)
    return jax.tree.map(collect, split(*jax.tree.map(deal, (parameters, starts))))
