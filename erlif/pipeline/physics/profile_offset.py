"""Films of the profile of a fixture against the light of its frames."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from erlif.calibration import Calibration, RunCurve
from erlif.core.arrays import Array
from erlif.core.notes import Note, warn
from erlif.core.statistics import quadratic_surface
from erlif.pipeline.engines.results import FrameResult
from erlif.ratio.cells import LightCells, cell_places

# Offsets of a profile that are tried. [um]
_TRIED = np.arange(-5.0, 10.0, 0.1)

# Offset that is reported, and by how much it must lower the deviance of the light: uneven
# illumination of sound fixtures leaves 12 at most. [um], [1]
_LEAST, _EVIDENT = 1.0, 20.0

_THINNEST = 0.1  # um, film that an offset may leave

_FEWEST = 24  # cells; the illumination alone has six coefficients


def note_profile_offset(
    frames: Sequence[FrameResult], calibration: Calibration, profile: str
) -> list[Note]:
    """Warn of a profile that is too thick or too thin as a whole.

    The ratio does not show it, but the light does: it starts from nothing at no film. The
    illumination is a smooth surface over the image.

    Parameters
    ----------
    frames : sequence of FrameResult
        Of the fixture, with their light in cells.
    calibration : Calibration
    profile : str
        Name of its file.

    Returns
    -------
    list of Note
    """
    curve = RunCurve.of(calibration)
    cells = LightCells(*np.array([one.cells for one in frames], float).transpose(1, 0, 2))
    known = np.isfinite(cells.light).all(axis=0) & np.isfinite(cells.log_ratio).all(axis=0)
    film = curve.inverse.look_up(cells.log_ratio.mean(axis=0))
    low, high = calibration.thickness_range
    known &= (film > low) & (film < high)
    if known.sum() < _FEWEST:
        return []

    surface = quadratic_surface(*(place[known] for place in cell_places()))
    light, film = cells.light.mean(axis=0)[known], film[known]

    def deviance(offset: float) -> float:
        value: Array = light - np.log(curve.model.light(film - offset).signal)
        rest = value - surface @ np.linalg.lstsq(surface, value, rcond=None)[0]
        return value.size * float(np.log(np.mean(rest**2)))

    tried = [one for one in _TRIED if film.min() - one > _THINNEST]
    best = min(tried, key=deviance)
    if abs(best) < _LEAST or deviance(0.0) - deviance(best) < _EVIDENT:
        return []
    return [
        warn(
            profile,
            f"all films are off, if the illumination is smooth: the light of the frames is that of "
            f"films {abs(best):.1f} um {'thinner' if best > 0 else 'thicker'} than in the profile. "
            "Correct the zero of the profile, which is where it touches the window",
        )
    ]
