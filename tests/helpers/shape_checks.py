"""Run-time checks of the type and shape annotations of symjax, switched on in the tests only.

The import hook of jaxtyping checks functions and dataclasses. It ignores named tuples, and annotations in quotes whose
names it cannot resolve at once, such as those that are imported only for type checkers. Both are added here.
"""

import ast
import functools
import inspect
import sys
import typing
from contextlib import contextmanager
from typing import Annotated, Any

import beartype
import jaxtyping
import numpy as np
import pytest
from beartype.door import is_bearable
from beartype.vale import Is

CHECKER = "beartype.beartype(conf=beartype.BeartypeConf(is_pep484_tower=True))"
"""Accepts an int for a float, as mypy does."""

CONF = beartype.BeartypeConf(is_pep484_tower=True)

UNCHECKED_CALLERS = ("jax", "equinox")
"""Packages that build named tuples as pytrees, with leaves that are placeholders, such as None or `object()`."""

UNCHECKED_MODULES = (
    "symjax.l2e.criterion",
    "symjax.l2e.features",
    "symjax.l2e.manifolds",
    "symjax.l2e.pairs.normalised",
    "symjax.l2e.solvers",
    "symjax.l2e.starts",
    "symjax.robust.refinement",
    "symjax.robust.registration",
)
"""Modules of compiled code. Their named tuples are annotated for one problem, and also hold batches of problems, or
arrays that are still on the host."""

_raises = pytest.raises
_jaxtyped = jaxtyping.jaxtyped


def install() -> None:
    """Switches the checks on for all modules of symjax that are imported afterwards."""
    jaxtyping.jaxtyped = _checked
    jaxtyping.install_import_hook(["symjax"], CHECKER)
    pytest.raises = raises_unchecked


@contextmanager
def raises_unchecked(*args, **options):
    """Runs `pytest.raises` without the checks, so that a wrong argument raises the error that users see."""
    with _raises(*args, **options) as caught:
        jaxtyping.config.update("jaxtyping_disable", True)
        try:
            yield caught
        finally:
            jaxtyping.config.update("jaxtyping_disable", False)


def _checked(*args, typechecker):
    """The decorator that the import hook adds to every function and class, in place of `jaxtyping.jaxtyped`."""
    decorate = _jaxtyped(typechecker=typechecker)

    def add_checks(item):
        if getattr(item, "__module__", "").split(".")[0] == "symjax" or isinstance(
            item, (classmethod, staticmethod, property)
        ):
            for function in _functions(item):
                _resolve_when_called(function)
            if _is_named_tuple(item) and not item.__module__.startswith(UNCHECKED_MODULES):
                _check_construction(item, decorate)
        return decorate(item)

    return add_checks(*args) if args else add_checks


def _functions(item):
    """Returns the functions that `jaxtyping.jaxtyped` checks when it decorates an item."""
    if inspect.isclass(item):
        return [item.__init__] if hasattr(item, "__dataclass_fields__") else []
    if isinstance(item, property):
        return [function for function in (item.fget, item.fset, item.fdel) if function is not None]
    return [getattr(item, "__func__", item)]


def _resolve_when_called(function) -> None:
    """Replaces annotations in quotes by ones that are evaluated at the first check."""
    for name, annotation in getattr(function, "__annotations__", {}).items():
        if isinstance(annotation, str):
            function.__annotations__[name] = _lazy(annotation, function.__module__)


def _lazy(annotation: str, module: str) -> Any:
    def holds(value):
        try:
            hint = _evaluated(annotation, module)
        except NameError:
            # the class that the annotation names is still being defined
            return True
        return is_bearable(value, hint, conf=CONF)

    return Annotated[object, Is[holds]]


@functools.cache
def _evaluated(annotation: str, module: str) -> Any:
    return eval(annotation, _imports_for_type_checkers(module), vars(sys.modules[module]))


@functools.cache
def _imports_for_type_checkers(module: str) -> dict[str, Any]:
    """Executes the imports below `if TYPE_CHECKING:` of a module."""
    names: dict[str, Any] = {}
    for node in ast.parse(inspect.getsource(sys.modules[module])).body:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            imports = [line for line in node.body if isinstance(line, (ast.Import, ast.ImportFrom))]
            exec(compile(ast.Module(imports, []), module, "exec"), names)
    return names


def _is_named_tuple(item) -> bool:
    # a subclass of a named tuple inherits its checked `__new__`
    return inspect.isclass(item) and typing.NamedTuple in vars(item).get("__orig_bases__", ())


def _check_construction(owner, decorate) -> None:
    """Checks the fields of a named tuple whenever it is built, unless JAX builds it as a pytree."""
    plain = owner.__new__
    fields = {
        name: _lazy(hint.__forward_arg__, owner.__module__) if isinstance(hint, typing.ForwardRef) else hint
        for name, hint in owner.__annotations__.items()
    }
    # as a scalar array, a float would fix the shape of the batch to which the other fields belong
    floats = {name for name, hint in fields.items() if is_bearable(1.0, hint, conf=CONF)}
    # the annotations of `__new__` are those of the class; a copy leaves the class as it is
    checked = type(plain)(plain.__code__, plain.__globals__, owner.__name__, plain.__defaults__)
    checked.__annotations__ = fields
    checked.__module__, checked.__qualname__ = owner.__module__, owner.__qualname__
    checked = decorate(checked)

    @functools.wraps(plain)
    def new(cls, *args, **options):
        caller = sys._getframe(1).f_globals.get("__name__", "").split(".")[0]
        if caller not in UNCHECKED_CALLERS and len(args) <= len(fields):
            given = {**dict(zip(fields, args, strict=False)), **options}
            checked(cls, **{name: value if name in floats else _scalar(value) for name, value in given.items()})
        return plain(cls, *args, **options)

    owner.__new__ = staticmethod(new)
    # `_replace` calls `_make`, which would bypass `__new__`
    owner._make = classmethod(lambda cls, values: cls(*values))


def _scalar(value: Any) -> Any:
    """Makes a Python float pass as a scalar array, as it does in the arithmetic of NumPy and JAX."""
    return np.float64(value) if type(value) is float else value
