"""Many solves at once: a batch that does not wait for its slowest, on every device."""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, PartitionSpec
from jaxtyping import Array, Bool, Float, Int, PyTree

from symjax.l2e.solvers.base import Solver, State, solve

NUM_SLOTS = 256  # solves that step together: their matrix products are then of a size that runs at full speed
NUM_REFILLED = 32  # slots that are exchanged together, and that the last stragglers are gathered into

Parameters: TypeAlias = PyTree
Make = Callable[[Parameters], Solver]


class _Slots(NamedTuple):
    """The slots of the batch, and what is found.

    Attributes:
        row: number of the solve in each slot; past the last solve for none.
        state: its solver's state.
        next: the first solve that has not begun.
        found: what every solve has found so far.
    """

    row: Int[Array, " w"]
    state: State
    next: Int[Array, ""]
    found: Any


def solve_batch(make: Make, parameters: Parameters, starts: Float[Array, "n d"]) -> Any:
    """Solves from many starts: `vmap(solve)` with another order of work.

    Under `vmap` a while loop goes on until its slowest solve is done. Here `NUM_SLOTS` solves step together, and
    whenever `NUM_REFILLED` of them are done others take their slots.

    Args:
        make: gives the solver from its parameters.
        parameters: what differs between the solves besides the start, in leading axes.
        starts: the starts.
    """
    num = len(starts)

    def alone(parameters: Parameters, start: Float[Array, " d"]) -> Any:
        return solve(make(parameters), start)

    if num <= NUM_REFILLED:
        return jax.vmap(alone)(parameters, starts)
    num_slots = min(NUM_SLOTS, -(-num // NUM_REFILLED) * NUM_REFILLED)

    finish = jax.vmap(lambda parameters, state: make(parameters).finish(state))

    def parameters_of(row: Int[Array, " k"]) -> Parameters:
        return jax.tree.map(lambda leaf: leaf[jnp.minimum(row, num - 1)], parameters)

    def init(row: Int[Array, " k"]) -> State:
        begin = jax.vmap(lambda parameters, start: make(parameters).init(start))
        return begin(parameters_of(row), starts[jnp.minimum(row, num - 1)])

    def going(row: Int[Array, " k"], state: State) -> Bool[Array, " k"]:
        return (row < num) & jax.vmap(lambda parameters, state: make(parameters).going(state))(
            parameters_of(row), state
        )

    def write(slots: _Slots) -> Any:
        new = finish(parameters_of(slots.row), slots.state)
        return jax.tree.map(lambda whole, part: whole.at[slots.row].set(part, mode="drop"), slots.found, new)

    def run(slots: _Slots, until: Int[Array, ""] | int) -> _Slots:
        """Steps until at most `until` solves go on."""
        own = parameters_of(slots.row)

        def step(state: State) -> State:
            stepped = jax.vmap(lambda parameters, state: make(parameters).step(state))(own, state)
            on = going(slots.row, state)
            return jax.tree.map(lambda a, b: jnp.where(on.reshape(-1, *[1] * (a.ndim - 1)), a, b), stepped, state)

        def more(state: State) -> Bool[Array, ""]:
            return jnp.sum(going(slots.row, state)) > until

        return slots._replace(state=jax.lax.while_loop(more, step, slots.state))

    def going_first(slots: _Slots) -> _Slots:
        order = jnp.argsort(~going(slots.row, slots.state), stable=True)
        return slots._replace(**jax.tree.map(lambda leaf: leaf[order], {"row": slots.row, "state": slots.state}))

    def exchange(slots: _Slots) -> _Slots:
        """Steps until `NUM_REFILLED` solves are done, writes them down, and begins as many others."""
        slots = run(slots, jnp.where(slots.next < num, num_slots - NUM_REFILLED, NUM_REFILLED))
        slots = going_first(slots._replace(found=write(slots)))
        row = slots.next + jnp.arange(NUM_REFILLED)
        # past the last solve the slots stay idle
        new = jax.tree.map(lambda leaf, last: leaf.at[-NUM_REFILLED:].set(last), slots.state, init(row))
        return slots._replace(row=slots.row.at[-NUM_REFILLED:].set(row), state=new, next=slots.next + NUM_REFILLED)

    def blank(shape: jax.ShapeDtypeStruct) -> Array:
        return jnp.zeros((num, *shape.shape[1:]), shape.dtype)

    row = jnp.arange(num_slots)
    state = init(row)
    found = jax.tree.map(blank, jax.eval_shape(finish, parameters_of(row), state))
    slots = _Slots(row, state, jnp.asarray(num_slots), found)
    # one round more than there are solves to begin: it runs until the stragglers fit into the refilled slots
    rounds = -(-(num - num_slots) // NUM_REFILLED) + 1
    slots = jax.lax.fori_loop(0, rounds, lambda _, slots: exchange(slots), slots)
    last = slots._replace(**jax.tree.map(lambda leaf: leaf[:NUM_REFILLED], {"row": slots.row, "state": slots.state}))
    return write(run(last, 0))


def solve_sharded(make: Make, parameters: Parameters, starts: Float[Array, "n d"]) -> Any:
    """`solve_batch` with the solves dealt out to all devices that JAX sees."""
    devices = jax.devices()
    if len(devices) == 1 or len(starts) < len(devices):
        return solve_batch(make, parameters, starts)
    extra = -len(starts) % len(devices)
    mesh = Mesh(np.asarray(devices), ("device",))

    def deal(leaf: Array) -> Array:
        """Solve by solve in turn: neighbours, which are alike in cost, go to different devices."""
        padded = jnp.concatenate([leaf, leaf[:extra]])
        return padded.reshape(-1, len(devices), *leaf.shape[1:]).swapaxes(0, 1)

    def collect(leaf: Array) -> Array:
        return leaf.swapaxes(0, 1).reshape(-1, *leaf.shape[2:])[: len(starts)]

    def on_one(parameters: Parameters, starts: Float[Array, "1 n d"]) -> Any:
        found = solve_batch(make, jax.tree.map(lambda leaf: leaf[0], parameters), starts[0])
        return jax.tree.map(lambda leaf: leaf[None], found)

    spec = PartitionSpec("device")
    split = jax.shard_map(on_one, mesh=mesh, in_specs=(spec, spec), out_specs=spec, check_vma=False)
    return jax.tree.map(collect, split(*jax.tree.map(deal, (parameters, starts))))
