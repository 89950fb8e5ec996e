"""Tables of the surfaces that carry the film and of their oil: [joint], [contact], [oil]."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pydantic import Field

from erlif.io.settings.bore import BoreSettings
from erlif.io.settings.values import (
    CurvatureRadius,
    Force,
    Length,
    Pressure,
    PressureViscosity,
    Settings,
    Share,
    Temperature,
    TemperatureDifference,
    Text,
    Viscosity,
)


class MaterialSettings(Settings):
    """One side of the joint."""

    youngs_modulus: Pressure
    """Young's modulus."""
    poissons_ratio: float = Field(strict=True, gt=-1, le=0.5, examples=[0.37])
    """Poisson's ratio."""
    roughness: Length | None = Field(None, examples=["0.2 um"])
    """Rms roughness of the surface. Default: no film parameter Lambda is computed."""


class LinerSettings(Settings):
    """A thin elastic layer in the bushing, bonded to a rigid one: a Winkler foundation."""

    thickness: Length = Field(examples=["1 mm"])
    """Thickness of the layer."""
    youngs_modulus: Pressure = Field(examples=["1.4 GPa"])
    """Young's modulus of the layer."""
    poissons_ratio: float = Field(strict=True, gt=-1, lt=0.5, examples=[0.4])
    """Poisson's ratio of the layer; a layer of 0.5 that cannot spread does not yield."""


class JointSettings(Settings):
    """The pin and the bushing it turns in."""

    pin_radius: Length = Field(examples=["33.36 mm"])
    """Radius of the pin."""
    bushing_radius: Length = Field(examples=["33.59 mm"])
    """Inner radius of the bushing, larger than pin_radius."""
    clearance_std: Length | None = Field(None, examples=["1 um"])
    """Standard deviation of the radial clearance, for the pressure, `predict --fit` and the error
    of the predicted film. Default: exact for the pressure; known to the last digits of both radii
    for the others."""
    length: Length = Field(examples=["237 mm"])
    """Loaded length of the joint along its axis."""
    load: Force | None = None
    """Load on the joint. Used where the encoder log has no column load_N, and required there."""
    pin: MaterialSettings
    bushing: MaterialSettings
    bore: BoreSettings | None = Field(
        None,
        examples=[{"lobes": ["-50 mm", "50 mm"], "lobe_radius": "200 mm", "lobe_height": "20 um"}],
    )
    """The bore along its axis where it is not straight. Position, minimum and prediction of the
    film take its shape. Default: straight."""
    liner: LinerSettings | None = Field(
        None,
        examples=[{"thickness": "1 mm", "youngs_modulus": "1.4 GPa", "poissons_ratio": 0.4}],
    )
    """A thin elastic layer on the bushing, which the pressure of the prediction deflects. Default:
    none; the prediction takes the surfaces as rigid."""

    def faults(self) -> Iterator[str]:
        if self.pin_radius >= self.bushing_radius:
            yield (
                "pin_radius must be smaller than bushing_radius for the pin to turn; got "
                f"{self.pin_radius * 1e3:g} mm in {self.bushing_radius * 1e3:g} mm"
            )
        if self.bore is not None:
            yield from self.bore.faults_in(
                float(self.length), self.bushing_radius - self.pin_radius
            )


class BodySettings(MaterialSettings):
    """A body of the contact: its curvature, its material and its surface."""

    radius: CurvatureRadius | None = Field(None, examples=["9.525 mm"])
    """Radius of a ball. Default: the body is flat."""
    radius_along: CurvatureRadius | None = Field(None, examples=["9.525 mm"])
    """Radius along the sliding direction, negative in a bore. Default: radius."""
    radius_across: CurvatureRadius | None = Field(None, examples=["50 mm"])
    """Radius across the sliding direction, negative in a groove. Default: radius."""

    def faults(self) -> Iterator[str]:
        if 0 in (self.radius, self.radius_along, self.radius_across):
            yield "a radius must not be zero; leave it out where the body is flat"

    def curvature(self, own: float | None) -> float:
        """Curvature in one direction, of its `own` radius or that of the ball. [1/m]"""
        radius = own or self.radius
        return 0.0 if radius is None else 1 / radius


class ContactSettings(Settings):
    """Ball, barrel or roller on a disc, ring or plane, in place of [joint]."""

    length: Length | None = Field(None, examples=["10 mm"])
    """Length of a line contact across the sliding direction, as of a roller. Default: the bodies
    touch in a point."""
    load: Force | None = Field(None, examples=["20 N"])
    """Load on the contact, where neither the encoder log nor [mechanism] has one."""
    slide_to_roll: float = Field(2.0, strict=True, ge=0)
    """Slide-to-roll ratio: difference of the two surface speeds over their mean. The speed of
    [mechanism], or of the log, is that of the faster surface: the mean is that speed over
    1 + slide_to_roll/2. 2 is pure sliding, 0 pure rolling."""
    body: BodySettings
    counterbody: BodySettings

    @property
    def radii(self) -> tuple[float, float]:
        """Reduced radii along and across the sliding direction, infinite where flat. [m]"""
        one, other = self.body, self.counterbody
        along = one.curvature(one.radius_along) + other.curvature(other.radius_along)
        across = one.curvature(one.radius_across) + other.curvature(other.radius_across)
        return 1 / along if along else math.inf, 1 / across if across else math.inf

    def faults(self) -> Iterator[str]:
        along, across = self.radii
        if not 0 < along < math.inf or across < 0:
            yield (
                "the bodies must touch in a point or a line: make the sum of their curvatures, "
                "1/radius and negative where hollow, positive along the sliding direction and not "
                "negative across it"
            )
        if (self.length is None) == math.isinf(across):
            yield (
                "give radius or radius_across of a body, for a contact in a point, or length, for "
                "bodies that are straight across the sliding direction"
            )


class VogelSettings(Settings):
    """Vogel's law, viscosity = a exp(b/(T - c))."""

    a: Viscosity = Field(examples=["0.05 mPa s"])
    """Viscosity in the limit of high temperature."""
    b: TemperatureDifference
    """Slope of ln(viscosity) over 1/(T - c)."""
    c: Temperature
    """Temperature of the pole, below every temperature logged."""


class OilSettings(Settings):
    """The oil between pin and bushing."""

    name: Text = Field("", examples=["80W-90"])
    """Name of the oil in figures and reports."""
    viscosity: Viscosity | None = None
    """Dynamic viscosity at the temperature of the run. Either viscosity or vogel is required."""
    vogel: VogelSettings | None = Field(
        None, examples=[{"a": "0.05 mPa s", "b": "1100 K", "c": "-115 degC"}]
    )
    """Viscosity from the logged temperature by Vogel's law, a exp(b/(T - c)), in place of one
    value."""
    viscosity_std: Viscosity | None = Field(None, examples=["0.004 Pa s"])
    """Standard deviation of the viscosity, with a vogel law at the mean temperature of the run, for
    the pressure, `predict --fit` and the error of the predicted film. Default: the viscosity is
    exact."""
    drift_std: Share | None = Field(None, examples=["5 %"])
    """Standard deviation of the change of the viscosity from the first frame to the last, beside
    that of the logged temperature, for `predict --fit`. Default: of a vogel law, what reading_std
    of [temperature] makes; else no change."""
    pressure_viscosity: PressureViscosity
    """Pressure-viscosity coefficient of Barus."""

    def faults(self) -> Iterator[str]:
        if (self.viscosity is None) == (self.vogel is None):
            yield 'give either viscosity = "0.12 Pa s" or a vogel law { a, b, c }'
