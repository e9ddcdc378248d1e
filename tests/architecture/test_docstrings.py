"""Public docstrings document all parameters, return values and fields, and have an example that runs as a doctest."""

import dataclasses
import inspect
import re

import pytest

import symjax
from symjax.l2e.solvers import rbfgs

METRICS = ("deviation_angle", "offset_error")
NAMES = {
    **{name: getattr(symjax, name) for name in symjax.__all__},
    **{f"datasets.{name}": getattr(symjax.datasets, name) for name in symjax.datasets.__all__},
    **{f"metrics.{name}": getattr(symjax.metrics, name) for name in METRICS},
    **{f"rbfgs.{name}": getattr(rbfgs, name) for name in ("minimise", "riemannian_bfgs")},
}
CLASSES = {
    name: found
    for name, found in NAMES.items()
    if inspect.isclass(found) and not issubclass(found, (Exception, Warning))
}
FUNCTIONS = {name: found for name, found in NAMES.items() if callable(found) and not inspect.isclass(found)}
METHODS = {
    f"{name}.{key}": found
    for name, owner in CLASSES.items()
    for key, found in vars(owner).items()
    if not key.startswith("_") and inspect.isfunction(found) and found.__module__.startswith("symjax")
}


def section(doc, title):
    """Returns the names of the entries of a section of a Google docstring, or None if there is no such section."""
    found = re.search(rf"^{title}:\n((?: .*\n|\n)+)", inspect.cleandoc(doc) + "\n", re.MULTILINE)
    if found is None:
        return None
    heads = re.findall(r"^    ([\w*, ]+)(?: \(.*?\))?:", found[1], re.MULTILINE)
    return {name.strip(" *") for head in heads for name in head.split(",")}


def parameters(function):
    return {name for name in inspect.signature(function).parameters if name not in ("self", "cls")}


@pytest.mark.parametrize("name", FUNCTIONS | METHODS)
def test_a_function_documents_its_parameters_and_return_value(name):
    function = (FUNCTIONS | METHODS)[name]
    missing = parameters(function) - (section(function.__doc__, "Args") or set())
    assert not missing
    returns = inspect.signature(function).return_annotation
    if returns not in (None, "None") and name in FUNCTIONS:
        assert section(function.__doc__, "(Returns|Yields)") is not None


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_documents_its_fields(name):
    owner = CLASSES[name]
    fields = (
        getattr(owner, "_fields", ()) or [f.name for f in dataclasses.fields(owner)]
        if (dataclasses.is_dataclass(owner) or hasattr(owner, "_fields"))
        else []
    )
    documented = (section(owner.__doc__, "Attributes") or set()) | (section(owner.__doc__, "Args") or set())
    assert set(fields) <= documented


@pytest.mark.parametrize("name", FUNCTIONS | CLASSES)
def test_every_function_and_class_has_an_example(name):
    assert ">>> " in (FUNCTIONS | CLASSES)[name].__doc__
