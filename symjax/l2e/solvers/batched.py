"""Runs many solves together: batches that do not wait for their slowest solve, on all devices."""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, PartitionSpec
from jaxtyping import Array, Bool, Float, Int, PyTree

from symjax.l2e.solvers.base import Solver, State, solve

NUM_SLOTS = 256  # solves that step together: large enough that their matrix products run at full speed
NUM_REFILLED = 32  # slots that are refilled together; the last unfinished solves continue in this many slots

Parameters: TypeAlias = PyTree
SolverFactory = Callable[[Parameters], Solver]


class _Slots(NamedTuple):
    """The slots of a batch, and the results so far.

    Attributes:
        row: index of the solve in each slot. An index past the last solve marks an idle slot.
        state: state of the solver in each slot.
        next: index of the next solve to begin.
        results: result of every solve so far.
    """

    row: Int[Array, " w"]
    state: State
    next: Int[Array, ""]
    results: Any


def solve_batch(make: SolverFactory, parameters: Parameters, starts: Float[Array, "n d"]) -> Any:
    """Solves from many starts. The results are those of `vmap(solve)`, but the work is scheduled differently.

    Under `vmap` a while loop runs until its slowest solve is done. Here `NUM_SLOTS` solves step together, and as soon
    as `NUM_REFILLED` of them are done, new solves take their slots.

    Args:
        make: makes the solver from its parameters.
        parameters: parameters of the solvers, stacked along leading axes.
        starts: the starts.

    Returns:
        The results of the solvers' `finish`, stacked along leading axes.
    """
    num = len(starts)

    def alone(parameters: Parameters, start: Float[Array, " d"]) -> Any:
        return solve(make(parameters), start)

    if num <= NUM_REFILLED:
        return jax.vmap(alone)(parameters, starts)
    num_slots = min(NUM_SLOTS, -(-num // NUM_REFILLED) * NUM_REFILLED)

    init: Callable[[Parameters, Array], State] = jax.vmap(lambda p, start: make(p).init(start))
    should_continue: Callable[[Parameters, State], Array] = jax.vmap(lambda p, state: make(p).should_continue(state))
    step: Callable[[Parameters, State], State] = jax.vmap(lambda p, state: make(p).step(state))
    finish: Callable[[Parameters, State], Any] = jax.vmap(lambda p, state: make(p).finish(state))

    def parameters_of(row: Int[Array, " k"]) -> Parameters:
        return jax.tree.map(lambda leaf: leaf[jnp.minimum(row, num - 1)], parameters)

    def begin(row: Int[Array, " k"]) -> State:
        return init(parameters_of(row), starts[jnp.minimum(row, num - 1)])

    def is_active(row: Int[Array, " k"], state: State) -> Bool[Array, " k"]:
        return (row < num) & should_continue(parameters_of(row), state)

    def updated_results(slots: _Slots) -> Any:
        new = finish(parameters_of(slots.row), slots.state)
        return jax.tree.map(lambda whole, part: whole.at[slots.row].set(part, mode="drop"), slots.results, new)

    def run(slots: _Slots, max_active: Int[Array, ""] | int) -> _Slots:
        """Steps until at most `max_active` solves are active."""
        own = parameters_of(slots.row)

        def step_active(state: State) -> State:
            stepped = step(own, state)
            active = is_active(slots.row, state)
            return jax.tree.map(lambda a, b: jnp.where(active.reshape(-1, *[1] * (a.ndim - 1)), a, b), stepped, state)

        def too_many_active(state: State) -> Bool[Array, ""]:
            return jnp.sum(is_active(slots.row, state)) > max_active

        return slots._replace(state=jax.lax.while_loop(too_many_active, step_active, slots.state))

    def active_first(slots: _Slots) -> _Slots:
        order = jnp.argsort(~is_active(slots.row, slots.state), stable=True)
        return slots._replace(**jax.tree.map(lambda leaf: leaf[order], {"row": slots.row, "state": slots.state}))

    def refill(slots: _Slots) -> _Slots:
        """Steps until `NUM_REFILLED` solves are done, stores their results, and begins as many new solves."""
        slots = run(slots, jnp.where(slots.next < num, num_slots - NUM_REFILLED, NUM_REFILLED))
        slots = active_first(slots._replace(results=updated_results(slots)))
        row = slots.next + jnp.arange(NUM_REFILLED)
        # slots past the last solve stay idle
        new = jax.tree.map(lambda leaf, last: leaf.at[-NUM_REFILLED:].set(last), slots.state, begin(row))
        return slots._replace(row=slots.row.at[-NUM_REFILLED:].set(row), state=new, next=slots.next + NUM_REFILLED)

    def blank(shape: jax.ShapeDtypeStruct) -> Array:
        return jnp.zeros((num, *shape.shape[1:]), shape.dtype)

    row = jnp.arange(num_slots)
    state = begin(row)
    results = jax.tree.map(blank, jax.eval_shape(finish, parameters_of(row), state))
    slots = _Slots(row, state, jnp.asarray(num_slots), results)
    # the last round has no solves to begin: it runs until the unfinished ones fit into the refilled slots
    rounds = -(-(num - num_slots) // NUM_REFILLED) + 1
    slots = jax.lax.fori_loop(0, rounds, lambda _, slots: refill(slots), slots)
    last = slots._replace(**jax.tree.map(lambda leaf: leaf[:NUM_REFILLED], {"row": slots.row, "state": slots.state}))
    return updated_results(run(last, 0))


def solve_sharded(make: SolverFactory, parameters: Parameters, starts: Float[Array, "n d"]) -> Any:
    """Runs `solve_batch` with the solves distributed over all devices that JAX sees."""
    devices = jax.devices()
    if len(devices) == 1 or len(starts) < len(devices):
        return solve_batch(make, parameters, starts)
    extra = -len(starts) % len(devices)
    mesh = Mesh(np.asarray(devices), ("device",))

    def deal(leaf: Array) -> Array:
        """Distributes the solves in turn, so that neighbours, which have similar cost, run on different devices."""
        padded = jnp.concatenate([leaf, leaf[:extra]])
        return padded.reshape(-1, len(devices), *leaf.shape[1:]).swapaxes(0, 1)

    def collect(leaf: Array) -> Array:
        return leaf.swapaxes(0, 1).reshape(-1, *leaf.shape[2:])[: len(starts)]

    def on_one(parameters: Parameters, starts: Float[Array, "1 n d"]) -> Any:
        found = solve_batch(make, jax.tree.map(lambda leaf: leaf[0], parameters), starts[0])
        return jax.tree.map(lambda leaf: leaf[None], found)

    partition: Callable[[str], PartitionSpec] = PartitionSpec  # its constructor is not annotated
    spec = partition("device")
    split = jax.shard_map(on_one, mesh=mesh, in_specs=(spec, spec), out_specs=spec, check_vma=False)
    return jax.tree.map(collect, split(*jax.tree.map(deal, (parameters, starts))))
