import importlib
import inspect
import pkgutil
import typing

import jax
import jaxtyping
import numpy as np
import pytest

import symjax
from symjax.detection import summary
from symjax.detection.completion import complete
from symjax.geometry.plane import Plane
from symjax.preprocess.cloud import Cloud
from tests.helpers import shape_checks

PLANE = Plane(np.array([1.0, 0.0, 0.0]), np.array(2.0))


def type_check_error(call, *args, **options):
    """Returns the message of the checks, without `pytest.raises`, which switches them off."""
    try:
        call(*args, **options)
    except jaxtyping.TypeCheckError as error:
        return str(error)
    return pytest.fail("a wrong argument was accepted")


def test_annotations_of_functions_are_checked():
    assert complete(np.zeros((9, 3)), PLANE).shape == (18, 3)
    assert "Float[ndarray, 'n 3']" in type_check_error(complete, np.zeros((9, 4)), PLANE)


def test_fields_of_named_tuples_are_checked_when_they_are_built():
    assert "'*batch 3'" in type_check_error(Plane, np.zeros(4), np.array(2.0))
    assert "'*batch'" in type_check_error(Plane, np.zeros((2, 3)), np.zeros(3))
    assert "'normal'" in type_check_error(PLANE._replace, normal=np.zeros(4))
    assert "'points'" in type_check_error(Cloud, np.zeros((9, 2)), None, np.arange(9), None, 9, False, ())


def test_every_named_tuple_of_symjax_is_checked():
    names = [module.name for module in pkgutil.walk_packages(symjax.__path__, "symjax.")]
    modules = [importlib.import_module(name) for name in names if not name.endswith("__main__")]
    found = {
        item
        for module in modules
        for item in vars(module).values()
        if inspect.isclass(item)
        and item.__module__ == module.__name__
        and not item.__module__.startswith(shape_checks.UNCHECKED_MODULES)
        and typing.NamedTuple in vars(item).get("__orig_bases__", ())
    }
    assert {Plane, Cloud, symjax.Candidate, symjax.Fit} <= found
    assert not [owner for owner in found if inspect.getsourcefile(owner.__new__.__code__) != shape_checks.__file__]


def test_jax_builds_named_tuples_of_placeholders():
    assert jax.tree.map(lambda leaf: None, PLANE) == (None, None)
    assert jax.eval_shape(lambda plane: plane, PLANE).normal.shape == (3,)


def test_names_that_are_imported_only_for_type_checkers_are_checked():
    assert "'detection'" in type_check_error(summary._comparison, 3)
    assert "'vector'" in type_check_error(summary._components, np.zeros(4))
    assert "'other'" in type_check_error(PLANE.angle, np.zeros(4))


def test_inside_pytest_raises_a_wrong_argument_raises_the_error_that_users_see():
    with pytest.raises(AttributeError, match="no attribute 'reflect'"):
        complete(np.zeros((9, 3)), "a")
    assert not jaxtyping.config.jaxtyping_disable
