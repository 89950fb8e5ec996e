"""The tables of plan.toml, from which `erlif plan` predicts what a rig would measure."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt, Le
from pydantic import Field, create_model

from erlif.core.remedies import REMEDIES
from erlif.io.settings.bore import BoreSettings
from erlif.io.settings.tables import with_widths
from erlif.io.settings.values import (
    Counts,
    Electrons,
    FileName,
    Gain,
    Length,
    Places,
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
    """Molar absorption coefficient at the laser."""
    camera1: MolarAbsorption
    """The same in the band of camera 1."""
    camera2: MolarAbsorption
    """The same in the band of camera 2."""
    emission1: EmissionDensity
    """Share of the emitted photons per nm in the band of camera 1."""
    emission2: EmissionDensity
    """The same in the band of camera 2."""


class DyeSettings(Settings):
    """One dye: what dissolves, absorbs and emits."""

    name: Text = Field("", examples=["Pyrromethene 605"])
    """Name of the dye."""
    concentration: Concentration
    """Concentration in the oil."""
    quantum_yield: float = Field(strict=True, gt=0, le=1, examples=[0.7])
    """Photons emitted for one absorbed."""
    spectra: Literal["synthetic 605", "synthetic 650"] | None = None
    """Invented spectra of no real dye, for a first look. Give this, or absorption and emission, or
    coefficients."""
    absorption: FileName | None = Field(None, examples=["dye1_absorption.csv"])
    """Molar absorption coefficient, decadic, in L/mol/cm: CSV file with the columns
    wavelength_nm,value, beside this file."""
    emission: FileName | None = Field(None, examples=["dye1_emission.csv"])
    """Emission over its whole band in any unit, photons per wavelength: CSV file with the columns
    wavelength_nm,value."""
    coefficients: CoefficientSettings | None = Field(
        None,
        examples=[
            {
                "laser": "8.5e4 L/mol/cm",
                "camera1": "3.5e3 L/mol/cm",
                "camera2": "0 L/mol/cm",
                "emission1": "0.017 1/nm",
                "emission2": "0.008 1/nm",
            }
        ],
    )
    """Coefficients at the laser and in both bands, where no spectra are at hand."""

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

    wavelength: Wavelength = Field(examples=["532 nm"])
    """Wavelength."""
    pulse_energy: Energy
    """Energy of one pulse."""
    beam_diameter: Length | None = Field(None, examples=["25 mm"])
    """Diameter of the beam on the film. Default: it is not known, and light follows from thick_film
    of the cameras."""
    corner: float = Field(1.0, ge=0.1, le=1)
    """Light at the corners of the field over that in its middle, of beam and lens."""


class OpticsOfPlan(Settings):
    """How much of the light reaches a pixel. Needed where thick_film is not given."""

    pixel_pitch: Length = Field(examples=["60 um"])
    """Size of a pixel in the object plane."""
    numerical_aperture: float = Field(strict=True, gt=0, lt=1, examples=[0.1])
    """Sine of the half angle of the light collected, in air."""
    refractive_index: float = Field(1.47, strict=True, ge=1, le=2)
    """Refractive index of the oil."""


class CameraOfPlan(Settings):
    """One camera and its filter."""

    band: Wavelength
    """Centre wavelength of the filter. Camera 1 has the band that dye 2 reabsorbs."""
    bandwidth: Width = 10.0
    """Full width of the filter at half of its transmission."""
    bit_depth: int = Field(12, strict=True, ge=8, le=16)
    """Bits of a count: full scale is 2^bit_depth - 1."""
    gain: Gain
    """Photo-electrons of one count."""
    read_noise: Electrons
    """Rms read noise of a pixel."""
    offset: Counts = 64.0
    """Dark level."""
    full_well: FullWell | None = None
    """Largest signal of a pixel. Default: full scale of the converter."""
    thick_film: Electrons | None = Field(None, examples=["11000 electron"])
    """Photo-electrons of a pixel in mid-beam from a very thick film, at the concentrations and the
    pulse energy of this file. It replaces [optics], beam diameter and efficiency."""
    efficiency: float | None = Field(None, strict=True, gt=0, le=1, examples=[0.3])
    """Photo-electrons for one photon that enters the lens: lens, filter and quantum efficiency.
    Either efficiency or thick_film is required."""

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

    thinnest: Length = Field(examples=["2 um"])
    """Thinnest film to be measured."""
    thickest: Length = Field(examples=["10 um"])
    """Thickest film to be measured."""
    uncertainty: float = Field(0.05, strict=True, gt=0, lt=1, examples=[0.01])
    """Standard deviation wanted, share of the film."""
    frames: int = Field(1, strict=True, ge=1)
    """Frame pairs that are averaged into one map."""
    average: int = Field(1, strict=True, ge=1, le=500)
    """Side of the squares of pixels over which a map is averaged. 1: single pixels. [px]"""

    def faults(self) -> Iterator[str]:
        if not self.thinnest < self.thickest:
            yield (
                "expected thinnest below thickest; got "
                f"{self.thinnest * 1e6:g} um and {self.thickest * 1e6:g} um. Exchange them"
            )


class FixtureOfPlan(Settings):
    """Films of the calibration fixture."""

    thinnest: Length | None = Field(None, examples=["0.1 um"])
    """Default: a twentieth of the thinnest film to be measured."""
    thickest: Length | None = Field(None, examples=["18 um"])
    """Default: 1.5 times the thickest film to be measured."""


class JointOfPlan(Settings):
    """The joint whose gap shows what no frame shows."""

    pin_radius: Length = Field(examples=["33.36 mm"])
    """Radius of the pin."""
    bushing_radius: Length = Field(examples=["33.59 mm"])
    """Radius of the bore."""
    width: Length = Field(examples=["19.2 mm"])
    """Extent of the image along sliding."""
    frames: int = Field(50, strict=True, ge=12)
    """Frame pairs of a run."""
    bore: BoreSettings | None = Field(
        None,
        examples=[{"lobes": ["-50 mm", "50 mm"], "lobe_radius": "200 mm", "lobe_height": "20 um"}],
    )
    """The bore along its axis where it is not straight, with the keys of run.toml. Default:
    straight."""
    length: Length | None = Field(None, examples=["237 mm"])
    """Loaded length of the joint along its axis. Required with bore."""
    field: Places = Field((), examples=[["42 mm", "58 mm"]])
    """Both ends of the image along the axis, from the middle of the joint. Required with bore."""

    def faults(self) -> Iterator[str]:
        if not self.pin_radius < self.bushing_radius:
            yield "expected a pin_radius below bushing_radius. Correct one of them"
        elif not self.width < 2 * self.pin_radius:
            yield "expected a width of the image below the diameter of the pin. Correct it"
        elif self.bore is not None:
            if self.length is None or len(self.field) != 2 or self.field[0] >= self.field[1]:
                yield "bore needs length, and as field both ends of the image along the axis"
            else:
                clearance = self.bushing_radius - self.pin_radius
                yield from self.bore.faults_in(float(self.length), clearance)


class ReferencesOfPlan(Settings):
    """Dark and flat pages."""

    dark_pages: int = Field(8, strict=True, ge=1)
    """Dark pages of each camera."""
    flat_pages: int = Field(12, strict=True, ge=0)
    """Flat pages of each camera, all levels together. 0: the response of the pixels is left out of
    the plan."""
    flat_level: float = Field(0.5, strict=True, gt=0, le=1)
    """Mean light of the flat pages, share of full scale."""


class OptimumOptions(Settings):
    """What the concentrations may be where the best ones are sought."""

    largest_concentration: Concentration = 0.05
    """Largest concentration that dissolves."""
    fill: float = Field(0.75, strict=True, gt=0, le=1)
    """Largest mean signal, share of full scale. Speckle and the scatter of the pulse energy need
    the rest."""


class ToleranceOptions(Settings):
    """Tolerances, as shares of the value unless a unit is given."""

    concentration: Share = 0.05
    """Concentration of each dye."""
    filter: Shift = 2.0
    """Centre wavelength of each filter."""
    pulse_energy: Share = 0.10
    """Pulse energy."""
    gain: Share = 0.05
    """Gain of each camera."""
    read_noise: Share = 0.20
    """Read noise of both cameras."""
    full_well: Share = 0.10
    """Full well of both cameras."""


class SystematicsOfPlan(with_widths("run", "fixture", leave_out="position")):  # type: ignore[misc]
    """Errors that the frames will not show, as standard deviations. The place of the fixture is not
    planned."""


_REMEDIES: dict[str, Any] = {
    key: (bool, Field(False, strict=True, description=f"{remedy.what}. {remedy.why}"))
    for key, remedy in REMEDIES.items()
    if "position" not in remedy.leaves
}


class RemediesOfPlan(create_model("_Remedies", __base__=Settings, **_REMEDIES)):  # type: ignore[misc]
    """What the laboratory does about these errors. `erlif plan` prints what to add."""


class NameOfPlan(Settings):
    """The plan."""

    name: Text = Field(examples=["pin of the crank"])
    """Name, for figures and tables."""


class PlanSettings(Settings):
    """plan.toml."""

    plan: NameOfPlan
    dye1: DyeSettings
    """The dye whose light is reabsorbed."""
    dye2: DyeSettings
    """The dye that reabsorbs it."""
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
    systematics: SystematicsOfPlan = SystematicsOfPlan()
    remedies: RemediesOfPlan = RemediesOfPlan()

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
