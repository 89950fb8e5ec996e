"""Arguments of the models: which numbers a formula accepts, how it refuses one, when it warns.

`formula` declares the arguments of an equation. A value at which it has no meaning raises
`erlif.core.errors.ModelError`; one that is so far from that of any oil or machine that a slip of
units is the likely reason warns with `erlif.core.errors.UnitWarning`, and the calculation
continues. The message holds the name of the argument. The ``require_*`` functions refuse values in
the same manner where a condition concerns more than one argument, or a number on the way: they take
floats or arrays under the caller's names. NaN stands for a missing value and passes all of them but
`require_known`.

Quantities, with the sizes that they have in machines, and the kinds of common arguments stand in
arguments.toml beside this file.
"""

import math
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache, partial, wraps
from inspect import formatannotation, signature
from itertools import pairwise
from typing import Any, ParamSpec, TypeAlias, TypeVar, cast

import numpy as np

from erlif.core.errors import ModelError, RangeWarning, UnitWarning
from erlif.core.tables import read_table

# A float, a list, a numpy array or an xarray DataArray, in SI units.
#
# No static type covers them without an import of xarray.
Values: TypeAlias = Any

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


def require_finite(**arguments: Values) -> None:
    """Refuse infinite values, and what is not a number.

    Examples
    --------
    >>> require_finite(temperature=[300.0, np.nan])
    >>> require_finite(load=np.inf)
    Traceback (most recent call last):
    erlif.core.errors.ModelError: load must be finite, got inf.
    """
    for name, value in arguments.items():
        if isinstance(value, float) and not math.isinf(value):
            continue  # most arguments are one number, and fits call a formula thousands of times
        try:
            infinite = np.isinf(value)
        except TypeError as error:
            raise ModelError(f"{name} must be a number in SI units, got {value!r}.") from error
        if np.any(infinite):
            first = np.asarray(value)[np.asarray(infinite)].flat[0]
            raise ModelError(f"{name} must be finite, got {first:g}.")


def require_positive(**arguments: Values) -> None:
    """Refuse zero, negative and infinite values.

    Examples
    --------
    >>> require_positive(load=[1.0, -5.0])
    Traceback (most recent call last):
    erlif.core.errors.ModelError: load must be positive, got -5.
    """
    _refuse_below("be positive", np.less_equal, arguments)


def require_not_negative(**arguments: Values) -> None:
    """Refuse negative and infinite values.

    Examples
    --------
    >>> require_not_negative(friction=0.0)
    >>> require_not_negative(friction=-0.1)
    Traceback (most recent call last):
    erlif.core.errors.ModelError: friction must not be negative, got -0.1.
    """
    _refuse_below("not be negative", np.less, arguments)


def _refuse_below(
    wanted: str, below_zero: Callable[..., Values], arguments: dict[str, Values]
) -> None:
    """Refuse infinite values, and those for which a comparison with zero holds."""
    require_finite(**arguments)
    for name, value in arguments.items():
        if np.any(below_zero(value, 0)):
            raise ModelError(f"{name} must {wanted}, got {_smallest(value)}.")


def require_between(
    lowest: float, highest: float, ends: bool = True, /, **arguments: Values
) -> None:
    """Refuse values outside a range, with or without its ends.

    Examples
    --------
    >>> require_between(0.0, 1.0, restitution=1.2)
    Traceback (most recent call last):
    erlif.core.errors.ModelError: restitution must lie in 0 to 1, got 1.2.
    """
    for name, value in arguments.items():
        for outside, got in (
            (np.less(value, lowest), _smallest),
            (np.greater(value, highest), _largest),
        ):
            if np.any(outside):
                raise ModelError(f"{name} must lie in {lowest:g} to {highest:g}, got {got(value)}.")
        if not ends and np.any(np.isin(value, (lowest, highest))):
            raise ModelError(
                f"{name} must lie between {lowest:g} and {highest:g}, without the ends."
            )


def require_poisson(**arguments: Values) -> None:
    """Refuse Poisson's ratios outside -1 to 0.5, the range of a stable isotropic solid.

    Examples
    --------
    >>> require_poisson(poisson_1=0.3, poisson_2=0.6)
    Traceback (most recent call last):
    erlif.core.errors.ModelError: poisson_2 must be at most 0.5, got 0.6.
    """
    for name, value in arguments.items():
        if np.any(np.less_equal(value, -1)):
            raise ModelError(f"{name} must lie above -1, got {_smallest(value)}.")
        if np.any(np.greater(value, 0.5)):
            raise ModelError(f"{name} must be at most 0.5, got {_largest(value)}.")


def require_increasing(**arguments: Values) -> None:
    """Refuse arguments that are not each larger than the one before it.

    Examples
    --------
    >>> require_increasing(pin_radius=0.0333, bushing_radius=0.0336)
    >>> require_increasing(pin_radius=0.0336, bushing_radius=0.0336)
    Traceback (most recent call last):
    erlif.core.errors.ModelError: bushing_radius must exceed pin_radius, got 0.0336 and 0.0336.
    """
    pairs = [(name, _as_number(name, value)) for name, value in arguments.items()]
    for (smaller, low), (larger, high) in pairwise(pairs):
        wrong = np.asarray(np.less_equal(high, low))
        if np.any(wrong):
            # both on their common grid, to quote the pair that is out of order
            first, second = (np.asarray(v)[wrong].flat[0] for v in (high + 0 * low, low + 0 * high))
            raise ModelError(f"{larger} must exceed {smaller}, got {first:g} and {second:g}.")


def require_single(**arguments: Values) -> None:
    """Refuse arrays where one number is needed.

    Examples
    --------
    >>> require_single(crank=[0.05, 0.06])
    Traceback (most recent call last):
    erlif.core.errors.ModelError: crank must be one number, got an array of shape (2,).
    """
    for name, value in arguments.items():
        if np.ndim(value):
            raise ModelError(f"{name} must be one number, got an array of shape {np.shape(value)}.")


def require_known(**arguments: Values) -> None:
    """Refuse NaN, where a missing value has no meaning.

    Examples
    --------
    >>> require_known(stiffness=np.nan)
    Traceback (most recent call last):
    erlif.core.errors.ModelError: stiffness must be a number, got NaN.
    """
    for name, value in arguments.items():
        if np.any(np.isnan(value)):
            raise ModelError(f"{name} must be a number, got NaN.")


def for_each(count: int, item: str, **argument: Values) -> Values:
    """One value for each of several things, from a single one or as many.

    Parameters
    ----------
    count : int
        Number of the things.
    item : str
        What one of them is called.
    **argument : float or array, (count,)
        One argument under the caller's name.

    Returns
    -------
    array, (count,)
        Its values.

    Raises
    ------
    ModelError
        Another number of values, or NaN.

    Examples
    --------
    >>> for_each(3, "viscosity", relative_std=0.01)
    array([0.01, 0.01, 0.01])
    """
    ((name, value),) = argument.items()
    values = np.asarray(value, float)
    if values.shape not in ((), (count,)) or np.any(np.isnan(values)):
        raise ModelError(
            f"{name} must be one number, or one for each {item} without NaN, got shape "
            f"{values.shape}. Give one number, or {count}."
        )
    return np.broadcast_to(values, (count,))


@dataclass(frozen=True)
class _Quantity:
    """Values that an argument may have, and its sizes in machines."""

    refuse: str = ""  # name in `_REFUSE`, without a range
    within: tuple[float, float] | None = None
    ends: bool = True  # whether the ends of that range are inside
    unit: str = ""
    lowest: float = 0.0  # smallest plausible size; zero is always plausible
    highest: float = sys.float_info.max
    others: str = ""  # units that a value outside the sizes is probably in


_REFUSE: dict[str, Callable[..., None]] = {
    "infinite": require_finite,
    "negative": require_not_negative,
    "positive": require_positive,
    "poisson": require_poisson,
}

_TABLE = read_table("erlif.models", "arguments.toml")

# Kinds of arguments.
QUANTITIES = {name: _Quantity(**row) for name, row in _TABLE["quantities"].items()}

# Kinds of the arguments that mean the same in all models; the others are declared.
ARGUMENTS = {name: kind for kind, names in _TABLE["names"].items() for name in names}


@dataclass(frozen=True)
class _Kind:
    """Checks of a declared argument."""

    requires: tuple[Callable[..., None], ...]
    quantity: str
    # Floats from here to `high` pass all checks: fits call a formula thousands of times.
    low: float
    high: float

    def passes(self, value: Values) -> bool:
        return type(value) is float and self.low <= value <= self.high

    def check(self, name: str, value: Values) -> None:
        for require in self.requires:
            require(**{name: value})
        warn_of_units(self.quantity, **{name: value})


def _require_whole(**arguments: float) -> None:
    for name, value in arguments.items():
        if value % 1:
            raise ModelError(f"{name} must be a whole number, got {value:g}.")


# Distance from the ends of a range at which a float is inside without a second look.
_INSIDE = 1e-9


@cache
def _read_kind(text: str, annotation: str) -> _Kind:
    """Meaning of "length", "load or zero", "signed length" for an argument of a type."""
    # one number for a type of one, a whole one for integers
    whole = annotation.startswith("int")
    single = whole or annotation.startswith("float")
    before = (require_single, require_known) if single else ()
    after = (_require_whole,) if whole else ()

    # the quantity has a usual sign, from which an equation may differ
    sign, *words = ("", *text.split()) if text.split()[0] in QUANTITIES else text.split()
    quantity = QUANTITIES[words[0]]
    low, high = max(quantity.lowest, sys.float_info.min), quantity.highest
    require: Callable[..., None]
    if sign == "signed":
        require = require_finite
    elif sign == "positive":
        require = require_positive
    elif words[1:] == ["or", "zero"]:
        require = require_not_negative
    elif quantity.within:
        require = partial(require_between, *quantity.within, quantity.ends)
        low, high = quantity.within[0] + _INSIDE, quantity.within[1] - _INSIDE
    else:
        require = _REFUSE[quantity.refuse]
        high = 0.5 if require is require_poisson else high
    if whole:
        low = math.inf  # no float passes without a second look
    return _Kind((*before, require, *after), words[0], low, high)


def formula(
    **kinds: str,
) -> Callable[[Callable[_Parameters, _Result]], Callable[_Parameters, _Result]]:
    """Declare the arguments of an equation, which then takes and checks all kinds of numbers.

    Lists become arrays and integers become floats before the call, unless an argument is annotated
    as integer or text; scalars of numpy become floats after it, inside tuples and dataclasses too.
    Arrays and DataArrays stay as they are, so the equation itself broadcasts. An argument annotated
    as float or integer is refused as an array and as NaN.

    Parameters
    ----------
    **kinds : str
        Kind of each argument, from `QUANTITIES`, with "signed" or "positive" before it or "or zero"
        behind it where the sign differs from the usual one. An argument without a kind has that of
        its name in `ARGUMENTS`; one without either is not checked.

    Returns
    -------
    callable
        Decorator of a function or method.

    Raises
    ------
    ModelError
        From the decorated function: an argument outside its kind, or text in the place of a number.

    Warns
    -----
    UnitWarning
        From the decorated function: an argument that is probably in another unit.

    Examples
    --------
    >>> @formula(diameter="length")
    ... def area_of_circle(diameter):
    ...     return np.pi / 4 * diameter**2
    >>> area_of_circle(2)
    3.141592653589793
    >>> area_of_circle([2, 4])
    array([ 3.14159265, 12.56637061])
    >>> area_of_circle(-1)
    Traceback (most recent call last):
    erlif.core.errors.ModelError: diameter must be positive, got -1.
    """

    def decorate(equation: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
        parameters = signature(equation).parameters
        names = tuple(parameters)
        annotations = {name: _text_of(one.annotation) for name, one in parameters.items()}
        declared = {name: ARGUMENTS[name] for name in names if name in ARGUMENTS} | kinds
        checks = {name: _read_kind(text, annotations[name]) for name, text in declared.items()}
        # no numbers that broadcast: integers, text, pairs of numbers
        others = ("int", "str", "Literal", "typing.Literal", "tuple")
        plain = {name for name, text in annotations.items() if text.startswith(others)}
        optional = {name for name, one in parameters.items() if one.default is None}

        def accept(name: str, value: Values) -> Values:
            kind = checks.get(name)
            if kind is not None and kind.passes(value):
                return value
            number = value if name in plain else _as_number(name, value)
            if kind is not None and not (number is None and name in optional):
                kind.check(name, number)
            return number

        @wraps(equation)
        def evaluate(*args: _Parameters.args, **kwargs: _Parameters.kwargs) -> _Result:
            numbers = [accept(name, value) for name, value in zip(names, args, strict=False)]
            numbers += args[len(names) :]  # too many arguments: Python's own message is the best
            named = {name: accept(name, value) for name, value in kwargs.items()}
            return cast(_Result, _as_result(equation(*numbers, **named)))

        return evaluate

    return decorate


def _text_of(annotation: Any) -> str:
    """An annotation as it is written."""
    return annotation if isinstance(annotation, str) else formatannotation(annotation)


def check_fields(table: Any, **kinds: str) -> None:
    """Check the fields of a dataclass as `formula` checks arguments; an optional one may be None.

    Parameters
    ----------
    table : dataclass
        Its fields as numbers in SI units.
    **kinds : str
        Kind of each field that has none by its name, as in `formula`.

    Raises
    ------
    ModelError
        Names the first field outside its kind.

    Warns
    -----
    UnitWarning
        Names a field that is probably in another unit.

    Examples
    --------
    >>> @dataclass
    ... class Arm:
    ...     length: float
    >>> check_fields(Arm(-0.05))
    Traceback (most recent call last):
    erlif.core.errors.ModelError: length must be positive, got -0.05.
    """
    for field in fields(table):
        name, value = field.name, getattr(table, field.name)
        text = kinds.get(name) or ARGUMENTS.get(name)
        if text is None or value is None:
            continue
        kind = _read_kind(text, _text_of(field.type))
        if not kind.passes(value):
            kind.check(name, _as_number(name, value))


def warn_of_units(quantity: str, /, **arguments: Values) -> None:
    """Warn of values that are probably in another unit.

    Parameters
    ----------
    quantity : str
        Kind of the values, from `QUANTITIES`.
    **arguments : float or array
        Values under the caller's names, in SI units.

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> import warnings
    >>> warn_of_units("modulus", youngs_1=200e9)
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     warn_of_units("modulus", youngs_1=200)
    >>> print(caught[0].message)
    youngs_1 = 200 Pa is implausible (300000 to 1e+13 Pa expected): in GPa or MPa?
    """
    usual = QUANTITIES[quantity]
    if not usual.unit:
        return  # of any size
    found = []
    for name, value in arguments.items():
        if isinstance(value, float) and (not value or usual.lowest <= abs(value) <= usual.highest):
            continue  # as in require_finite
        values = np.asarray(value, float)
        sizes = np.abs(values)  # speeds and expansions have either sign
        odd = (sizes > 0) & np.isfinite(sizes) & ((sizes < usual.lowest) | (sizes > usual.highest))
        if np.any(odd):
            found.append(f"{name} = {values[odd].flat[0]:g} {usual.unit}")
    if not found:
        return

    expected = (
        f"{usual.lowest:g} to {usual.highest:g} {usual.unit}"
        if usual.lowest > 0
        else f"at most {usual.highest:g} {usual.unit}"
    )
    warnings.warn(
        f"{', '.join(found)} {'is' if len(found) == 1 else 'are'} implausible "
        f"({expected} expected): in {usual.others}?",
        UnitWarning,
        stacklevel=depth_of_caller(),
    )


def warn_of_range(equation: str, name: str, value: Values, lowest: float, highest: float) -> None:
    """Warn where a fitted equation is used beyond the range of its source.

    Parameters
    ----------
    equation : str
        Its name, as the user reads it.
    name : str
        Name of the quantity.
    value : float or array
        The quantity; NaN is ignored.
    lowest, highest : float
        Ends of the range.

    Warns
    -----
    RangeWarning
        With the value farthest outside.

    Examples
    --------
    >>> warn_of_range("the fit", "k", 3.0, 1.0, 8.0)
    """
    values = np.asarray(value, float)
    outside = values[(values < lowest) | (values > highest)]
    if not outside.size:
        return
    below, above = float(outside.min()), float(outside.max())
    got = above if above > highest and above / highest > lowest / below else below
    warnings.warn(
        f"{equation} was fitted for {name} = {lowest:g} to {highest:g}; {name} = {got:.3g} here. "
        "Take its result as an order of magnitude.",
        RangeWarning,
        stacklevel=depth_of_caller(),
    )


def depth_of_caller() -> int:
    """Stack level of the first frame outside of models and sizing: the line of the user.

    All nested formulas then warn from that line, and Python's default filter shows the text once.

    Returns
    -------
    int
        For `warnings.warn`.

    Examples
    --------
    >>> depth_of_caller() >= 1
    True
    """
    depth, frame = 1, sys._getframe(1)  # level 1 is the function that warns
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith(
        ("erlif.models.", "erlif.joint.models.", "erlif.joint.sizing.")
    ):
        depth, frame = depth + 1, frame.f_back
    return depth


def _as_number(name: str, value: Values) -> Values:
    """A float for a scalar, a float array for a list; arrays, flags and other objects unchanged."""
    if type(value) is float:
        return value
    if isinstance(value, str):
        raise ModelError(f"{name} must be a number in SI units, got {value!r}.")

    # flags are not numbers, and a DataArray keeps its coordinates
    if isinstance(value, bool | np.bool_) or hasattr(value, "dims"):
        return value
    if isinstance(value, int | float | np.number):
        return float(value)

    # integers become floats, which integer powers need; single precision stays
    if isinstance(value, list | tuple | range):
        array = np.asarray(value)
        return array if array.dtype == bool else array.astype(float)
    if isinstance(value, np.ndarray):
        if value.ndim == 0:
            return value.item()
        return value.astype(float) if value.dtype.kind in "iu" else value
    return value


def _as_result(result: Values) -> Values:
    """Scalars of numpy as Python's own; the rest unchanged."""
    if type(result) is float or (type(result) is np.ndarray and result.ndim):
        return result
    if isinstance(result, np.generic) or (isinstance(result, np.ndarray) and result.ndim == 0):
        return result.item()
    if isinstance(result, tuple):
        items = [_as_result(item) for item in result]
        return type(result)(*items) if hasattr(result, "_fields") else tuple(items)
    if is_dataclass(result) and not isinstance(result, type):
        changes = {f.name: _as_result(getattr(result, f.name)) for f in fields(result)}
        return replace(result, **changes)
    return result


def _smallest(value: Values) -> str:
    return f"{float(np.nanmin(np.asarray(value))):g}"


def _largest(value: Values) -> str:
    return f"{float(np.nanmax(np.asarray(value))):g}"
