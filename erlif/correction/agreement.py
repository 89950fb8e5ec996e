"""Whether darks and flats belong to the frames of their camera.

Every pixel has its own response, which the flat shows and the mean of some frames shows too. Where
the fine structure of the frames does not contain that of the flat, the flat is not of this camera,
or not of this focus and region of interest; where it contains that of the other camera's flat, the
cameras are exchanged, whatever their ratio.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import cv2
import numpy as np

from erlif.core.arrays import AnyArray, Image, Mask
from erlif.core.notes import Note, note_writer
from erlif.core.products import References
from erlif.core.statistics import robust_std
from erlif.core.units import count_of
from erlif.correction.camera import CameraMeasurement
from erlif.correction.refusals import refusal
from erlif.correction.view import BLOCKS, FrameView, mean_of_blocks

_write = note_writer("erlif.correction")

# Robust standard deviations beyond which fine structure is dust, a bubble or a bad pixel.
_CLEAR = 4.0

# Standard deviation of the share of a flat in the frames above which it is not judged. [1]
_LARGEST_STD = 0.1

# Share of a flat's structure below which it is missing in the frames, and above which it is
# present; 0 and 1 where both are exact. [1]
_MISSING, _PRESENT = 0.4, 0.6

# Light in the dark, over that of the frames, from which it is reported: 0.5 % of the light shifts
# films of 3 um by some 20 nm. [1]
_LEAK = 0.005

# Standard deviations from which light in the dark is no chance.
_SIGNIFICANT = 6.0

# Standard deviation of the dark level from page to page, over the light. [1]
_UNSTEADY = 0.01

# Light of a flat in its darkest part, over the brightest, below which it is no even target. [1]
_DARK_CORNER = 0.5

# Difference of the large-scale light of both flats that lenses do not have. [1]
_UNLIKE = 0.2


class PatternShare(NamedTuple):
    """How much of the fine structure of a flat is in the frames.

    Attributes
    ----------
    value : float
        1 where the frames were recorded with these pixels, 0 where not.
    std : float
        Its standard deviation; infinite where the flat has no structure above its noise.
    """

    value: float
    std: float

    @property
    def is_present(self) -> bool:
        """Whether the frames have this structure."""
        return self.std < _LARGEST_STD and self.value > _PRESENT

    @property
    def is_missing(self) -> bool:
        """Whether the frames do not have this structure."""
        return self.std < _LARGEST_STD and self.value < _MISSING


def find_reference_faults(
    measured: Sequence[CameraMeasurement], references: References
) -> list[Note]:
    """Compare darks and flats of both cameras with their frames and with each other.

    Parameters
    ----------
    measured : sequence of two CameraMeasurement
        With the view of some frames.
    references : References
        Made of the same darks and flats.

    Returns
    -------
    list of Note
        Warnings; empty where everything belongs together.

    Raises
    ------
    FrameError
        If the cameras are exchanged against their flats, or the dark is brighter than the frames.

    Examples
    --------
    >>> from erlif.correction import DeclaredNoise, make_references, measure_camera
    >>> camera = measure_camera(
    ...     darks=64.0, flats=[], histogram=np.zeros(4096, np.int64), shape=(64, 64), camera="one"
    ... )
    >>> cameras = make_references([camera, camera], declared=[DeclaredNoise(4.4, 9.0)] * 2)
    >>> find_reference_faults([camera, camera], cameras.references)
    []
    """
    notes: list[Note] = []
    for number, one in enumerate(measured, 1):
        camera = f"camera{number}"
        if one.view is not None:
            _refuse_bright_dark(one, one.view, camera)
            notes += _find_light_in_dark(one, one.view, camera)
        notes += _find_missing_pages(one, measured[2 - number], camera)
    notes += _compare_flats(references)
    notes += _compare_patterns(measured, references)
    return notes


def _refuse_bright_dark(measured: CameraMeasurement, view: FrameView, camera: str) -> None:
    darks = measured.darks
    level = float(np.median(view.centre))
    # rounding and the noise of the level leave less than one count
    if darks.pages and level < darks.level - 1:
        raise refusal("bright_dark", camera=camera, level=level, darks=darks)


def _find_light_in_dark(
    measured: CameraMeasurement, view: FrameView, camera: str
) -> Iterator[Note]:
    darks = measured.darks
    if not darks.pages:
        return
    dark = mean_of_blocks(darks.mean)
    light = view.blocks - dark
    typical = float(np.median(light))
    if typical <= 0 or np.ptp(light) == 0:  # even light has no shape to compare
        return

    # light in the dark has the shape of the light in the frames
    x, y = light - light.mean(), dark - dark.mean()
    share = float((x * y).sum() / (x * x).sum())
    rest = y - share * x
    std = float(np.sqrt((rest * rest).sum() / (x.size - 2) / (x * x).sum()))
    if share > max(_LEAK, _SIGNIFICANT * std):
        yield _write("light_in_dark", subject=camera, share=share)

    page_std = darks.level_std * np.sqrt(darks.pages) if darks.pages > 1 else 0.0
    if page_std > max(_UNSTEADY * typical, 1.0):
        yield _write("unsteady_dark", subject=camera, std=page_std, share=page_std / typical)


def _find_missing_pages(
    measured: CameraMeasurement, other: CameraMeasurement, camera: str
) -> Iterator[Note]:
    """Pages that one camera lacks against the other, or one light level against the others."""
    pages, others = measured.darks.pages, other.darks.pages
    if 0 < pages < others:
        yield _write("few_darks", subject=camera, pages=count_of(pages, "dark page"), others=others)

    levels = measured.level_pages
    if measured.has_flat and measured.flat_pages < other.flat_pages:
        count = count_of(measured.flat_pages, "flat page")
        yield _write("few_flats", subject=camera, pages=count, others=other.flat_pages)
    elif len(levels) > 1 and levels[-1] < min(levels[:-1]):
        count = count_of(levels[-1], "page")
        yield _write("few_last", subject=camera, pages=count, others=min(levels[:-1]))


def _compare_flats(references: References) -> Iterator[Note]:
    """Large-scale light of the flats: near even, and alike in both cameras."""
    blocks = {
        number: mean_of_blocks(references.flat.values[number - 1])
        for number in (1, 2)
        if bool(references.has_flat.values[number - 1])
    }
    for number, flat in blocks.items():
        darkest = float(flat.min() / flat.max())
        if darkest < _DARK_CORNER:
            yield _write("uneven_flat", subject=f"camera{number}", darkest=darkest)
    if len(blocks) < 2:
        return

    # the level of the lamps does not matter, its shape over the image does
    ratio = blocks[2] / blocks[1]
    ratio = ratio / np.median(ratio)
    low, high = float(ratio.min()), float(ratio.max())
    if max(high, 1 / low) > 1 + _UNLIKE:
        yield _write("unlike_flats", subject="camera1 and camera2", low=low - 1, high=high - 1)


def _compare_patterns(
    measured: Sequence[CameraMeasurement], references: References
) -> Iterator[Note]:
    """Fine structure of the frames against that of both flats."""
    views = [one.view for one in measured]
    shares = {}
    for frames, view in enumerate(views):
        for flat in range(2):
            if view is not None and bool(references.has_flat.values[flat]):
                shares[frames, flat] = find_share(view, measured[frames], references, flat)

    # each camera's frames with the pixels of the other
    if len(shares) == 4 and all(
        shares[n, 1 - n].is_present and shares[n, n].is_missing for n in range(2)
    ):
        raise refusal("exchanged_flats")
    for n in range(2):
        if (n, n) in shares and shares[n, n].is_missing:
            share = shares[n, n]
            yield _write("foreign_flat", subject=f"camera{n + 1}", share=share.value, std=share.std)


def find_share(
    view: FrameView, measured: CameraMeasurement, references: References, flat: int
) -> PatternShare:
    """How much of the structure of a flat is in the frames of a camera.

    Parameters
    ----------
    view : FrameView
        Mean of some frames.
    measured : CameraMeasurement
        Of the camera of the frames, for its dark.
    references : References
    flat : int
        Camera of the flat, 0 or 1.

    Returns
    -------
    PatternShare
        Slope of the structure of the frames over that of the flat, corrected for the noise of the
        flat.
    """
    window = view.window
    response = references.flat.values[flat][window]
    bad = references.bad.values[flat][window] | measured.darks.bad[window]
    frames, in_frames = _fine_structure(view.centre - measured.darks.mean[window], bad)
    pattern, in_pattern = _fine_structure(response, bad)
    sound = in_frames & in_pattern

    x, y = pattern[sound].astype(float), frames[sound].astype(float)
    noise = float(np.mean(references.flat_var.values[flat][window][sound]))
    true = float(np.mean(x * x)) - noise * _KEPT
    if x.size < BLOCKS**2 or true <= 0:
        return PatternShare(0.0, np.inf)
    value = float(np.mean(x * y)) / true
    std = float(np.std(y) * np.std(x)) / (np.sqrt(x.size) * true)
    return PatternShare(value, std)


# Share of the variance of independent pixels that remains above the mean over 3 x 3 of them.
_KEPT = 8 / 9


def _fine_structure(light: AnyArray, bad: Mask) -> tuple[Image, Mask]:
    """Logarithm of the light less its mean over 3 x 3 pixels, and where no dust or bad pixel is."""
    usable = (light > 0) & ~bad
    logarithm = np.log(np.where(usable, light, 1)).astype(np.float32)
    values = logarithm - cv2.blur(logarithm, (3, 3))

    # a bad pixel spoils the mean of its neighbours
    usable = cv2.erode(usable.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    spread = robust_std(values[usable]) if usable.any() else 0.0
    return values, usable & (np.abs(values) < _CLEAR * spread)
