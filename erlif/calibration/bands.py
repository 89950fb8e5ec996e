"""Filter bands and pixel pitch of a calibration and of the run that it is used for."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from erlif.calibration.curve import Calibration
from erlif.core.errors import CalibrationError
from erlif.core.notes import Note, warn

_SAME_BAND = 1.0  # nm: filters of the same name differ by less

_SAME_PITCH = 0.03  # relative difference: two photographs of one scale agree better


def share_bands(bands: tuple[float, float], others: tuple[float, float]) -> bool:
    """Compare the filter bands of two pairs of cameras.

    Parameters
    ----------
    bands, others : (float, float)
        Bands of camera 1 and 2. [nm]

    Returns
    -------
    bool
        Whether both bands agree to 1 nm.

    Examples
    --------
    >>> share_bands((580.0, 610.0), (580.5, 610.0))
    True
    >>> share_bands((580.0, 610.0), (610.0, 580.0))
    False
    """
    return bool(np.allclose(bands, others, rtol=0.0, atol=_SAME_BAND))


def check_bands(calibration: Calibration, bands: tuple[float, float]) -> None:
    """Refuse a calibration of other filter bands.

    Parameters
    ----------
    calibration : Calibration
        Calibration to be used for a run.
    bands : (float, float)
        Bands of camera 1 and 2 of the run. [nm]

    Raises
    ------
    CalibrationError
        If a band differs by more than 1 nm; exchanged cameras are recognised.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> calibration = example_calibration()
    >>> check_bands(calibration, (580.0, 610.0))
    >>> check_bands(calibration, (610.0, 580.0))
    Traceback (most recent call last):
        ...
    erlif.core.errors.CalibrationError: Expected a calibration of the bands of the run, 610 and \
580 nm; got one of 580 and 610 nm. The bands are exchanged: the cameras look swapped. Calibrate \
with the filters of the run.
    """
    if share_bands(calibration.bands, bands):
        return
    one, two = calibration.bands
    exchanged = share_bands(calibration.bands, bands[::-1])
    swapped = " The bands are exchanged: the cameras look swapped." if exchanged else ""
    raise CalibrationError(
        f"Expected a calibration of the bands of the run, {bands[0]:g} and {bands[1]:g} nm; got "
        f"one of {one:g} and {two:g} nm.{swapped} Calibrate with the filters of the run."
    )


def note_pitch(stated: float | None, pitch: float) -> Iterator[Note]:
    """Warn of a calibration whose fixture was laid out with another pixel pitch than the run.

    Parameters
    ----------
    stated : float or None
        Of the calibration; None where it is not known. [mm]
    pitch : float
        Of the run. [mm]

    Yields
    ------
    Note

    Examples
    --------
    >>> [note.level.value for note in note_pitch(0.06, 0.0094)], list(note_pitch(0.06, 0.0605))
    (['warning'], [])
    """
    if stated is not None and abs(stated / pitch - 1) > _SAME_PITCH:
        yield warn(
            "pixel_pitch",
            f"{1e3 * stated:.4g} um in fixture.toml of the calibration, {1e3 * pitch:.4g} um in "
            "run.toml: if the first is wrong, all films are. Correct the wrong one and calibrate "
            "again, unless the fixture was photographed at another magnification",
        )
