"""The film of every frame: by the law of its trigger, or where load and motion put the pin.

The film "reynolds" is that of two parallel cylinders, rigid unless the bushing has a liner. It
changes from cycle to cycle, so every frame has its own.
"""

from dataclasses import dataclass, replace

import numpy as np

from erlif.core.arrays import Array
from erlif.rig.cavitation import Deflection, follow_cavitated
from erlif.rig.film import (
    Gap,
    Marks,
    Triggers,
    bore_height,
    crank_at,
    cycle_time,
    load_of,
    rocker_angle,
    rocker_range,
    rocker_speed,
)
from erlif.rig.logger import frame_times
from erlif.rig.orbit import RigidBearing, follow_orbit, lowest_pressure
from erlif.rig.settings import RigSettings

_HISTORY = 60  # moments since loading at which the lowest pressure is looked up
_STEPS = 100  # steps of a film with cavities in a turn of the crank


@dataclass(frozen=True)
class JournalGap(Gap):
    """Film between two parallel cylinders whose axes are apart.

    Attributes
    ----------
    along : float
        Displacement of the pin along the load. [um]
    side : float
        Displacement of the pin along +x. [um]
    deflection : Deflection | None
        Of an elastic liner.
    """

    along: float
    side: float
    deflection: Deflection | None = None

    def smooth(self, x: Array, y: Array) -> Array:
        """Film without marks, c - e cos(phi - attitude); phi = 0 is the load line. [um]"""
        rig = self.rig
        phi = ((x - rig.centre[0]) * rig.pitch - rig.thin_line) / rig.journal_radius
        gap = rig.clearance - self.along * np.cos(phi) - self.side * np.sin(phi)
        gap = gap + self.shape(y)
        if self.deflection is not None:
            axial = (y - rig.centre[1]) * rig.pitch - rig.axial_centre
            gap = gap + 1e6 * self.deflection.at(*np.broadcast_arrays(phi, 1e-3 * axial))
        return np.asarray(gap)

    @property
    def eccentricity(self) -> float:
        """Distance of the axes over the clearance. [1]"""
        return float(np.hypot(self.along, self.side)) / self.rig.clearance

    @property
    def attitude(self) -> float:
        """Angle from the load line to the thinnest film, positive along +x. [rad]"""
        return float(np.arctan2(self.side, self.along))


def list_gaps(triggers: Triggers, rig: RigSettings, marks: Marks) -> list[Gap]:
    """List the films: one for each trigger by the law, one for each frame of "reynolds".

    Frame k has the film k modulo their number.
    """
    if rig.film == "law":
        return [Gap(rig, float(film), marks) for film in triggers.film_min]
    if not rig.liner[0]:
        place = 1e6 * follow_pin(frame_times(triggers, rig), rig)
        return [_place_pin(rig, marks, float(along), float(side)) for along, side in place]
    deflections: list[Deflection] = []
    place = 1e6 * follow_pin(frame_times(triggers, rig), rig, deflections)
    return [
        _deflect(JournalGap(rig, np.nan, marks, float(along), float(side), deflection))
        for (along, side), deflection in zip(place, deflections, strict=True)
    ]


def _deflect(gap: JournalGap) -> JournalGap:
    """The gap with the minimum of its film in the region, at two places a pixel."""
    x, y = (
        np.linspace(*ends, 2 * size) / gap.rig.pitch
        for ends, size in zip(gap.rig.region, (gap.rig.width, gap.rig.height), strict=True)
    )
    return replace(gap, film_min=float(gap.smooth(x, y[:, np.newaxis]).min()))


def _place_pin(rig: RigSettings, marks: Marks, along: float, side: float) -> JournalGap:
    """The gap of a pin at a place [um]; its minimum in the region follows from the place."""
    attitude = np.arctan2(side, along)
    edges = (np.array(rig.region[0]) - rig.centre[0] * rig.pitch - rig.thin_line) / (
        rig.journal_radius
    )
    thinnest = np.clip(attitude, *edges)
    film_min = rig.clearance - np.hypot(along, side) * np.cos(thinnest - attitude)
    film_min += Gap(rig, 0.0, marks).least_shape
    return JournalGap(rig, float(film_min), marks, along, side)


def load_at(time: Array, rig: RigSettings) -> Array:
    """Load on the joint [N] at times [s] after the smallest rocker angle."""
    return load_of(crank_at(time, rig), rig)


def follow_pin(time: Array, rig: RigSettings, deflections: list[Deflection] | None = None) -> Array:
    """Displacement of the pin at rising times after the smallest rocker angle [s].

    The linkage turns all the time. The load comes on `elapsed` cycles before time 0, with the pin
    in the middle of the bushing. A rising rocker angle moves the surface of the bushing along +x.
    `deflections` receives the deflection of a liner at each time.

    Returns
    -------
    array, (time, direction)
        Along the load and along +x. [m]
    """
    bearing = RigidBearing(
        radius=1e-3 * rig.journal_radius,
        clearance=1e-6 * rig.clearance,
        length=1e-3 * rig.length,
        viscosity=rig.viscosity,
        shape=(lambda axial: 1e-6 * bore_height(rig, 1e3 * axial)) if rig.shaped else None,
        compliance=_liner_compliance(rig),
        roughness=1e-6 * np.sqrt(2) * rig.roughness if rig.rough else 0.0,
    )
    cycle, middle = cycle_time(rig), float(np.mean(rocker_range(rig)))
    moments = np.append(-rig.elapsed * cycle, time)

    def load(moment: float) -> float:
        return float(load_at(np.asarray(moment), rig))

    def speed(moment: float) -> float:
        return float(rocker_speed(crank_at(np.asarray(moment), rig), rig))

    def angle(moment: float) -> float:
        return float(rocker_angle(crank_at(np.asarray(moment), rig), rig)) - middle

    # a free pin squeezes a full film, unless its pressure would fall below that of cavities
    cavity = 1e3 * rig.cavitation_pressure
    if rig.sideways == "free" and not (rig.shaped or bearing.compliance or rig.rough):
        history = np.linspace(moments[0], moments[-1], _HISTORY)
        looked_up = np.union1d(history, moments)
        path = follow_orbit(bearing, looked_up, load=load, rotation=speed)
        lowest = min(
            lowest_pressure(bearing, path[np.searchsorted(looked_up, moment)], load(moment))
            for moment in history
        )
        if lowest >= cavity:
            return path[np.searchsorted(looked_up, moments)][1:]

    stiffness = {"free": 0.0, "guided": np.inf}.get(str(rig.sideways), rig.sideways)
    return follow_cavitated(
        bearing,
        moments,
        load=load,
        angle=angle,
        step=cycle / _STEPS,
        stiffness=float(stiffness),
        cavity=cavity,
        deflections=deflections,
    )[1:]


def _liner_compliance(rig: RigSettings) -> float:
    """Deflection of the liner over the pressure on it [m/Pa]: Hooke's law without spread sideways.

    With the strains along the wall zero, its stresses are nu/(1 - nu) of the pressure.
    """
    thickness, modulus, poisson = rig.liner
    strain = 1 - 2 * poisson * poisson / (1 - poisson)
    return 1e-3 * thickness * strain / (1e9 * modulus)
