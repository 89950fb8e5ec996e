"""Spectra of the dyes: from files, from coefficients at three wavelengths, or invented ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array
from erlif.core.bounded import read_rows
from erlif.core.errors import ConfigError

# Names of the invented spectra. They are placed so that the concentrations of Farzaneh (2002)
# attenuate by about 0.40 and 0.25 per um in the bands of 580 and 610 nm.
SYNTHETIC = ("synthetic 605", "synthetic 650")

_LARGEST_FILE = 2**22  # byte: a spectrum has a few thousand lines
_LIGHT = (100.0, 20000.0)  # nm: wavelengths that a spectrum may hold


@dataclass(frozen=True)
class Spectrum:
    """A property of a dye over the wavelength.

    Attributes
    ----------
    wavelength : Array
        Rising. [nm]
    value : Array
        At these wavelengths, not negative.
    name : str
        What it is and where it comes from, for messages.
    narrow : bool
        The values hold for a few bands and not between them: the nearest one is taken.
    """

    wavelength: Array
    value: Array
    name: str
    narrow: bool = False

    def at(self, wavelength: npt.ArrayLike) -> Array:
        """Values at other wavelengths, linear between the tabulated ones. [nm]"""
        asked = np.asarray(wavelength, float)
        if self.narrow:
            nearest = np.abs(np.subtract.outer(asked, self.wavelength)).argmin(axis=-1)
            return np.asarray(self.value[nearest])

        low, high = self.wavelength[0], self.wavelength[-1]
        if asked.min() < low or asked.max() > high:
            raise ConfigError(
                f"Expected the {self.name} to cover {asked.min():g} to {asked.max():g} nm, which "
                f"laser and filters need; it covers {low:g} to {high:g} nm. Correct band and "
                "bandwidth of the filter, or give a spectrum that reaches farther."
            )
        return np.asarray(np.interp(asked, self.wavelength, self.value))


@dataclass(frozen=True)
class Dye:
    """A dye in the oil.

    Attributes
    ----------
    concentration : float
        [mol/L]
    quantum_yield : float
        Photons emitted for one absorbed. [1]
    absorption : Spectrum
        Molar absorption coefficient, decadic. [L/mol/cm]
    emission : Spectrum
        Share of the emitted photons per wavelength; its integral is 1. [1/nm]
    """

    concentration: float
    quantum_yield: float
    absorption: Spectrum
    emission: Spectrum

    def attenuation(self, wavelength: npt.ArrayLike) -> Array:
        """Napierian attenuation of the oil by this dye. [1/um]"""
        # decadic to napierian, and 1/cm to 1/um
        per_molar = math.log(10) * 1e-4 * self.absorption.at(wavelength)
        return np.asarray(self.concentration * per_molar)


def read_spectrum(path: Path, what: str) -> Spectrum:
    """Read a spectrum from a CSV file with the columns wavelength_nm and value.

    Parameters
    ----------
    path : Path
        Lines that begin with # are remarks.
    what : str
        Property, for messages: "absorption of dye 1".

    Returns
    -------
    Spectrum

    Raises
    ------
    ConfigError
        If the file cannot be read, or does not hold rising wavelengths and values of 0 or more.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "dye.csv")
    ...     _ = path.write_text("wavelength_nm,value\\n500,2e4\\n600,4e4\\n")
    ...     float(read_spectrum(path, "absorption of dye 1").at(550.0))
    30000.0
    """
    try:
        rows = [row for _, row in read_rows(path, largest=_LARGEST_FILE) if row[0][:1] != "#"]
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        if isinstance(error, UnicodeError):
            reason = "it is not text"
        raise ConfigError(
            f"Expected the {what} as a CSV file at {path}; it cannot be read: {reason}. Save the "
            "spectrum as CSV in UTF-8, or correct its name in plan.toml."
        ) from error
    name = f"{what} in {path.name}"
    if not rows or rows[0] != ["wavelength_nm", "value"]:
        found = ",".join(rows[0])[:60] if rows else "an empty file"
        raise ConfigError(
            f"Expected the header wavelength_nm,value for the {name}; got {found!r}. Add the "
            "header."
        )
    try:
        table = np.array([[float(cell) for cell in row] for row in rows[1:]]).reshape(-1, 2)
    except ValueError as error:
        raise ConfigError(
            f"Expected two numbers in each line of the {name}; {error}. Correct that line."
        ) from error

    wavelength, value = table.T
    if wavelength.size < 2 or not np.isfinite(table).all() or np.diff(wavelength).min() <= 0:
        raise ConfigError(
            f"Expected at least two finite, rising wavelengths in the {name}. Correct its lines: "
            "sort them and remove repeated ones."
        )
    if value.min() < 0 or value.max() == 0:
        raise ConfigError(
            f"Expected values of 0 or more in the {name}, and one above 0; got {value.min():g} to "
            f"{value.max():g}. Correct the baseline."
        )
    if wavelength[0] < _LIGHT[0] or wavelength[-1] > _LIGHT[1]:
        raise ConfigError(
            f"Expected wavelengths in nm in the {name}; got {wavelength[0]:g} to "
            f"{wavelength[-1]:g}. Convert them to nm."
        )
    return Spectrum(wavelength, value, name)


def normalise_emission(spectrum: Spectrum) -> Spectrum:
    """Scale an emission spectrum to the integral 1.

    Parameters
    ----------
    spectrum : Spectrum
        In any unit, over the whole emission of the dye.

    Returns
    -------
    Spectrum
        [1/nm]

    Examples
    --------
    >>> flat = Spectrum(np.array([500.0, 600.0]), np.array([3.0, 3.0]), "emission of dye 1")
    >>> normalise_emission(flat).value
    array([0.01, 0.01])
    """
    area = float(np.trapezoid(spectrum.value, spectrum.wavelength))
    return Spectrum(spectrum.wavelength, spectrum.value / area, spectrum.name)


def synthetic_spectra(name: str) -> tuple[Spectrum, Spectrum]:
    """Return the invented absorption and emission of one of the dyes in `SYNTHETIC`.

    Parameters
    ----------
    name : str

    Returns
    -------
    (Spectrum, Spectrum)
        Absorption [L/mol/cm] and emission [1/nm].

    Raises
    ------
    ConfigError
        If there is none of this name.

    Examples
    --------
    >>> absorption, _ = synthetic_spectra("synthetic 650")
    >>> absorption.at([532.0, 580.0]).round(-2)
    array([ 7500., 35000.])
    """
    if name not in SYNTHETIC:
        raise ConfigError(f"Expected one of {', '.join(SYNTHETIC)}; got {name!r}. Choose one.")
    file = name.replace(" ", "_")
    absorption, emission = (
        read_spectrum(Path(__file__).parent / "dyes" / f"{file}_{kind}.csv", kind)
        for kind in ("absorption", "emission")
    )
    return absorption, normalise_emission(emission)
