"""State of a fully dimensioned joint: quantities that several steps need, computed once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from erlif.core.arrays import Array
from erlif.joint.models.bearing import RECOMMENDED_PLAY, press_fit_displacement
from erlif.joint.models.wear import bushing_heat_share, friction_heat, thermal_growth
from erlif.joint.sizing.joint import Joint, dimensions_of, known
from erlif.models.contact import (
    FULL_CONTACT,
    closed_contact_pressure,
    contact_modulus,
    hertz_line,
    persson_half_angle,
    persson_peak_group,
    persson_pressure,
)

# Share of the heat in the bushing from which eq. 29 gives its temperature; the pin has no path for
# the rest in the guide, which computes bushings of metal, about a half. An assumption. [1]
LEAST_SHARE = 0.1

# Arc through which heat flows: the loaded half of the bushing, as eq. 29 is printed. [rad]
HALF_RING = math.pi


@dataclass(frozen=True)
class Contact:
    """The contact of a pin in its bushing, after eqs. 8 and 9.

    Attributes
    ----------
    half_angle : float
        Half contact angle; pi where the bushing touches the pin all around. [rad]
    peak : float
        Peak pressure of eq. 9. [Pa]
    modulus : float
        Modulus of two equal bodies that are as stiff as these, plane stress. [Pa]
    hertz_peak : float
        Peak pressure of eq. 8; NaN without play or Poisson's ratios. [Pa]
    hertz_half_angle : float
        Half contact angle of eq. 8, likewise. [rad]
    """

    half_angle: float
    peak: float
    modulus: float
    hertz_peak: float
    hertz_half_angle: float


class JointState:
    """A joint with all dimensions, and what several steps need of it.

    Parameters
    ----------
    joint : Joint
        With all dimensions.

    Raises
    ------
    ModelError
        If a dimension is not known.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_joint
    >>> print(f"{JointState(example_joint()).play * 1e6:.1f} um")
    110.1 um
    """

    def __init__(self, joint: Joint) -> None:
        self.joint = joint
        self.size = dimensions_of(joint)

    # fit

    @cached_property
    def displacement(self) -> float:
        """Radial displacement of the bore by the press fit, eqs. 24 and 25: negative where it
        shrinks, NaN where an elastic constant is not known or the housing is not larger than the
        fit. [m]"""
        joint, size = self.joint, self.size
        if joint.interference <= 0:
            return 0.0
        if size.housing <= size.fit or size.wall <= 0:
            return math.nan
        return float(
            press_fit_displacement(
                joint.interference,
                bore=size.pin,
                fit_diameter=size.fit,
                housing_diameter=size.housing,
                youngs_bushing=known(joint.bushing.youngs_modulus),
                poisson_bushing=known(joint.bushing.poissons_ratio),
                youngs_housing=known(joint.housing.youngs_modulus),
                poisson_housing=known(joint.housing.poissons_ratio),
            )
        )

    @property
    def gain(self) -> float:
        """Play added by pressing, negative where the bore shrinks; 0 if it is unknown. [m]"""
        return 0.0 if math.isnan(self.displacement) else 2 * self.displacement

    @property
    def play(self) -> float:
        """Play with the bushing pressed in; without the loss where it is not known. [m]"""
        return self.size.play + self.gain

    @cached_property
    def fit_pressure(self) -> float:
        """Pressure between bushing and housing, from the displacement of the bore. Lame. [Pa]"""
        if self.displacement == 0:
            return 0.0

        # the bore is free of pressure: its hoop strain has its hoop stress alone
        modulus = known(self.joint.bushing.youngs_modulus)
        hoop = modulus * abs(self.displacement) / (self.size.pin / 2)
        return hoop * (1 - (self.size.pin / self.size.fit) ** 2) / 2

    # contact

    @property
    def projected(self) -> float:
        """Largest load over pin diameter and bushing width. [Pa]"""
        return self.joint.force / (self.size.pin * self.size.width)

    @cached_property
    def contact(self) -> Contact | None:
        """Contact of pin and bushing with the assembled play; None without both moduli."""
        one, two = self.joint.pin, self.joint.bushing
        if one.youngs_modulus is None or two.youngs_modulus is None:
            return None
        modulus = 2 / (1 / one.youngs_modulus + 1 / two.youngs_modulus)
        load, play, pin = self.joint.force / self.size.width, self.play, self.size.pin
        if modulus * play / (2 * load) <= FULL_CONTACT:
            half_angle = math.pi
            peak = closed_contact_pressure(
                load, interference=-play, pin_diameter=pin, youngs_modulus=modulus
            )
        else:
            half_angle = persson_half_angle(modulus * play / (2 * load))
            peak = persson_peak_group(half_angle) * 2 * load / pin

        flat = flat_angle = math.nan
        if play > 0:
            both = contact_modulus(
                one.youngs_modulus,
                poisson_1=known(one.poissons_ratio),
                youngs_2=two.youngs_modulus,
                poisson_2=known(two.poissons_ratio),
            )
            line = hertz_line(load, radius=pin * (pin + play) / (2 * play), contact_modulus=both)
            flat = float(line.pressure)
            flat_angle = math.asin(min(float(line.half_width) / (pin / 2), 1.0))
        return Contact(float(half_angle), float(peak), modulus, flat, flat_angle)

    def pressure_over_arc(self, angle: Array) -> Array:
        """Pressure at angles from the load [rad] after eq. 9; NaN where it is not known. [Pa]"""
        contact, pin = self.contact, self.size.pin
        if contact is None:
            return np.full(angle.shape, np.nan)
        load = self.joint.force / self.size.width
        if contact.half_angle >= math.pi:
            cosine: Array = contact.peak + 2 * load / (math.pi * pin) * (np.cos(angle) - 1)
            return cosine
        pressure: Array = persson_pressure(
            angle, load_per_length=load, half_angle=contact.half_angle, pin_diameter=pin
        )
        return pressure

    # motion and heat

    @property
    def speed(self) -> float:
        """Mean sliding speed; NaN where the motion is not known. [m/s]"""
        return self.joint.speed(self.size.pin)

    @cached_property
    def share(self) -> float:
        """Share of the heat that enters the bushing, by the conductivities. Eq. 28."""
        pin, ring = known(self.joint.pin.conductivity), known(self.joint.bushing.conductivity)
        return float(bushing_heat_share(pin, bushing_conductivity=ring))

    @property
    def heat_is_shared(self) -> bool:
        """Whether enough of the heat enters the bushing for eq. 29, or the share is not known."""
        return not self.share < LEAST_SHARE

    @cached_property
    def heat(self) -> float:
        """Friction heat that enters the bushing. Eqs. 27 and 28. [W]"""
        force, friction = self.joint.moving_force, self.joint.friction
        return float(friction_heat(force, friction=friction, speed=self.speed) * self.share)

    @property
    def rise(self) -> float:
        """Rise of the sliding surface over the outside. Eq. 29, through the loaded half. [K]"""
        conductivity = known(self.joint.bushing.conductivity)
        # conduction through a cylindrical wall; the rise itself keeps its digits where it is small
        wall = math.log1p(2 * self.size.wall / self.size.pin)
        return self.heat * wall / (HALF_RING * self.size.width * conductivity)

    @property
    def temperature_limit(self) -> float:
        """Highest temperature of the surface: that of the grease or of the bushing. [degC]"""
        grease = self.joint.grease_temperature
        return min(grease, known(self.joint.bushing.temperature, grease))

    @cached_property
    def growth_loss(self) -> float:
        """Play that the growth of warm parts takes, eq. 30; NaN where a property is missing. [m]

        The bushing grows freely or is held by the housing, whichever leaves less play.
        """
        joint, size, rise = self.joint, self.size, self.rise
        parts = joint.pin, joint.bushing, joint.housing
        pin, ring, housing = (known(part.expansion) for part in parts)
        outside = joint.outside_temperature - joint.assembly_temperature
        wall_rise = outside + rise / 2
        grown_pin = thermal_growth(size.pin, expansion=pin, temperature_change=outside + rise)
        free = thermal_growth(size.pin, expansion=ring, temperature_change=wall_rise)
        held = thermal_growth(size.fit, expansion=housing, temperature_change=outside)
        held -= 2 * size.wall * ring * wall_rise
        return float(grown_pin - np.minimum(free, held))

    @property
    def least_play(self) -> float:
        """Least play before pressing that is recommended, cold and warm. [m]"""
        loss = self.growth_loss
        wanted = RECOMMENDED_PLAY[0] * 1e-3 * self.size.pin
        return max(wanted, loss if math.isfinite(loss) else 0.0) - self.gain
