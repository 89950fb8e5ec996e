"""Cameras exchanged in run.toml, proved by their map, and ratios that no film explains."""

from __future__ import annotations

import logging
from typing import NamedTuple

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError
from erlif.core.notes import Note, warn
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.recording.sample import SampleRatios, ratios_of
from erlif.registration import MapNodes, compare_with_inverse

_logger = logging.getLogger(__name__)


# Share of ratios that no film has from which something is wrong.
_IMPOSSIBLE = 0.15

# Standard deviations by which a ratio must lie beyond those of films.
_SIGMAS = 2

# Films among which the lowest and the highest ratio are sought, and their number. [um]
_FILMS, _GRID = (0.01, 1e4), 2001


class Misfit(NamedTuple):
    """Ratios that no film has.

    Attributes
    ----------
    notes : tuple[Note, ...]
        Empty where there are few.
    size : float
        By how much the logarithm of the ratio is off at least; 0 where there are few. [1]
    """

    notes: tuple[Note, ...] = ()
    size: float = 0.0


def judge_ratios(
    chain: FrameChain,
    calibration: Calibration,
    sample: SampleRatios,
    *,
    stored: MapNodes | None = None,
) -> Misfit:
    """Refuse a run whose map proves exchanged cameras, and note ratios that do not fit.

    Exchanged cameras have the inverse of the map that is stored with the calibration. They show the
    inverse of the ratio as well, but so do light, gain, filters and walls that have changed: the
    ratio proves nothing, and a note lists its causes.

    Parameters
    ----------
    chain : FrameChain
    calibration : Calibration
    sample : list of list of RatioImages
        From `divide_sample`.
    stored : MapNodes, optional
        The map that is stored with the calibration.

    Returns
    -------
    Misfit
        Without notes where the ratios are those of films.

    Raises
    ------
    CalibrationError
        If the map is the inverse of the stored one.
    """
    in_order = chain.camera_map.stored
    if stored is not None and not in_order:
        in_order = _check_map(chain, stored)
    return _note_misfit(chain, calibration, sample, in_order=in_order)


def _check_map(chain: FrameChain, stored: MapNodes) -> bool:
    """Refuse the inverse of the stored map; whether the map proves the stored order."""
    comparison = compare_with_inverse(stored, chain.camera_map)
    _logger.info(
        "map of the run: %.2f px from the calibration's, %.2f px from its inverse",
        comparison.misfit,
        comparison.misfit_inverse,
    )
    if comparison.inverted:
        raise CalibrationError(
            "Expected the cameras in the order of the calibration; magnification, rotation and "
            "distortion between them are the inverse of the calibration's: rms deviation "
            f"{comparison.misfit_inverse:.2f} px, against {comparison.misfit:.2f} px from the "
            "calibration's own. The cameras look swapped: exchange the files of [camera1] and "
            "[camera2] in run.toml."
        )
    return comparison.inverted is False


def _note_misfit(
    chain: FrameChain, calibration: Calibration, sample: SampleRatios, *, in_order: bool
) -> Misfit:
    ends, shares, sizes = _ratios_of_films(calibration), [], []
    for ratio, std in ratios_of(sample):
        off = np.maximum(ends[0] - ratio, ratio - ends[1])
        beyond = off > _SIGMAS * std
        shares.append(float(beyond.mean()))
        sizes.append(float(off[beyond].mean()) if beyond.any() else 0.0)
    if not shares or np.median(shares) <= _IMPOSSIBLE:
        return Misfit()

    causes = [
        "light, exposure, filter or gain of a camera is not that of the calibration, or its dark "
        "is wrong: compare them, and photograph the fixture again",
        "the wall of the joint reflects more or less than that of the fixture: use one material",
        "the profile of the fixture is not that of its images: look at direction, origin and "
        "cameras in fixture.toml",
    ]
    if not in_order:
        causes.append(
            "the cameras are exchanged: look at the files of [camera1], to which the reabsorbed "
            "(580 nm) band belongs, and of [camera2]"
        )
    listed = "; ".join(f"({n}) {cause}" for n, cause in enumerate(causes, 1))
    low, high = np.exp(ends)
    known = ". The cameras are not exchanged: their map is that of the calibration"
    order = known if in_order else ""
    share = float(np.median(shares))
    note = warn(
        "ratio",
        f"films are wrong or missing{order}: {share:.0%} of the pixels have a ratio that no film "
        f"has, below {low:.3f} or above {high:.3f}. The scale of the ratio is in doubt by as "
        f"much. Likely, in this order: {listed}",
    )
    return Misfit((note,), float(np.median(sizes)))


def _ratios_of_films(calibration: Calibration) -> Array:
    """Logarithms of the lowest and the highest ratio of any film, less and plus their error."""
    model, films = calibration.model, np.geomspace(*_FILMS, _GRID)
    extreme = np.array([films[0], films[np.argmax(model.predict(films))]])
    gradient = model.gradient(extreme)
    std = np.sqrt(np.einsum("it,ij,jt->t", gradient, calibration.covariance, gradient))
    return np.asarray(model.predict(extreme) + np.array([-_SIGMAS, _SIGMAS]) * std)
