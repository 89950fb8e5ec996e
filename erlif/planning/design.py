"""A design: dyes, filters, light and cameras, and the light and the ratio that follow."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy import constants

from erlif.core.arrays import Array
from erlif.io.settings.planning import ReferencesOfPlan
from erlif.models.fluorescence import band_signal
from erlif.planning.spectra import SYNTHETIC, Dye, synthetic_spectra

# Of the integration over a filter; spectra are smooth over 10 nm.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True)
class FilteredCamera:
    """A camera behind its filter.

    Attributes
    ----------
    band : float
        Centre of the filter. [nm]
    bandwidth : float
        Full width of the filter, which transmits evenly within it. [nm]
    gain : float
        Photo-electrons of one count. [electron/DN]
    read_noise : float
        Standard deviation of the read noise. [electron]
    full_well : float
        Largest signal of a pixel. [electron]
    counts : float
        Largest count of the converter above the dark level. [DN]
    scale : float
        Photo-electrons of one unit of emitted light, see `emitted_light`, at the stated pulse
        energy. [electron]
    """

    band: float
    bandwidth: float
    gain: float
    read_noise: float
    full_well: float
    counts: float
    scale: float = 1.0

    @property
    def full_scale(self) -> float:
        """Largest signal above the dark level, by converter or full well. [electron]"""
        return min(self.full_well, self.counts * self.gain)


@dataclass(frozen=True, eq=False)
class Design:
    """Design of a rig: everything on which light, ratio and their noise depend.

    Attributes
    ----------
    dyes : tuple[Dye, ...]
        Dye 1, whose light is reabsorbed, and dye 2, which reabsorbs it.
    cameras : tuple[FilteredCamera, ...]
        Camera 1 in the band that is reabsorbed, and camera 2.
    laser : float
        Wavelength. [nm]
    energy : float
        Pulse energy over the stated one. [1]
    references : ReferencesOfPlan
        Dark and flat pages.
    corner : float
        Light at the corners of the field over that in its middle, of beam and lens. [1]
    """

    dyes: tuple[Dye, ...]
    cameras: tuple[FilteredCamera, ...]
    laser: float
    energy: float = 1.0
    references: ReferencesOfPlan = field(default_factory=ReferencesOfPlan)
    corner: float = 1.0

    def with_concentrations(self, concentrations: npt.ArrayLike) -> Design:
        """Return a copy with other concentrations of dye 1 and 2. [mol/L]"""
        pairs = zip(self.dyes, np.asarray(concentrations), strict=True)
        return replace(
            self, dyes=tuple(replace(dye, concentration=float(value)) for dye, value in pairs)
        )

    @property
    def concentrations(self) -> Array:
        """Concentrations of dye 1 and 2. [mol/L]"""
        return np.array([dye.concentration for dye in self.dyes])


@dataclass(frozen=True)
class Band:
    """Emission and attenuation over one filter, at the nodes of its integral.

    Attributes
    ----------
    attenuation : Array
        Of laser light on its way in and emitted light on its way out, A + B, (node,). [1/um]
    weight : Array
        Emitted photons per depth and laser photon, times the width of the node, (node,). [1/um]
    """

    attenuation: Array
    weight: Array


@lru_cache(maxsize=32)  # light, ratio and slope need the same bands
def band_of(design: Design, number: int) -> Band:
    """Emission and attenuation in the band of camera 1 or 2.

    Parameters
    ----------
    design : Design
    number : int
        Camera, 1 or 2.

    Returns
    -------
    Band

    Raises
    ------
    ConfigError
        If a spectrum does not cover the laser or the filter.

    Examples
    --------
    >>> band = band_of(example_dye_design(), 1)
    >>> bool(band.attenuation.min() > 0)
    True
    """
    camera = design.cameras[number - 1]
    wavelength = camera.band + camera.bandwidth / 2 * _NODES
    step = camera.bandwidth / 2 * _WEIGHTS

    in_and_out, emitted = np.zeros_like(step), np.zeros_like(step)
    for dye in design.dyes:
        absorbed = dye.attenuation(design.laser)
        in_and_out += absorbed + dye.attenuation(wavelength)
        emitted += absorbed * dye.quantum_yield * dye.emission.at(wavelength) * step
    return Band(in_and_out, emitted)


def emitted_light(design: Design, number: int, thickness: npt.ArrayLike) -> Array:
    """Photons that leave the film in the band of a camera, per laser photon.

    Farzaneh (2002), eq. 5.5, integrated over the filter, with the emission of both dyes in both
    bands.

    Parameters
    ----------
    design : Design
    number : int
        Camera, 1 or 2.
    thickness : array_like
        Film thickness. [um]

    Returns
    -------
    array
        In all directions. [1]

    Examples
    --------
    >>> float(emitted_light(example_dye_design(), 1, 0.0))
    0.0
    """
    band, film = band_of(design, number), np.asarray(thickness, float)
    light = band_signal(film[..., None], attenuation=band.attenuation, brightness=band.weight)
    return np.asarray(np.sum(light, axis=-1))


def signal(design: Design, number: int, thickness: npt.ArrayLike) -> Array:
    """Photo-electrons of a pixel in mid-beam. Arguments as in `emitted_light`.

    Returns
    -------
    array
        Mean signal above the dark level, not limited by full scale. [electron]

    Examples
    --------
    >>> bool(signal(example_dye_design(), 1, 5.0) > signal(example_dye_design(), 1, 2.0))
    True
    """
    scale = design.energy * design.cameras[number - 1].scale
    return np.asarray(scale * emitted_light(design, number, thickness))


def log_ratio(design: Design, thickness: npt.ArrayLike) -> Array:
    """Natural logarithm of the ratio camera 2 / camera 1, of films above 0.

    Returns
    -------
    array
        [1]

    Examples
    --------
    >>> bool(log_ratio(example_dye_design(), 5.0) > log_ratio(example_dye_design(), 2.0))
    True
    """
    return np.log(signal(design, 2, thickness)) - np.log(signal(design, 1, thickness))


def log_ratio_slope(design: Design, thickness: npt.ArrayLike) -> Array:
    """Derivative of `log_ratio` with respect to thickness.

    Returns
    -------
    array
        [1/um]

    Examples
    --------
    The slope of a very thin film is half the difference of the attenuations:

    >>> design = example_dye_design()
    >>> p, q = (mean_attenuation(design, number) for number in (1, 2))
    >>> round(float(log_ratio_slope(design, 1e-3)) / (p - q), 3)
    0.5
    """
    film = np.asarray(thickness, float)
    slopes = []
    for number in (1, 2):
        band = band_of(design, number)
        depth = np.multiply.outer(film, band.attenuation)
        slopes.append((np.exp(-depth) @ band.weight) / emitted_light(design, number, film))
    return np.asarray(slopes[1] - slopes[0])


def mean_attenuation(design: Design, number: int) -> float:
    """Attenuation A + B in the band of a camera, weighted with the light of a very thin film.

    Parameters
    ----------
    design : Design
    number : int
        Camera, 1 (p) or 2 (q).

    Returns
    -------
    float
        [1/um]

    Examples
    --------
    >>> design = example_dye_design()
    >>> [round(mean_attenuation(design, number), 2) for number in (1, 2)]
    [0.4, 0.25]
    """
    band = band_of(design, number)
    return float(np.average(band.attenuation, weights=band.weight))


def optical_thickness(design: Design) -> tuple[float, float]:
    """The two terms of the condition of Farzaneh (2002) for an optically thick system.

    The printed condition, eps2(filter) C2 > ~ 0[eps(laser) C], is read with an order symbol: the
    reabsorption of the light of dye 1 by dye 2 is at least of the order of the absorption of the
    laser light.

    Parameters
    ----------
    design : Design

    Returns
    -------
    (float, float)
        Reabsorption by dye 2 in the band of camera 1, and absorption of the laser by both dyes.
        [1/um]

    Examples
    --------
    >>> reabsorption, absorption = optical_thickness(example_dye_design())
    >>> round(reabsorption / absorption, 2)
    0.97
    """
    camera = design.cameras[0]
    wavelength = camera.band + camera.bandwidth / 2 * _NODES
    reabsorption = np.average(design.dyes[1].attenuation(wavelength), weights=_WEIGHTS)
    absorption = sum(float(dye.attenuation(design.laser)) for dye in design.dyes)
    return float(reabsorption), absorption


def scaled_to(design: Design, thick_film: tuple[float, float]) -> Design:
    """Scale the cameras so that a very thick film has a known signal.

    Parameters
    ----------
    design : Design
    thick_film : (float, float)
        Photo-electrons of cameras 1 and 2 from a very thick film. [electron]

    Returns
    -------
    Design

    Examples
    --------
    >>> design = scaled_to(example_dye_design(), (5000.0, 6000.0))
    >>> round(float(signal(design, 1, 1e4)))
    5000
    """
    cameras = []
    for n, (camera, electrons) in enumerate(zip(design.cameras, thick_film, strict=True), start=1):
        band = band_of(design, n)
        thick = float((band.weight / band.attenuation).sum())
        cameras.append(replace(camera, scale=electrons / thick))
    return replace(design, cameras=tuple(cameras))


def example_dye_design() -> Design:
    """The design of Farzaneh (2002) with invented spectra, light and cameras.

    Returns
    -------
    Design

    Examples
    --------
    >>> example_dye_design().concentrations
    array([0.008, 0.024])
    """
    dyes = tuple(
        Dye(concentration, 0.7, *synthetic_spectra(name))
        for concentration, name in zip((0.008, 0.024), SYNTHETIC, strict=True)
    )
    cameras = tuple(
        FilteredCamera(band, 10.0, 4.4, 9.0, 20000.0, 4095 - 64) for band in (580.0, 610.0)
    )
    design = Design(dyes, cameras, laser=532.0)
    return scaled_to(design, (11000.0, 11500.0))


def scale_of_optics(
    *,
    pulse_energy: float,
    wavelength: float,
    beam_diameter: float,
    pixel_pitch: float,
    numerical_aperture: float,
    refractive_index: float,
    efficiency: float,
) -> float:
    """Photo-electrons of one unit of `emitted_light`, from first principles.

    The pulse is spread evenly over the beam; light leaves the film in all directions, and the lens
    collects a cone of it, narrowed by refraction.

    Parameters
    ----------
    pulse_energy : float
        [J]
    wavelength : float
        Of the laser. [nm]
    beam_diameter, pixel_pitch : float
        On the film. [m]
    numerical_aperture : float
        Of the lens, in air. [1]
    refractive_index : float
        Of the oil. [1]
    efficiency : float
        Photo-electrons for one photon that enters the lens. [1]

    Returns
    -------
    float
        [electron]

    Examples
    --------
    A pulse of 1 mJ has 2.68e15 photons at 532 nm; a pixel gets 1e-4 of them, the lens 0.5 %:

    >>> scale = scale_of_optics(
    ...     pulse_energy=1e-3, wavelength=532.0, beam_diameter=0.01, pixel_pitch=8.862e-5,
    ...     numerical_aperture=0.1411, refractive_index=1.0, efficiency=1.0,
    ... )
    >>> round(scale / 1e9, 2)
    1.34
    """
    photon = constants.h * constants.c / (wavelength * 1e-9)
    on_pixel = pulse_energy / photon * pixel_pitch**2 / (np.pi / 4 * beam_diameter**2)
    inside = numerical_aperture / refractive_index  # sine of the half angle in the oil
    collected = (1 - np.sqrt(1 - inside**2)) / 2
    return float(on_pixel * collected * efficiency)


def saturation_fluence(design: Design) -> float:
    """Pulse energy per area at which the more absorbing dye saturates, h nu over its cross section.

    The prediction holds far below it: at higher fluence a dye absorbs less than its spectrum
    states. A dye is excited several times within a pulse of 9 ns, so this limit is cautious.

    Parameters
    ----------
    design : Design

    Returns
    -------
    float
        [J/cm2]

    Examples
    --------
    >>> round(saturation_fluence(example_dye_design()), 4)
    0.0011
    """
    largest = max(float(dye.absorption.at(design.laser)) for dye in design.dyes)
    cross_section = np.log(10) * 1e3 * largest / constants.Avogadro  # cm2
    photon = constants.h * constants.c / (design.laser * 1e-9)
    return float(photon / cross_section)
