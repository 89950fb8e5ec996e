"""Cameras exchanged in run.toml, recognised by their ratio and by their map."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Image
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.recording.sample import Bands, ratios_of
from erlif.pipeline.refusals import refusal
from erlif.registration import MapNodes, compare_with_inverse

_logger = logging.getLogger(__name__)

# Widening of the calibrated range on both sides, for noise. [share of the log ratio's range]
_MARGIN = 0.1

# Share of inverse ratios above which most of the image speaks for exchanged cameras.
_MOST = 0.6

# Share of regular ratios below which hardly any of the image speaks against it.
_FEW = 0.2

# Share of ratios that no film has from which the cameras cannot be in order.
_IMPOSSIBLE = 0.15

# Standard deviations by which a ratio must exceed the highest possible one.
_SIGMAS = 2

# Films among which the highest ratio is sought, and their number. [um]
_FILMS, _GRID = (0.1, 1e4), 2001


def refuse_swapped_cameras(
    chain: FrameChain,
    calibration: Calibration,
    sample: Sequence[Bands],
    *,
    stored: MapNodes | None = None,
) -> None:
    """Refuse a run whose cameras are exchanged against its calibration.

    Exchanged cameras show the inverse of the ratio. Where that could be a ratio as well (films of
    about 10 um have a ratio near 1), the map decides: exchanged cameras have the inverse of the map
    that is stored with the calibration.

    Parameters
    ----------
    chain : FrameChain
    calibration : Calibration
    sample : sequence of tuple of AlignedFrames
        Parts of the frames whose ratios are compared.
    stored : MapNodes, optional
        The map that is stored with the calibration.

    Raises
    ------
    CalibrationError
        If the cameras are exchanged.
    """
    if stored is not None and not chain.camera_map.stored:
        _check_map(chain, stored)
    _check_ratio(chain, calibration, sample)


def _check_map(chain: FrameChain, stored: MapNodes) -> None:
    comparison = compare_with_inverse(stored, chain.camera_map)
    _logger.info(
        "map of the run: %.2f px from the calibration's, %.2f px from its inverse",
        comparison.misfit,
        comparison.misfit_inverse,
    )
    if comparison.inverted:
        raise refusal("map_inverse", comparison=comparison)


def _check_ratio(chain: FrameChain, calibration: Calibration, sample: Sequence[Bands]) -> None:
    low, high = calibration.predict_log(calibration.thickness_range)
    shares = [
        _share_ratios(log_ratio, noise, calibration)
        for log_ratio, noise in ratios_of(chain, sample)
    ]
    if not shares:
        return

    regular, inverted, impossible = np.median(shares, axis=0).tolist()
    if inverted > _MOST and (regular < _FEW or impossible > _IMPOSSIBLE):
        raise refusal(
            "ratios_inverse", low=np.exp(low), high=np.exp(high), inverse=inverted, none=impossible
        )


def _share_ratios(log_ratio: Image, std: Image, calibration: Calibration) -> list[float]:
    """Shares of ratios in the calibrated range, of inverse ones in it, and above any film's."""
    low, high = calibration.predict_log(calibration.thickness_range)
    margin = _MARGIN * (high - low)

    # no film, however thick, has a ratio above the highest of the model
    films = np.geomspace(*_FILMS, _GRID)
    highest = films[np.argmax(calibration.model.predict(films))]
    gradient = calibration.model.gradient(highest)
    ceiling_std = np.sqrt(gradient @ calibration.covariance @ gradient)
    ceiling = float(calibration.model.predict(highest)) + _SIGMAS * ceiling_std
    return [
        float(((log_ratio > low - margin) & (log_ratio < high + margin)).mean()),
        float(((-log_ratio > low - margin) & (-log_ratio < high + margin)).mean()),
        float((log_ratio - _SIGMAS * std > ceiling).mean()),
    ]
