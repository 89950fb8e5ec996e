"""Input of the solver: the joint, its motion under load, and its mount."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    check_fields,
    formula,
    require_increasing,
    require_single,
    warn_of_units,
)
from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds.flow import Fluid, check_cavitation


@dataclass(frozen=True)
class Journal:
    """A pin in a bushing, and the oil between them.

    Raises
    ------
    ModelError
        A length, radius or viscosity that is not one positive number, a bushing not larger than its
        pin, or a cavitation pressure above ambient.

    Attributes
    ----------
    pin_radius, bushing_radius, length : float
        Radii of pin and bore, and length of the bearing. [m]
    viscosity, pressure_viscosity : float
        Viscosity at ambient pressure [Pa s], coefficient of Barus' law [1/Pa].
    cavitation_pressure : float
        Pressure at which the film ruptures, relative to ambient; 0 where cavities are vented. [Pa]
    long : bool
        Whether the bearing is infinitely long: no flow along the axis, one row of cells. The load
        then stands for the given length.
    axial_shape : array or None
        Height added to the gap by edges, lobes, wear or bending: values at equal distances from one
        end of the length to the other, both ends included, linear between them. [m]
    foundation : float or None
        Pressure over deflection of an elastic liner (Winkler). [Pa/m]
    roughness : float or None
        Combined rms roughness of both surfaces. [m] It changes the flow under pressure; that of
        shear, which cancels where both surfaces are equally rough, is left out.

    Examples
    --------
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    >>> print(f"{joint.clearance * 1e6:.0f} um")
    230 um
    """

    pin_radius: float
    bushing_radius: float
    length: float
    viscosity: float
    pressure_viscosity: float = 0.0
    cavitation_pressure: float = -1e5
    long: bool = False
    axial_shape: Values = None
    foundation: float | None = None
    roughness: float | None = None

    def __post_init__(self) -> None:
        check_fields(
            self, cavitation_pressure="signed number", foundation="number", roughness="film"
        )

        # then what the numbers are to each other
        require_increasing(pin_radius=self.pin_radius, bushing_radius=self.bushing_radius)
        check_cavitation(self.cavitation_pressure)
        if self.axial_shape is not None:
            self._check_shape()

    def _check_shape(self) -> None:
        """Refuse an axial shape that is no row of heights."""
        shape = np.asarray(self.axial_shape, dtype=float)
        if self.long:
            raise ModelError("An infinitely long bearing has no axial shape: set long=False.")
        if shape.ndim != 1 or shape.size < 2 or not np.isfinite(shape).all():
            raise ModelError(
                "axial_shape must hold two or more finite heights from end to end, got shape "
                f"{shape.shape}."
            )

    @property
    def clearance(self) -> float:
        """Radial clearance. [m]"""
        return self.bushing_radius - self.pin_radius

    @property
    def least_clearance(self) -> float:
        """Radial clearance where the bore is narrowest along the axis. [m]"""
        return self.clearance + float(np.min(0.0 if self.axial_shape is None else self.axial_shape))

    def with_clearance(self, more: float) -> "Journal":
        """Return the joint with another radial clearance and the same radius of its film.

        Parameters
        ----------
        more : float
            Over the clearance of this one. [1]

        Returns
        -------
        Journal
        """
        half = 0.5 * more * self.clearance
        middle = float(np.hypot(self.radius, half))
        return replace(self, pin_radius=middle - half, bushing_radius=middle + half)

    def clearance_at(self, axial: Array) -> Array:
        """Radial clearance at places along the axis. [m]

        Parameters
        ----------
        axial : array
            Distance from the middle of the length. [m]

        Returns
        -------
        array
            Like axial.
        """
        shape = np.zeros(2) if self.axial_shape is None else np.asarray(self.axial_shape, float)
        places = np.linspace(-0.5, 0.5, shape.size) * self.length
        return np.asarray(self.clearance + np.interp(axial, places, shape))

    @property
    def radius(self) -> float:
        """Radius at which the film lies: the geometric mean of both. [m]

        The curvature of the gap over the distance x = R phi is then that of the conformal radius.
        """
        return float(np.sqrt(self.pin_radius * self.bushing_radius))

    @property
    def squeeze_constant(self) -> float:
        """12 pi eta L R (R/c)^2: load of a centred long film over d eps / dt. [N s]"""
        shape = self.length * self.radius**3 / self.clearance**2
        return float(12 * np.pi * self.viscosity * shape)

    @property
    def fluid(self) -> Fluid:
        """The oil between the walls."""
        return Fluid(self.viscosity, self.pressure_viscosity, self.roughness or 0.0)


@dataclass(frozen=True, eq=False)  # compared by identity, as a key of caches
class Motion:
    """Rotation of the bushing and the load on the pin, step by step.

    Raises
    ------
    ModelError
        Times that do not increase, arrays of different lengths, values that are not finite.

    Attributes
    ----------
    time : array, (step,)
        Times; the film is at its start at the first. [s]
    angle : array, (step,)
        Rotation of the bushing, positive towards positive phi. [rad]
    load : float or array, (step,)
        Force on the pin. [N]
    load_direction : float or array, (step,)
        Direction of the load, from the load line phi = 0. [rad]

    Examples
    --------
    >>> time = np.linspace(0.0, 1.0, 101)
    >>> swing = Motion(time, angle=0.2 * np.sin(2 * np.pi * time), load=222.4)
    """

    time: Array
    angle: Array
    load: Values
    load_direction: Values = 0.0

    def __post_init__(self) -> None:
        for name in ("time", "angle", "load", "load_direction"):
            value = np.asarray(getattr(self, name), dtype=float)
            if not np.isfinite(value).all():
                raise ModelError(f"{name} must be finite at every step.")
            object.__setattr__(self, name, value)
        if self.time.ndim != 1 or self.time.size < 2 or not (np.diff(self.time) > 0).all():
            raise ModelError("time must hold two or more increasing values.")
        for name in ("angle", "load", "load_direction"):
            value = getattr(self, name)
            if value.ndim and value.shape != self.time.shape:
                raise ModelError(
                    f"{name} must have one value for each of the {self.time.size} times, got shape "
                    f"{value.shape}."
                )
            object.__setattr__(self, name, np.broadcast_to(value, self.time.shape))
        warn_of_units("load", load=self.load)

    def at(self, steps: Any) -> "Motion":
        """The motion at some of its steps.

        Parameters
        ----------
        steps : slice or indices
            Steps, as numpy selects them.

        Returns
        -------
        Motion
            Of these steps alone.
        """
        return Motion(
            self.time[steps], self.angle[steps], self.load[steps], self.load_direction[steps]
        )


@formula(
    crank_speed="signed number", load="signed number", cycles="number", start_crank="signed number"
)
def crank_motion(
    linkage: CrankRocker,
    *,
    crank_speed: float,
    load: Values,
    cycles: float = 1.0,
    steps_per_cycle: float = 100,
    start_crank: float = 0.0,
) -> Motion:
    """Make the motion of a joint whose bushing turns with the rocker of a linkage.

    Parameters
    ----------
    linkage : CrankRocker
        The linkage. The angle of the bushing is that of the rocker about the middle of its swing.
    crank_speed : float
        Speed of the crank, of either sign. [rad/s]
    load : float or array, (step,)
        Load on the pin, constant or at each time. [N]
    cycles : float
        Turns of the crank. [1]
    steps_per_cycle : float
        Time steps of a turn. [1]
    start_crank : float
        Crank angle at time zero. [rad]

    Returns
    -------
    Motion
        Times from zero, and rotation of the bushing.

    Raises
    ------
    ModelError
        A crank at rest, or no steps.

    Examples
    --------
    The rig of Farzaneh (2002) swings its bushing by 24.43 degrees:

    >>> from erlif.models.mechanism import CrankRocker
    >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    >>> motion = crank_motion(rig, crank_speed=11.94, load=222.4, steps_per_cycle=500)
    >>> print(f"{np.degrees(np.ptp(motion.angle)):.2f}")
    24.43
    """
    if crank_speed == 0:
        raise ModelError("crank_speed must not be zero: a crank at rest has no cycle.")
    turned = np.arange(round(cycles * steps_per_cycle) + 1.0) * (2 * np.pi / steps_per_cycle)
    middle = float(np.mean(linkage.limits()))
    angle = linkage.rocker_angle(start_crank + np.sign(crank_speed) * turned) - middle
    return Motion(turned / abs(crank_speed), angle=np.asarray(angle), load=load)


@dataclass(frozen=True)
class Mount:
    """Sideways support of the pin, perpendicular to its direction of free motion.

    Raises
    ------
    ModelError
        A negative stiffness.

    Attributes
    ----------
    stiffness : float
        Force over sideways displacement: 0 for a free pin, infinite for a guided one. [N/m]
    rest : float or None
        Sideways position at which the mount is without force; None for that of the start. [m]
    direction : float or None
        Direction of free motion from the load line. None stands for that of the load, which must
        then be constant. [rad]

    Examples
    --------
    >>> Mount(stiffness=2e4).guided
    False
    """

    stiffness: float = 0.0
    rest: float | None = None
    direction: float | None = None

    def __post_init__(self) -> None:
        require_single(stiffness=self.stiffness)
        if not self.stiffness >= 0:
            raise ModelError(f"stiffness must not be negative, got {self.stiffness:g} N/m.")
        for name in ("rest", "direction"):
            if getattr(self, name) is not None and not np.isfinite(getattr(self, name)):
                raise ModelError(f"{name} of a mount must be finite, got {getattr(self, name)}.")

    @property
    def guided(self) -> bool:
        """Whether sideways motion is prevented."""
        return bool(np.isinf(self.stiffness))

    def direction_for(self, motion: Motion) -> float:
        """Direction of free motion, from the motion where the mount has none of its own. [rad]

        Parameters
        ----------
        motion : Motion
            Its load must keep its direction where this decides.

        Raises
        ------
        ModelError
            A held pin without a direction under a load that turns.
        """
        if self.direction is not None:
            return self.direction
        if self.stiffness == 0:
            return 0.0
        if np.ptp(motion.load_direction) > 0:
            raise ModelError(
                "A pin that is held sideways needs a direction of free motion where the load "
                "turns: give Mount(direction=...)."
            )
        return float(motion.load_direction[0])


def as_mount(sideways: "str | float | Mount") -> Mount:
    """The mount of a name, of a stiffness, or itself.

    Parameters
    ----------
    sideways : str, float or Mount
        "free", "guided", or a stiffness. [N/m]

    Returns
    -------
    Mount
        The mount.

    Raises
    ------
    ModelError
        Another name.

    Examples
    --------
    >>> as_mount("guided").guided
    True
    """
    if isinstance(sideways, Mount):
        return sideways
    if isinstance(sideways, str):
        if sideways not in ("free", "guided"):
            raise ModelError(
                f'sideways must be "free", "guided", a stiffness or a Mount, got {sideways!r}.'
            )
        return Mount(np.inf if sideways == "guided" else 0.0)
    return Mount(float(sideways))


@dataclass(frozen=True)
class Groove:
    """A supply of oil at ambient pressure over the whole length.

    Attributes
    ----------
    angle : float
        Middle of the groove, from the load line. [rad]
    width : float
        Angle that it covers; a groove always covers one column of cells at least. [rad]
    """

    angle: float
    width: float = 0.0


def covered(grooves: Sequence[Groove], angles: Array) -> Array:
    """Mark the columns of cells that lie in a groove.

    Parameters
    ----------
    grooves : sequence of Groove
        The grooves.
    angles : array, (circumference,)
        Angles of the cells from the load line. [rad]

    Returns
    -------
    array of bool, (circumference,)
        True in a groove.

    Examples
    --------
    >>> from erlif.models.reynolds import Groove
    >>> covered([Groove(np.pi)], np.radians([0.0, 90.0, 180.0, 270.0]))
    array([False, False,  True, False])
    """
    inside = np.zeros(angles.shape, dtype=bool)
    for groove in grooves:
        off = np.abs((angles - groove.angle + np.pi) % (2 * np.pi) - np.pi)
        if groove.width:
            inside |= off < groove.width / 2
        inside[np.argmin(off)] = True
    return inside


def turn_vectors(vectors: Array, angle: Array | float) -> Array:
    """Turn vectors in the plane of the joint.

    Parameters
    ----------
    vectors : array, (..., axis)
        Along a direction and a right angle ahead.
    angle : array, (...), or float
        [rad]

    Returns
    -------
    array, (..., axis)

    Examples
    --------
    >>> turn_vectors(np.array([1.0, 0.0]), np.pi / 2).round(9)
    array([0., 1.])
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    along, side = vectors[..., 0], vectors[..., 1]
    return np.stack([along * cosine - side * sine, along * sine + side * cosine], axis=-1)
