"""A pin joint in SI units: load, motion, life, materials, dimensions, and their plausible sizes."""

from __future__ import annotations

import math
import warnings
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import reduce
from typing import Literal, NamedTuple

from erlif.core.errors import ModelError, UnitWarning
from erlif.core.tables import read_table
from erlif.joint.models.wear import mean_sliding_speed
from erlif.joint.sizing.materials import Material
from erlif.models import arguments

# Parts of a joint, and what they are called.
PARTS = {"pin": "pin", "bushing": "bushing", "seat": "seats", "housing": "housing"}


def known(value: float | None, otherwise: float = math.nan) -> float:
    """Return `value`, or `otherwise` if it is None; NaN makes all results NaN.

    Examples
    --------
    >>> known(0.3), known(None), known(None, 0.0)
    (0.3, nan, 0.0)
    """
    return otherwise if value is None else value


@dataclass(frozen=True)
class Lock:
    """The lock plate of the pin, its weld and its screw.

    Attributes
    ----------
    kind : str
        ``"open"`` or ``"closed"`` slot.
    plate : Material
        Material of the plate and of its weld.
    lever : float
        Distance R of the screw from the axis of the pin. [m]
    length : float
        Lever L of the lock force on the prongs. [m]
    thickness : float
        Thickness t of the plate. [m]
    throat : float | None
        Effective throat a of the weld; None to choose it. [m]
    weld : str | None
        ``"internal"`` or ``"external"``; None to choose it.
    friction_bushing : float
        Friction mu1 between pin and bushing at its worst. [1]
    friction_seat : float
        Friction mu2 between pin and seat at its worst. [1]
    height : float | None
        Height h of the prongs; None to choose it. [m]
    end_width : float | None
        Width c of the closed end; None to choose it. [m]
    weld_diameter : float | None
        Inner diameter of the weld; None to choose it. [m]
    screw_diameter : float | None
        Diameter of the screw in its shear plane; None to choose it. [m]
    screw_yield : float | None
        Yield stress of the screw. [Pa]
    """

    kind: Literal["open", "closed"]
    plate: Material
    lever: float
    length: float
    thickness: float = 10e-3
    throat: float | None = None
    weld: Literal["internal", "external"] | None = None
    friction_bushing: float = 1.0
    friction_seat: float = 0.0
    height: float | None = None
    end_width: float | None = None
    weld_diameter: float | None = None
    screw_diameter: float | None = None
    screw_yield: float | None = None


@dataclass(frozen=True)
class Joint:
    """A pin joint; dimensions that are None are to be chosen by `erlif.joint.sizing.size_joint`.

    Attributes
    ----------
    force : float
        Largest load F. [N]
    safety : float
        Safety factor eta. [1]
    pin : Material
    bushing : Material
    seat : Material
    housing : Material
    mean_force : float | None
        Mean load in motion, for heat, pv and wear; None for the largest. [N]
    half_swing : float | None
        Half of the angle from end to end, beta; None where the motion is not known. [rad]
    period : float | None
        Time of a swing forth and back. [s]
    life : float | None
        Time in motion. [s]
    largest_wear : float | None
        Depth that may wear away in this time. [m]
    friction : float
        Friction coefficient between pin and bushing. [1]
    outside_temperature : float
        Temperature on the outside of the bushing. [degC]
    assembly_temperature : float
        Temperature at which play is measured. [degC]
    grease_temperature : float
        Highest temperature of the grease. [degC]
    pin_roughness : float | None
        Ra of the pin. [m]
    bushing_roughness : float | None
        Ra of the bushing. [m]
    pin_diameter : float | None
        d. [m]
    hole_diameter : float
        Lubrication hole across the pin; 0 for none. [m]
    bushing_width : float | None
        w. [m]
    wall : float | None
        Wall thickness of the bushing. [m]
    seat_width : float | None
        Width s of each of the two seats. [m]
    housing_diameter : float | None
        Outer diameter of the housing eye. [m]
    play : float | None
        Bore of the bushing before it is pressed in less diameter of the pin; negative for an
        interference. [m]
    interference : float
        Outer diameter of the bushing less bore of the housing. [m]
    lateral_play : float
        Play between bushing and seats, both sides together. [m]
    eye_ratio : float
        Outer over inner diameter, 2 to 4, of a housing eye that is to be chosen: the bushing is
        wide enough for it. [1]
    largest_diameter : float | None
        Largest pin diameter that is chosen. [m]
    lock : Lock | None
        Lock plate; None for none.
    """

    force: float
    safety: float
    pin: Material
    bushing: Material
    seat: Material
    housing: Material
    mean_force: float | None = None
    half_swing: float | None = None
    period: float | None = None
    life: float | None = None
    largest_wear: float | None = None
    friction: float = 0.1
    outside_temperature: float = 60.0
    assembly_temperature: float = 20.0
    grease_temperature: float = 120.0
    pin_roughness: float | None = None
    bushing_roughness: float | None = None
    pin_diameter: float | None = None
    hole_diameter: float = 0.0
    bushing_width: float | None = None
    wall: float | None = None
    seat_width: float | None = None
    housing_diameter: float | None = None
    play: float | None = None
    interference: float = 0.0
    lateral_play: float = 0.0
    eye_ratio: float = 3.0
    largest_diameter: float | None = None
    lock: Lock | None = None

    @property
    def parts(self) -> dict[str, Material]:
        """The materials by their part."""
        return {part: getattr(self, part) for part in PARTS}

    @property
    def moving_force(self) -> float:
        """Load in motion. [N]"""
        return known(self.mean_force, self.force)

    def speed(self, diameter: float) -> float:
        """Mean sliding speed on a pin of this diameter; NaN where the motion is not known. [m/s]

        Examples
        --------
        >>> from erlif.joint.sizing.materials import read_materials
        >>> steel = read_materials()["S355"]
        >>> Joint(1e5, 2.0, steel, steel, steel, steel, half_swing=0.5, period=2.0).speed(0.08)
        0.04
        """
        swing, period = known(self.half_swing), known(self.period)
        return float(mean_sliding_speed(swing, diameter=diameter, period=period))

    @property
    def sliding_distance(self) -> float:
        """Distance slid in the life over the pin diameter; NaN where it is not known. [1]"""
        return self.speed(1.0) * known(self.life)


# Dimensions of a joint that are chosen where they are None, in the order of the guide.
DIMENSIONS = (
    "pin_diameter",
    "bushing_width",
    "wall",
    "seat_width",
    "housing_diameter",
    "play",
)


class Dimensions(NamedTuple):
    """The dimensions of a joint of which all are known.

    Attributes
    ----------
    pin : float
        Diameter d of the pin. [m]
    width : float
        Width w of the bushing. [m]
    wall : float
        Wall thickness t of the bushing. [m]
    seat : float
        Width s of each seat. [m]
    housing : float
        Outer diameter of the housing eye. [m]
    play : float
        Play before the bushing is pressed in. [m]
    """

    pin: float
    width: float
    wall: float
    seat: float
    housing: float
    play: float

    @property
    def fit(self) -> float:
        """Diameter of the fit between bushing and housing. [m]"""
        return self.pin + 2 * self.wall

    @property
    def length(self) -> float:
        """Length of the pin between the outer faces of the seats, 2 s + w. [m]"""
        return 2 * self.seat + self.width


def dimensions_of(joint: Joint) -> Dimensions:
    """Return the dimensions of a joint.

    Parameters
    ----------
    joint : Joint

    Returns
    -------
    Dimensions

    Raises
    ------
    ModelError
        If one is not known yet.

    Examples
    --------
    >>> from erlif.joint.sizing.materials import read_materials
    >>> steel = read_materials()["S355"]
    >>> dimensions_of(Joint(1e5, 2.0, steel, steel, steel, steel))
    Traceback (most recent call last):
        ...
    erlif.core.errors.ModelError: pin_diameter must be known; choose it with size_joint.
    """
    values = {name: getattr(joint, name) for name in DIMENSIONS}
    unknown = next((name for name, value in values.items() if value is None), None)
    if unknown:
        raise ModelError(f"{unknown} must be known; choose it with size_joint.")
    return Dimensions(*map(float, values.values()))


class Number(NamedTuple):
    """A number of a joint.

    Attributes
    ----------
    place : tuple[str, ...]
        Fields from the joint to it.
    value : float
        SI units.
    name : str
        For a reader; empty where it is not varied.
    by : str
        By how much it is varied.
    quantity : str
        What it measures, by which its size is judged; empty where it is not.
    """

    place: tuple[str, ...]
    value: float
    name: str
    by: str
    quantity: str


def numbers_of(joint: Joint) -> Iterator[Number]:
    """Go through the numbers of a joint that are given.

    Parameters
    ----------
    joint : Joint

    Yields
    ------
    Number

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_joint
    >>> next(numbers_of(example_joint())).name
    'load'
    """
    places: list[tuple[tuple[str, ...], str, str]] = [((), "joint", "")]
    if joint.lock is not None:
        places += [(("lock",), "lock", ""), (("lock", "plate"), "plate", " of the plate")]
    places += [((part,), "material", f" of the {title}") for part, title in PARTS.items()]
    for place, group, owner in places:
        table = reduce(getattr, place, joint)
        for field, known in read_table("erlif.joint.sizing", "quantities.toml")[group].items():
            value = getattr(table, field)
            if value is not None:
                name = known["name"] + owner if "name" in known else ""
                by, quantity = known.get("by", "1 %"), known.get("quantity", "")
                yield Number((*place, field), float(value), name, by, quantity)


def warn_of_units(joint: Joint, *, dimensions: bool = True) -> None:
    """Warn of numbers of a joint that are so far off that a slip of units is likely.

    Parameters
    ----------
    joint : Joint
    dimensions : bool
        Whether lengths are inputs; False for those that were chosen.

    Warns
    -----
    UnitWarning
        Names the numbers, as ``"housing.yield_stress"``.

    Examples
    --------
    A strength in MPa:

    >>> import warnings
    >>> from dataclasses import replace
    >>> from erlif.joint.sizing.design import example_joint
    >>> joint = example_joint()
    >>> soft = replace(joint, housing=replace(joint.housing, yield_stress=335.0))
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     warn_of_units(soft)
    >>> print(str(caught[0].message).split(" is ")[0])
    housing.yield_stress = 335 Pa
    """
    given: defaultdict[str, dict[str, float]] = defaultdict(dict)
    for number in numbers_of(joint):
        # plays may be as small as rounding, but none is as large as a metre
        if number.quantity != "play":
            given[number.quantity][".".join(number.place)] = number.value
        elif abs(number.value) > 1:
            given["length"][".".join(number.place)] = number.value

    given.pop("", None)
    if not dimensions:
        given.pop("length", None)
    for quantity, values in given.items():
        arguments.warn_of_units(quantity, **values)


@contextmanager
def without_unit_warnings() -> Iterator[None]:
    """Leave out the warnings of the models: unusual joints are reported by their margins."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnitWarning)
        yield
