"""The fixed map of the cameras of a recording, from several frames or from a calibration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import FlagImage, Image, Mask
from erlif.core.errors import CalibrationError, RegistrationError
from erlif.core.progress import Progress
from erlif.correction import PairLight
from erlif.correction.light import UNUSABLE
from erlif.io.settings import RegistrationOptions, RunSettings
from erlif.pipeline.chain import FrameCorrection
from erlif.registration import (
    CameraMap,
    MapNodes,
    RegistrationSettings,
    check_map,
    divide_by_light,
    is_steep,
    register_frames,
)

# Pixels from which four frames give the map as well as twelve small ones do. [px]
_LARGE = 500_000

_FRAMES_LARGE, _FRAMES_SMALL = 4, 12


def register_cameras(
    correct: FrameCorrection,
    options: RegistrationOptions,
    *,
    stored: CameraMap | None,
    progress: Progress,
) -> CameraMap:
    """Find the fixed map from camera 1 to camera 2.

    Parameters
    ----------
    correct : FrameCorrection
    options : RegistrationOptions
        The table [registration] of the settings.
    stored : CameraMap, optional
        A map found before, to be used instead of a new one once it is checked.
    progress : callable

    Returns
    -------
    CameraMap

    Raises
    ------
    RegistrationError
        If the cameras cannot be registered, or the stored map no longer fits.
    """
    rows, columns = correct.pairs.shape
    large = rows * columns > _LARGE
    wanted = options.frames or (_FRAMES_LARGE if large else _FRAMES_SMALL)
    lit = LitPairs(correct, correct.pairs.spread(wanted), progress)
    if stored is not None:
        return _check_stored(stored, lit)

    settings = RegistrationSettings(
        window=options.window,
        step=options.step,
        model=options.model,
        orientation=options.orientation,
        frames_for_map=len(lit),
        threads=2 if large else 1,
    )
    camera_map, _ = register_frames(lit, settings=settings)
    return camera_map


@dataclass(frozen=True)
class FixtureMap:
    """Parts of the camera map of the fixture that are kept; the whole map is large.

    Attributes
    ----------
    stored : CameraMap | None
        The whole map, where the settings ask for its use.
    nodes : MapNodes | None
        A few points of it, by which exchanged cameras are recognised.
    """

    stored: CameraMap | None
    nodes: MapNodes | None

    @classmethod
    def of(cls, calibration: Calibration, settings: RunSettings) -> FixtureMap:
        """Keep what a run needs of the map of its calibration.

        Raises CalibrationError where the settings ask for its use and there is none.
        """
        whole, reuse = calibration.camera_map, settings.registration.reuse
        if whole is None and reuse:
            raise CalibrationError(
                "Expected a camera map in the calibration, because [registration] has reuse = "
                "true; there is none. Calibrate again, or set reuse = false."
            )
        return cls(whole if reuse else None, None if whole is None else MapNodes.of(whole))


class LitPairs(Sequence[tuple[Image, Image, Image, Image]]):
    """Light of frame pairs, divided by its slow variation, with the weights of the pixels.

    The film shapes the slow variation, the common texture of both cameras remains. Pairs are read
    when they are used.
    """

    def __init__(self, correct: FrameCorrection, frames: list[int], progress: Progress) -> None:
        self.correct, self.frames, self.progress = correct, frames, progress

    def __len__(self) -> int:
        return len(self.frames)

    def __getitem__(self, index: Any) -> Any:
        out = PairLight.empty(self.correct.pairs.shape, with_noise=False)
        pair = self.correct.light(self.frames[index], out=out)
        self.progress("registration", index + 1, len(self))
        # the textures take the places of the light
        one, two = (
            divide_by_light(light, usable_pixels(flags, blocks), out=light)
            for light, flags, blocks in zip(pair.light, pair.flags, pair.blocks, strict=True)
        )
        return one[0], two[0], one[1], two[1]


def usable_pixels(flags: FlagImage, blocks: Image) -> Mask:
    """Pixels of one camera on which a registration can rely.

    Parameters
    ----------
    flags : array, (y, x)
        Bits of `erlif.core.flags.Flag`.
    blocks : array, (row, column)
        Mean light of blocks of 8 px. [DN]

    Returns
    -------
    array, (y, x), bool
        False for saturated, bad and excluded pixels and where the light is too steep.
    """
    rows, columns = flags.shape
    usable = np.asarray(flags & UNUSABLE == 0)
    usable &= ~is_steep(blocks, (rows, columns))
    return usable


def _check_stored(stored: CameraMap, lit: LitPairs) -> CameraMap:
    """A stored map, if it fits the recording."""
    shape = lit.correct.pairs.shape
    if stored.shape != shape:
        raise RegistrationError(
            f"Expected a stored camera map for frames of {shape}; the calibration's is for "
            f"{stored.shape}. Calibrate with the region of interest of the run, or set reuse = "
            "false in [registration]."
        )
    check_map(stored, lit)
    return replace(stored, stored=True)
