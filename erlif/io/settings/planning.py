"""The tables of plan.toml, from which `erlif plan` predicts what a rig would measure."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le
from pydantic import Field

from erlif.io.settings.tables import (
    Counts,
    Electrons,
    FileName,
    Gain,
    Length,
    Settings,
    Text,
    Wavelength,
    quantity,
)

# No dye dissolves beyond it in oil; a larger number is a slip of the unit. [mol/L]
LARGEST_CONCENTRATION = 0.5

Concentration = Annotated[float, *quantity("concentration", "0.008 mol/L", "mol/L", Gt(0))]
MolarAbsorption = Annotated[
    float, *quantity("decadic molar absorption coefficient", "2e4 L/mol/cm", "L/mol/cm", Ge(0))
]
EmissionDensity = Annotated[
    float, *quantity("share of the photons per wavelength", "0.012 1/nm", "1/nm", Ge(0))
]
Energy = Annotated[float, *quantity("energy", "50 mJ", "J", Gt(0))]
Width = Annotated[float, *quantity("width of a filter", "10 nm", "nm", Gt(0))]
Shift = Annotated[float, *quantity("shift of a filter", "2 nm", "nm", Ge(0), Le(20))]
FullWell = Annotated[float, *quantity("electrons", "18000 electron", "electron", Gt(0))]
Share = Annotated[float, Field(ge=0, lt=1)]


class CoefficientSettings(Settings):
    """A dye by its coefficients at the laser and in the bands of the cameras."""

    laser: MolarAbsorption
    camera1: MolarAbsorption
    camera2: MolarAbsorption
    emission1: EmissionDensity
    emission2: EmissionDensity


class DyeSettings(Settings):
    """One dye: what dissolves, absorbs and emits."""

    name: Text = ""
    concentration: Concentration
    quantum_yield: float = Field(strict=True, gt=0, le=1)
    spectra: Literal["synthetic 605", "synthetic 650"] | None = None
    absorption: FileName | None = None
    emission: FileName | None = None
    coefficients: CoefficientSettings | None = None

    def faults(self) -> Iterator[str]:
        files = (self.absorption is not None, self.emission is not None)
        if files[0] != files[1]:
            yield "give absorption and emission together, as two CSV files"
        if (self.spectra is not None) + files[0] + (self.coefficients is not None) != 1:
            yield (
                "give the dye once: as spectra (an invented pair), as absorption and emission (two "
                "CSV files), or as coefficients"
            )

        if self.concentration > LARGEST_CONCENTRATION:
            yield (
                f"expected a concentration of at most {LARGEST_CONCENTRATION:g} mol/L, beyond "
                f"which no dye dissolves in oil; got {self.concentration:g} mol/L. Is it "
                f"{self.concentration:g} mmol/L?"
            )


class LaserSettings(Settings):
    """The laser."""

    wavelength: Wavelength
    pulse_energy: Energy
    beam_diameter: Length | None = None
    corner: float = Field(1.0, ge=0.1, le=1)


class OpticsOfPlan(Settings):
    """How much of the light reaches a pixel. Needed where thick_film is not given."""

    pixel_pitch: Length
    numerical_aperture: float = Field(strict=True, gt=0, lt=1)
    refractive_index: float = Field(1.47, strict=True, ge=1, le=2)


class CameraOfPlan(Settings):
    """One camera and its filter."""

    band: Wavelength
    bandwidth: Width = 10.0
    bit_depth: int = Field(12, strict=True, ge=8, le=16)
    gain: Gain
    read_noise: Electrons
    offset: Counts = 64.0
    full_well: FullWell | None = None
    thick_film: Electrons | None = None
    efficiency: float | None = Field(None, strict=True, gt=0, le=1)

    def faults(self) -> Iterator[str]:
        if (self.thick_film is None) == (self.efficiency is None):
            yield ('give either thick_film = "11000 electron" (measured) or efficiency = 0.3')

        counts = (1 << self.bit_depth) - 1 - self.offset
        if counts <= 0:
            yield (
                f"expected an offset below full scale, {(1 << self.bit_depth) - 1} DN; got "
                f"{self.offset:g} DN"
            )
        largest = min(self.full_well or float("inf"), counts * self.gain)
        if largest <= 10 * self.read_noise:
            yield (
                "expected a full well of at least ten times the read noise, "
                f"{10 * self.read_noise:g} electron; got {largest:g} electron. Correct full_well, "
                "read_noise or gain"
            )


class FilmOfPlan(Settings):
    """The films to be measured."""

    thinnest: Length
    thickest: Length
    uncertainty: float = Field(0.05, strict=True, gt=0, lt=1)
    frames: int = Field(1, strict=True, ge=1)
    average: int = Field(1, strict=True, ge=1, le=500)

    def faults(self) -> Iterator[str]:
        if not self.thinnest < self.thickest:
            yield (
                "expected thinnest below thickest; got "
                f"{self.thinnest * 1e6:g} um and {self.thickest * 1e6:g} um. Exchange them"
            )


class FixtureOfPlan(Settings):
    """Films of the calibration fixture."""

    thinnest: Length | None = None
    thickest: Length | None = None


class JointOfPlan(Settings):
    """The joint whose gap shows what no frame shows."""

    pin_radius: Length
    bushing_radius: Length
    width: Length
    frames: int = Field(50, strict=True, ge=12)

    def faults(self) -> Iterator[str]:
        if not self.pin_radius < self.bushing_radius:
            yield "expected a pin_radius below bushing_radius. Correct one of them"
        elif not self.width < 2 * self.pin_radius:
            yield "expected a width of the image below the diameter of the pin. Correct it"


class ReferencesOfPlan(Settings):
    """Dark and flat pages."""

    dark_pages: int = Field(8, strict=True, ge=1)
    flat_pages: int = Field(12, strict=True, ge=0)
    flat_level: float = Field(0.5, strict=True, gt=0, le=1)


class OptimumOptions(Settings):
    """What the concentrations may be where the best ones are sought."""

    largest_concentration: Concentration = 0.05
    fill: float = Field(0.75, strict=True, gt=0, le=1)


class ToleranceOptions(Settings):
    """Tolerances, as shares of the value unless a unit is given."""

    concentration: Share = 0.05
    filter: Shift = 2.0
    pulse_energy: Share = 0.10
    gain: Share = 0.05
    read_noise: Share = 0.20
    full_well: Share = 0.10


class NameOfPlan(Settings):
    """The plan."""

    name: Text


class PlanSettings(Settings):
    """plan.toml."""

    plan: NameOfPlan
    dye1: DyeSettings
    dye2: DyeSettings
    laser: LaserSettings
    camera1: CameraOfPlan
    camera2: CameraOfPlan
    film: FilmOfPlan
    fixture: FixtureOfPlan = FixtureOfPlan()
    joint: JointOfPlan | None = None
    optics: OpticsOfPlan | None = None
    references: ReferencesOfPlan = ReferencesOfPlan()
    optimum: OptimumOptions = OptimumOptions()
    tolerances: ToleranceOptions = ToleranceOptions()

    @property
    def name(self) -> str:
        """Name of the plan."""
        return self.plan.name

    @property
    def covered(self) -> tuple[float, float]:
        """Films that the fixture covers, by the file or by default. [m]"""
        thinnest = self.fixture.thinnest or self.film.thinnest / 20
        return float(thinnest), float(self.fixture.thickest or 1.5 * self.film.thickest)

    def faults(self) -> Iterator[str]:
        measured = self.camera1.thick_film is not None and self.camera2.thick_film is not None
        parts = {"[optics]": self.optics, "[laser] beam_diameter": self.laser.beam_diameter}
        missing = [name for name, value in parts.items() if value is None]
        if missing and not measured:
            yield (
                f"light follows from efficiency only together with {' and '.join(missing)}: add "
                "them, or give thick_film of both cameras"
            )

        low, high = self.covered
        if not low <= self.film.thinnest < self.film.thickest <= high:
            yield (
                f"expected a fixture that covers the films from {self.film.thinnest * 1e6:g} to "
                f"{self.film.thickest * 1e6:g} um; [fixture] covers {low * 1e6:g} to "
                f"{high * 1e6:g} um"
            )

        for number, camera in ((1, self.camera1), (2, self.camera2)):
            if camera.band - camera.bandwidth / 2 <= self.laser.wavelength:
                yield (
                    f"expected filters above the laser, {self.laser.wavelength:g} nm; that of "
                    f"camera {number} transmits from {camera.band - camera.bandwidth / 2:g} nm"
                )
