"""The relative energy of a laser pulse, from the light of a frame and its film."""

from __future__ import annotations

import numpy as np

from erlif.calibration import Reabsorption
from erlif.core.arrays import FlagImage, Image

# Valid pixels of the median, at least.
_LEAST_PIXELS = 64

# Pixels of an image from which one in sixteen is enough: of 15 % contrast, the median over them
# has a standard deviation of 0.2 %, a fraction of that of an energy meter. [px]
_LARGE = 500_000


def measure_pulse_energy(
    signal: Image, thickness: Image, flags: FlagImage, *, model: Reabsorption
) -> float:
    """Light of camera 1 over the light that this film gives at unit energy.

    Pixels on a grid in the middle half of the image are compared; the median over them leaves
    vignetting and bubbles out.

    Parameters
    ----------
    signal : array, (y, x)
        Light of camera 1. [DN]
    thickness : array, (y, x)
        Film. [um]
    flags : array, (y, x)
        Pixels with a flag are left out.
    model : Reabsorption
        That of the calibration.

    Returns
    -------
    float
        Signal of a film without attenuation, per um; NaN with fewer than 64 valid pixels. [DN/um]

    Examples
    --------
    >>> from erlif.models.fluorescence import band_signal
    >>> film, model = np.full((64, 64), 5.0, np.float32), Reabsorption(np.array([1, 0.02, 0.01]))
    >>> light = 300.0 * np.asarray(band_signal(film, attenuation=0.02), np.float32)
    >>> flags = np.zeros((64, 64), np.uint16)
    >>> round(measure_pulse_energy(light, film, flags, model=model), 3)
    300.0
    """
    middle = middle_of(signal.shape)
    return compare_light(signal[middle], thickness[middle], flags[middle], model=model)


def middle_of(shape: tuple[int, ...]) -> tuple[slice, slice]:
    """Rows and columns of some pixels in the middle half of an image.

    Every second row and column, in images of half a megapixel or more every fourth.

    Parameters
    ----------
    shape : tuple of int
        Rows and columns of the image. [px]

    Returns
    -------
    tuple of two slices

    Examples
    --------
    >>> middle_of((480, 640))
    (slice(120, 360, 2), slice(160, 480, 2))
    >>> middle_of((1024, 1280))
    (slice(256, 768, 4), slice(320, 960, 4))
    """
    height, width = shape
    every = 2 if height * width < _LARGE else 4
    return slice(height // 4, 3 * height // 4, every), slice(width // 4, 3 * width // 4, every)


def compare_light(
    signal: Image, thickness: Image, flags: FlagImage, *, model: Reabsorption
) -> float:
    """Light over that of the film at unit energy, the median of the given pixels.

    Parameters
    ----------
    signal, thickness, flags : array
        As for `measure_pulse_energy`.
    model : Reabsorption
        That of the calibration.

    Returns
    -------
    float
        NaN with fewer than 64 valid pixels. [DN/um]

    Examples
    --------
    >>> from erlif.models.fluorescence import band_signal
    >>> film, model = np.full((8, 8), 5.0, np.float32), Reabsorption(np.array([1, 0.02, 0.01]))
    >>> light = 300.0 * np.asarray(band_signal(film, attenuation=0.02), np.float32)
    >>> round(compare_light(light, film, np.zeros((8, 8), np.uint16), model=model), 3)
    300.0
    """
    # dark and bubbly pixels are flagged; a few pixels would have the noise of their own speckle
    good = flags == 0
    count = int(good.sum())
    if count < _LEAST_PIXELS:
        return float("nan")
    expected = model.light(thickness[good]).signal

    # one value in the middle, in single precision: half the time of numpy.median
    energy = (signal[good] / expected).astype(np.float32)
    return float(np.partition(energy, count // 2)[count // 2])
