"""The tables of plan.toml, from which `erlif plan` predicts what a rig would measure."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

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

LARGEST_CONCENTRATION = 0.5
"""No dye dissolves beyond it in oil; a larger number is a slip of the unit. [mol/L]"""

Concentration = Annotated[float, *quantity("concentration", "0.008 mol/L", "mol/L", Gt(0))]
MolarAbsorption = Annotated[
    float, *quantity("molar absorption coefficient, decadic,", "2e4 L/mol/cm", "L/mol/cm", Ge(0))
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

    laser: MolarAbsorption = Field(description="Molar absorption coefficient at the laser.")
    camera1: MolarAbsorption = Field(description="The same in the band of camera 1.")
    camera2: MolarAbsorption = Field(description="The same in the band of camera 2.")
    emission1: EmissionDensity = Field(
        description="Share of the emitted photons per nm in the band of camera 1."
    )
    emission2: EmissionDensity = Field(description="The same in the band of camera 2.")


class DyeSettings(Settings):
    """One dye: what dissolves, absorbs and emits."""

    name: Text = Field("", description="Name of the dye.", examples=["Pyrromethene 605"])
    concentration: Concentration = Field(description="Concentration in the oil.")
    quantum_yield: float = Field(
        gt=0, le=1, description="Photons emitted for one absorbed.", examples=[0.7]
    )
    spectra: Literal["synthetic 605", "synthetic 650"] | None = Field(
        None,
        description="Invented spectra, for a first look: they are no measured spectra of any dye. "
        "Give this, or absorption and emission, or coefficients.",
    )
    absorption: FileName | None = Field(
        None,
        description="Molar absorption coefficient, decadic, in L/mol/cm: CSV file with the columns "
        "wavelength_nm,value, beside this file.",
        examples=["dye1_absorption.csv"],
    )
    emission: FileName | None = Field(
        None,
        description="Emission over its whole band in any unit, photons per wavelength: CSV file "
        "with the columns wavelength_nm,value.",
        examples=["dye1_emission.csv"],
    )
    coefficients: CoefficientSettings | None = Field(
        None,
        description="Coefficients at the laser and in both bands, where no spectra are at hand.",
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

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        files = (self.absorption is not None, self.emission is not None)
        if files[0] != files[1]:
            raise ValueError("give absorption and emission together, as two CSV files")
        if (self.spectra is not None) + files[0] + (self.coefficients is not None) != 1:
            raise ValueError(
                "give the dye once: as spectra (an invented pair), as absorption and emission (two "
                "CSV files), or as coefficients"
            )
        return self

    @model_validator(mode="after")
    def _dissolves(self) -> Self:
        if self.concentration > LARGEST_CONCENTRATION:
            raise ValueError(
                f"expected a concentration of at most {LARGEST_CONCENTRATION:g} mol/L, beyond "
                f"which no dye dissolves in oil; got {self.concentration:g} mol/L. Is it "
                f"{self.concentration:g} mmol/L?"
            )
        return self


class LaserSettings(Settings):
    """The laser."""

    wavelength: Wavelength = Field(description="Wavelength.", examples=["532 nm"])
    pulse_energy: Energy = Field(description="Energy of one pulse.")
    beam_diameter: Length | None = Field(
        None,
        description="Diameter of the beam on the film. Default: it is not known, and light follows "
        "from thick_film of the cameras.",
        examples=["25 mm"],
    )


class OpticsOfPlan(Settings):
    """How much of the light reaches a pixel. Needed where thick_film is not given."""

    pixel_pitch: Length = Field(
        description="Size of a pixel in the object plane.", examples=["60 um"]
    )
    numerical_aperture: float = Field(
        gt=0, lt=1, description="Sine of the half angle of the light collected, in air."
    )
    refractive_index: float = Field(1.47, ge=1, le=2, description="Refractive index of the oil.")


class CameraOfPlan(Settings):
    """One camera and its filter."""

    band: Wavelength = Field(
        description="Centre wavelength of the filter. Camera 1 has the band that dye 2 reabsorbs."
    )
    bandwidth: Width = Field(
        10.0,
        description="Full width of the filter at half of its transmission.",
        validate_default=False,
    )
    bit_depth: int = Field(
        12, ge=8, le=16, description="Bits of a count: full scale is 2^bit_depth - 1."
    )
    gain: Gain = Field(description="Photo-electrons of one count.")
    read_noise: Electrons = Field(description="Rms read noise of a pixel.")
    offset: Counts = Field(64.0, description="Dark level.", validate_default=False)
    full_well: FullWell | None = Field(
        None,
        description="Largest signal of a pixel. Default: full scale of the converter.",
    )
    thick_film: Electrons | None = Field(
        None,
        description="Photo-electrons of a pixel in mid-beam from a very thick film, at the "
        "concentrations and the pulse energy of this file: measured once, it replaces [optics], "
        "beam diameter and efficiency.",
        examples=["11000 electron"],
    )
    efficiency: float | None = Field(
        None,
        gt=0,
        le=1,
        description="Photo-electrons for one photon that enters the lens: lens, filter and quantum "
        "efficiency. Either efficiency or thick_film is required.",
        examples=[0.3],
    )

    @model_validator(mode="after")
    def _light_is_known(self) -> Self:
        if (self.thick_film is None) == (self.efficiency is None):
            raise ValueError(
                'give either thick_film = "11000 electron" (measured) or efficiency = 0.3'
            )
        return self

    @model_validator(mode="after")
    def _sees_light(self) -> Self:
        counts = (1 << self.bit_depth) - 1 - self.offset
        if counts <= 0:
            raise ValueError(
                f"expected an offset below full scale, {(1 << self.bit_depth) - 1} DN; got "
                f"{self.offset:g} DN"
            )
        largest = min(self.full_well or float("inf"), counts * self.gain)
        if largest <= 10 * self.read_noise:
            raise ValueError(
                "expected a full well of at least ten times the read noise, "
                f"{10 * self.read_noise:g} electron; got {largest:g} electron. Correct full_well, "
                "read_noise or gain"
            )
        return self


class FilmOfPlan(Settings):
    """The films to be measured."""

    thinnest: Length = Field(description="Thinnest film to be measured.", examples=["2 um"])
    thickest: Length = Field(description="Thickest film to be measured.", examples=["10 um"])
    uncertainty: float = Field(
        0.05,
        gt=0,
        lt=1,
        description="Standard deviation wanted, share of the film.",
        examples=[0.01],
    )
    frames: int = Field(1, ge=1, description="Frame pairs that are averaged into one map.")
    average: int = Field(
        1,
        ge=1,
        le=500,
        description="Side of the squares of pixels over which a map is averaged. 1: single "
        "pixels. [px]",
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.thinnest < self.thickest:
            raise ValueError(
                "expected thinnest below thickest; got "
                f"{self.thinnest * 1e6:g} um and {self.thickest * 1e6:g} um. Exchange them"
            )
        return self


class FixtureOfPlan(Settings):
    """Films of the calibration fixture."""

    thinnest: Length | None = Field(
        None,
        description="Default: a twentieth of the thinnest film to be measured.",
        examples=["0.1 um"],
    )
    thickest: Length | None = Field(
        None,
        description="Default: 1.5 times the thickest film to be measured.",
        examples=["18 um"],
    )


class ReferencesOfPlan(Settings):
    """Dark and flat pages."""

    dark_pages: int = Field(8, ge=1, description="Dark pages of each camera.")
    flat_pages: int = Field(
        12,
        ge=0,
        description="Flat pages of each camera, all levels together. 0: the response of the pixels "
        "is left out of the plan.",
    )
    flat_level: float = Field(
        0.5, gt=0, le=1, description="Mean light of the flat pages, share of full scale."
    )


class OptimumOptions(Settings):
    """What the concentrations may be where the best ones are sought."""

    largest_concentration: Concentration = Field(
        0.05, description="Largest concentration that dissolves.", validate_default=False
    )
    fill: float = Field(
        0.75,
        gt=0,
        le=1,
        description="Largest mean signal, share of full scale. Speckle and the scatter of the "
        "pulse energy need the rest; the pulse energy is lowered where the thickest film would "
        "exceed it.",
    )


class ToleranceOptions(Settings):
    """Tolerances, as shares of the value unless a unit is given."""

    concentration: Share = Field(0.05, description="Concentration of each dye.")
    filter: Shift = Field(
        2.0, description="Centre wavelength of each filter.", validate_default=False
    )
    pulse_energy: Share = Field(0.10, description="Pulse energy.")
    gain: Share = Field(0.05, description="Gain of each camera.")
    read_noise: Share = Field(0.20, description="Read noise of both cameras.")
    full_well: Share = Field(0.10, description="Full well of both cameras.")


class NameOfPlan(Settings):
    """The plan."""

    name: Text = Field(description="Name, for figures and tables.", examples=["pin of the crank"])


class PlanSettings(Settings):
    """plan.toml."""

    plan: NameOfPlan
    dye1: DyeSettings = Field(description="The dye whose light is reabsorbed.")
    dye2: DyeSettings = Field(description="The dye that reabsorbs it.")
    laser: LaserSettings
    camera1: CameraOfPlan
    camera2: CameraOfPlan
    film: FilmOfPlan
    fixture: FixtureOfPlan = FixtureOfPlan()
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

    @model_validator(mode="after")
    def _light_follows(self) -> Self:
        if self.camera1.thick_film is not None and self.camera2.thick_film is not None:
            return self
        missing = [
            name
            for name, value in (
                ("[optics]", self.optics),
                ("[laser] beam_diameter", self.laser.beam_diameter),
            )
            if value is None
        ]
        if missing:
            raise ValueError(
                f"light follows from efficiency only together with {' and '.join(missing)}: add "
                "them, or give thick_film of both cameras"
            )
        return self

    @model_validator(mode="after")
    def _fixture_covers_the_film(self) -> Self:
        low, high = self.covered
        if not low <= self.film.thinnest < self.film.thickest <= high:
            raise ValueError(
                f"expected a fixture that covers the films from {self.film.thinnest * 1e6:g} to "
                f"{self.film.thickest * 1e6:g} um; [fixture] covers {low * 1e6:g} to "
                f"{high * 1e6:g} um"
            )
        return self

    @model_validator(mode="after")
    def _light_is_beyond_the_laser(self) -> Self:
        for number, camera in ((1, self.camera1), (2, self.camera2)):
            if camera.band - camera.bandwidth / 2 <= self.laser.wavelength:
                raise ValueError(
                    f"expected filters above the laser, {self.laser.wavelength:g} nm; that of "
                    f"camera {number} transmits from {camera.band - camera.bandwidth / 2:g} nm"
                )
        return self
