"""Properties that every formula of the models must have, whatever its equation.

A case is a dictionary of scalar arguments in SI units, well inside the range of the formula.
"""

import importlib
import inspect
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields, is_dataclass
from inspect import signature
from typing import Any

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif import models
from erlif.core.errors import ModelError
from erlif.joint import models as joint_models

Case = dict[str, Any]


MODULES = {
    name: getattr(package, name)
    for package in (models, joint_models)
    for name in sorted(set(package.__all__) - {"arguments"})
    if inspect.ismodule(getattr(package, name))
}
"""Modules of the models, those of the joint included, by their names."""


def public_names() -> Iterator[tuple[str, Any]]:
    """Functions, classes and their public methods, with a name for the report."""
    for name, module in MODULES.items():
        own = (
            key
            for key, value in vars(module).items()
            if getattr(value, "__module__", "") == module.__name__ and not key.startswith("_")
        )
        for key in getattr(importlib.import_module(module.__name__), "__all__", own):
            value = getattr(module, key)
            if inspect.isfunction(value) or inspect.isclass(value):
                yield f"{name}.{key}", value
            if inspect.isclass(value):
                yield from (
                    (f"{name}.{key}.{method}", member)
                    for method, member in vars(value).items()
                    if inspect.isfunction(member) and not method.startswith("_")
                )


def evaluate(formula: Callable[..., Any], case: Case) -> list[Any]:
    """Numbers of the result, one for each field where it has several."""
    first = next(iter(signature(formula).parameters))
    result = formula(case[first], **{name: case[name] for name in case if name != first})
    if is_dataclass(result):
        return [getattr(result, field.name) for field in fields(result)]
    return list(result) if isinstance(result, tuple) else [result]


def numeric(case: Case) -> list[str]:
    """Names of the arguments that are numbers, linkages and flags left out."""
    return [name for name, value in case.items() if type(value) is float]


def assert_broadcasts(formula: Callable[..., Any], case: Case) -> None:
    """Scalars give floats; lists, arrays and DataArrays give each of their elements' results."""
    expected = evaluate(formula, case)
    assert all(type(part) is float for part in expected)

    for name in numeric(case):
        values = [case[name], case[name] * 0.999]
        other = evaluate(formula, case | {name: values[1]})
        for kind in (list, np.array, lambda v: xr.DataArray(v, dims="case")):
            found = evaluate(formula, case | {name: kind(values)})
            for part, one, two in zip(found, expected, other, strict=True):
                npt.assert_allclose(part, [one, two], rtol=1e-12, err_msg=name)
            if kind not in (list, np.array):
                assert any(getattr(part, "dims", ()) == ("case",) for part in found), name


def assert_infinity_is_named(
    formula: Callable[..., Any], case: Case, *, allowed: Iterable[str] = ()
) -> None:
    """An infinite argument raises ModelError, whose message begins with its name."""
    for name in set(numeric(case)) - set(allowed):
        for value in (np.inf, -np.inf, [case[name], np.inf]):
            with pytest.raises(ModelError, match=rf"^{name}\b"):
                evaluate(formula, case | {name: value})


def assert_missing_values_pass(formula: Callable[..., Any], case: Case) -> None:
    """NaN in an argument gives NaN in the result, and only there."""
    for name in numeric(case):
        assert any(np.isnan(part) for part in evaluate(formula, case | {name: np.nan})), name
        beside = evaluate(formula, case | {name: [case[name], np.nan]})
        expected = evaluate(formula, case)
        for part, one in zip(beside, expected, strict=True):
            npt.assert_allclose(np.ravel(part)[0], one, rtol=1e-12, err_msg=name)
