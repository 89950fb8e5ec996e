"""Arguments of the models: which numbers a formula accepts, how it refuses one, when it warns.

The ``require_*`` functions raise `erlif.core.errors.ModelError` for a value at which an equation
has no meaning. The ``check_*`` functions warn with `erlif.core.errors.UnitWarning` where a value is
so far from that of any oil or machine that a slip of units is the likely reason; the calculation
continues. Both take the arguments by keyword, so that the message holds the name that the caller
used. NaN stands for a missing value and passes all of them.
"""

import math
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import wraps
from inspect import signature
from itertools import pairwise
from typing import Any, ParamSpec, TypeAlias, TypeVar, cast

import numpy as np

from erlif.core.errors import ModelError, RangeWarning, UnitWarning

Values: TypeAlias = Any
"""A float, a list, a numpy array or an xarray DataArray, in SI units.

No static type covers them without an import of xarray.
"""

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


def broadcasting(formula: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Let a formula take scalars, lists, arrays and DataArrays, and return floats for scalars.

    Lists become arrays and integers become floats before the call; scalars of numpy become floats
    after it, inside tuples and dataclasses too. Arrays and DataArrays stay as they are, so the
    formula itself broadcasts. A function that needs an integer must not be decorated.

    Parameters
    ----------
    formula : callable
        Function or method of `Values`.

    Returns
    -------
    callable
        The same formula for all kinds of numbers.

    Raises
    ------
    ModelError
        From the decorated formula, for text in the place of a number.

    Examples
    --------
    >>> @broadcasting
    ... def area_of_circle(diameter):
    ...     return np.pi / 4 * diameter**2
    >>> area_of_circle(2)
    3.141592653589793
    >>> area_of_circle([2, 4])
    array([ 3.14159265, 12.56637061])
    """
    names = tuple(signature(formula).parameters)

    @wraps(formula)
    def evaluate(*args: _Parameters.args, **kwargs: _Parameters.kwargs) -> _Result:
        numbers = [_as_number(name, value) for name, value in zip(names, args, strict=False)]
        numbers += args[len(names) :]  # too many arguments: Python's own message is the best
        named = {name: _as_number(name, value) for name, value in kwargs.items()}
        return cast(_Result, _as_result(formula(*numbers, **named)))

    return evaluate


def require_finite(**arguments: Values) -> None:
    """Refuse infinite values, and what is not a number.

    Parameters
    ----------
    **arguments : float or array
        Values under the caller's names.

    Raises
    ------
    ModelError
        Names the first argument that holds an infinite value or no number at all.

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
            raise ModelError(_not_a_number(name, value)) from error
        if np.any(infinite):
            first = np.asarray(value)[np.asarray(infinite)].flat[0]
            raise ModelError(f"{name} must be finite, got {first:g}.")


def require_positive(**arguments: Values) -> None:
    """Refuse zero, negative and infinite values.

    Parameters
    ----------
    **arguments : float or array
        Values under the caller's names.

    Raises
    ------
    ModelError
        Names the first argument that holds such a value.

    Examples
    --------
    >>> require_positive(load=[1.0, -5.0])
    Traceback (most recent call last):
    erlif.core.errors.ModelError: load must be positive, got -5.
    """
    require_finite(**arguments)
    for name, value in arguments.items():
        if value <= 0 if isinstance(value, float) else np.any(np.less_equal(value, 0)):
            raise ModelError(f"{name} must be positive, got {_smallest(value)}.")


def require_not_negative(**arguments: Values) -> None:
    """Refuse negative and infinite values.

    Parameters
    ----------
    **arguments : float or array
        Values under the caller's names.

    Raises
    ------
    ModelError
        Names the first argument that holds such a value.

    Examples
    --------
    >>> require_not_negative(friction=0.0)
    >>> require_not_negative(friction=-0.1)
    Traceback (most recent call last):
    erlif.core.errors.ModelError: friction must not be negative, got -0.1.
    """
    require_finite(**arguments)
    for name, value in arguments.items():
        if value < 0 if isinstance(value, float) else np.any(np.less(value, 0)):
            raise ModelError(f"{name} must not be negative, got {_smallest(value)}.")


def require_between(lowest: float, highest: float, **arguments: Values) -> None:
    """Refuse values outside a closed range.

    Parameters
    ----------
    lowest, highest : float
        Ends of the range; both are accepted.
    **arguments : float or array
        Values under the caller's names.

    Raises
    ------
    ModelError
        Names the first argument that holds a value outside the range.

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


def require_poisson(**arguments: Values) -> None:
    """Refuse Poisson's ratios outside -1 to 0.5, the range of a stable isotropic solid.

    Parameters
    ----------
    **arguments : float or array
        Poisson's ratios under the caller's names. [1]

    Raises
    ------
    ModelError
        Names the first argument at or below -1 or above 0.5.

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

    Parameters
    ----------
    **arguments : float or array
        Values under the caller's names, from the smallest to the largest.

    Raises
    ------
    ModelError
        Names the first pair that is equal or in the wrong order, with its values.

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

    Parameters
    ----------
    **arguments : float
        Values under the caller's names.

    Raises
    ------
    ModelError
        Names the first argument that holds more than one number.

    Examples
    --------
    >>> require_single(crank=[0.05, 0.06])
    Traceback (most recent call last):
    erlif.core.errors.ModelError: crank must be one number, got an array of shape (2,).
    """
    for name, value in arguments.items():
        if np.ndim(value):
            raise ModelError(f"{name} must be one number, got an array of shape {np.shape(value)}.")


@dataclass(frozen=True)
class _Scale:
    """Orders of magnitude that a quantity takes in machines, and the units it is often given in."""

    unit: str
    lowest: float
    """Smallest plausible size; zero is always plausible."""
    highest: float
    others: str
    """Units that a value outside the range is probably in."""


_MODULUS = _Scale("Pa", 3e5, 1e13, "GPa or MPa")
"""From the softest rubber to ten times diamond; steel in MPa, 2e5, lies below."""

_STRENGTH = _Scale("Pa", 1e5, 1e12, "MPa or kgf/mm2 (Brinell, Vickers)")
"""From grey putty to ten times the hardness of diamond."""

_VISCOSITY = _Scale("Pa s", 1e-6, 50.0, "mPa s (cP), or kinematic, in cSt")
"""From a tenth of air to the heaviest gear oil in frost; 0.06 Pa s given in mPa s lies above."""

_KINEMATIC_VISCOSITY = _Scale("m2/s", 1e-8, 0.05, "mm2/s (cSt)")
"""As the dynamic viscosity, at about 1000 kg/m3."""

_PRESSURE_VISCOSITY = _Scale("1/Pa", 1e-11, 1e-6, "1/GPa or 1/MPa")
"""Water has 5e-10, traction fluids 4e-8."""

_LENGTH = _Scale("m", 1e-7, 10.0, "mm or um")
"""Diameters, widths, walls and plays of joints; the clearance of a fit may be below 1 um."""

_REDUCED_RADIUS = _Scale("m", 1e-6, 1e5, "mm")
"""A fit with a clearance of 1 um on a radius of 0.1 m has 1e4 m."""

_FILM = _Scale("m", 0.0, 0.01, "um or mm")
"""Film thicknesses and roughnesses; a measured minimum may be as small as noise makes it."""

_LOAD = _Scale("N", 0.0, 1e9, "mN")
"""Loads; the largest presses reach 1e9 N."""

_LINE_LOAD = _Scale("N/m", 0.0, 1e10, "mN/m")
"""Loads per length; a load cell at rest may show anything near zero."""

_SPEED = _Scale("m/s", 0.0, 1e3, "mm/s")
"""Surface speeds; turbine shafts reach 150 m/s."""

_TEMPERATURE = _Scale("K", 120.0, 3000.0, "degrees Celsius")
"""From the coldest grease to molten steel."""

_DENSITY = _Scale("kg/m3", 50.0, 3e4, "g/cm3")
"""From foam to osmium."""

_EXPANSION = _Scale("1/K", 1e-8, 1e-2, "1e-6/K")
"""Linear and cubic thermal expansion; oils 7e-4, steel 1.2e-5."""

_CONDUCTIVITY = _Scale("W/(m K)", 1e-3, 1e4, "W/(cm K) or mW/(m K)")
"""Thermal conductivity, from aerogel to diamond."""

_SWING = _Scale("rad", 0.0, np.pi, "degrees")
"""Half of the angle from end to end of a swinging joint."""

_SPECIFIC_WEAR = _Scale("1/Pa", 0.0, 1e-9, "mm3/(N m)")
"""Volume over load and distance; ice on sandpaper reaches 1e-10."""


def check_modulus(**arguments: Values) -> None:
    """Warn of a Young's modulus or contact modulus outside 3e5 to 1e13 Pa.

    Parameters
    ----------
    **arguments : float or array
        Moduli under the caller's names. [Pa]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> import warnings
    >>> check_modulus(youngs_1=200e9)
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     check_modulus(youngs_1=200)
    >>> print(caught[0].message)
    youngs_1 = 200 Pa is implausible (300000 to 1e+13 Pa expected): in GPa or MPa?
    """
    _warn_outside(_MODULUS, arguments)


def check_strength(**arguments: Values) -> None:
    """Warn of a yield stress, tensile strength or hardness outside 1e5 to 1e12 Pa.

    Parameters
    ----------
    **arguments : float or array
        Stresses or hardnesses under the caller's names. [Pa]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_strength(yield_stress=600e6)
    """
    _warn_outside(_STRENGTH, arguments)


def check_viscosity(**arguments: Values) -> None:
    """Warn of a dynamic viscosity outside 1e-6 to 50 Pa s.

    Parameters
    ----------
    **arguments : float or array
        Dynamic viscosities under the caller's names. [Pa s]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_viscosity(viscosity=0.12)
    """
    _warn_outside(_VISCOSITY, arguments)


def check_kinematic_viscosity(**arguments: Values) -> None:
    """Warn of a kinematic viscosity outside 1e-8 to 0.05 m2/s.

    Parameters
    ----------
    **arguments : float or array
        Kinematic viscosities under the caller's names. [m2/s]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_kinematic_viscosity(viscosity_1=140e-6)
    """
    _warn_outside(_KINEMATIC_VISCOSITY, arguments)


def check_pressure_viscosity(**arguments: Values) -> None:
    """Warn of a pressure-viscosity coefficient outside 1e-11 to 1e-6 1/Pa.

    Parameters
    ----------
    **arguments : float or array
        Coefficients under the caller's names. [1/Pa]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_pressure_viscosity(pressure_viscosity=2e-8)
    """
    _warn_outside(_PRESSURE_VISCOSITY, arguments)


def check_length(**arguments: Values) -> None:
    """Warn of a length of a machine part outside 1e-7 to 10 m.

    Parameters
    ----------
    **arguments : float or array
        Lengths under the caller's names. [m]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_length(pin_diameter=66.7e-3, width=0.237)
    """
    _warn_outside(_LENGTH, arguments)


def check_reduced_radius(**arguments: Values) -> None:
    """Warn of a reduced radius outside 1e-6 to 1e5 m.

    Parameters
    ----------
    **arguments : float or array
        Reduced radii under the caller's names. [m]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_reduced_radius(radius=4.872)
    """
    _warn_outside(_REDUCED_RADIUS, arguments)


def check_film(**arguments: Values) -> None:
    """Warn of a film thickness or a roughness above 0.01 m.

    Parameters
    ----------
    **arguments : float or array
        Film thicknesses or roughnesses under the caller's names. [m]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_film(film=0.54e-6, roughness=0.25e-6)
    """
    _warn_outside(_FILM, arguments)


def check_load(**arguments: Values) -> None:
    """Warn of a force above 1e9 N.

    Parameters
    ----------
    **arguments : float or array
        Forces under the caller's names. [N]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_load(load=444.8e3)
    """
    _warn_outside(_LOAD, arguments)


def check_line_load(**arguments: Values) -> None:
    """Warn of a load per length above 1e10 N/m.

    Parameters
    ----------
    **arguments : float or array
        Loads per length under the caller's names. [N/m]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_line_load(load_per_length=1.88e6)
    """
    _warn_outside(_LINE_LOAD, arguments)


def check_speed(**arguments: Values) -> None:
    """Warn of a surface speed above 1e3 m/s, in either direction.

    Parameters
    ----------
    **arguments : float or array
        Speeds under the caller's names. [m/s]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_speed(sliding_speed=-0.0842)
    """
    _warn_outside(_SPEED, arguments)


def check_temperature(**arguments: Values) -> None:
    """Warn of a temperature outside 120 to 3000 K.

    Parameters
    ----------
    **arguments : float or array
        Temperatures under the caller's names. [K]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_temperature(temperature=313.15)
    """
    _warn_outside(_TEMPERATURE, arguments)


def check_density(**arguments: Values) -> None:
    """Warn of a density outside 50 to 3e4 kg/m3.

    Parameters
    ----------
    **arguments : float or array
        Densities under the caller's names. [kg/m3]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_density(density=857.1)
    """
    _warn_outside(_DENSITY, arguments)


def check_expansion(**arguments: Values) -> None:
    """Warn of a coefficient of thermal expansion outside 1e-8 to 0.01 1/K, of either sign.

    Parameters
    ----------
    **arguments : float or array
        Coefficients under the caller's names. [1/K]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_expansion(expansion=7e-4)
    """
    _warn_outside(_EXPANSION, arguments)


def check_conductivity(**arguments: Values) -> None:
    """Warn of a thermal conductivity outside 1e-3 to 1e4 W/(m K).

    Parameters
    ----------
    **arguments : float or array
        Conductivities under the caller's names. [W/(m K)]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_conductivity(conductivity=50.0)
    """
    _warn_outside(_CONDUCTIVITY, arguments)


def check_swing(**arguments: Values) -> None:
    """Warn of half a swing above pi rad.

    Parameters, warnings and ignored values as in `check_modulus`. [rad]

    Examples
    --------
    >>> check_swing(half_swing=0.2132)
    """
    _warn_outside(_SWING, arguments)


def check_specific_wear(**arguments: Values) -> None:
    """Warn of a specific wear rate above 1e-9 1/Pa, which is 1 mm3/(N m).

    Parameters
    ----------
    **arguments : float or array
        Specific wear rates under the caller's names. [1/Pa]

    Warns
    -----
    UnitWarning
        Names the arguments that hold such a value. Zero, NaN and infinity are ignored.

    Examples
    --------
    >>> check_specific_wear(specific_wear=5.05e-13)
    """
    _warn_outside(_SPECIFIC_WEAR, arguments)


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


def _warn_outside(scale: _Scale, arguments: dict[str, Values]) -> None:
    """Warn once of all arguments outside a range; zero, NaN and infinity are ignored."""
    found = []
    for name, value in arguments.items():
        if isinstance(value, float) and (not value or scale.lowest <= abs(value) <= scale.highest):
            continue  # as in require_finite
        values = np.asarray(value, float)
        sizes = np.abs(values)  # speeds and expansions have either sign
        odd = (sizes > 0) & np.isfinite(sizes) & ((sizes < scale.lowest) | (sizes > scale.highest))
        if np.any(odd):
            found.append(f"{name} = {values[odd].flat[0]:g} {scale.unit}")
    if not found:
        return

    expected = (
        f"{scale.lowest:g} to {scale.highest:g} {scale.unit}"
        if scale.lowest > 0
        else f"at most {scale.highest:g} {scale.unit}"
    )
    warnings.warn(
        f"{', '.join(found)} {'is' if len(found) == 1 else 'are'} implausible "
        f"({expected} expected): in {scale.others}?",
        UnitWarning,
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
        ("erlif.models.", "erlif.joint.sizing.")
    ):
        depth, frame = depth + 1, frame.f_back
    return depth


def _as_number(name: str, value: Values) -> Values:
    """A float for a scalar, a float array for a list; arrays, flags and other objects unchanged."""
    if type(value) is float:
        return value
    if isinstance(value, str):
        raise ModelError(_not_a_number(name, value))

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


def _not_a_number(name: str, value: Values) -> str:
    return f"{name} must be a number in SI units, got {value!r}."


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
