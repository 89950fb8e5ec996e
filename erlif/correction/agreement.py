"""Agreement of darks and flats with the frames of their camera.

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
from erlif.core.errors import FrameError
from erlif.core.notes import Note, warn
from erlif.core.products import References
from erlif.core.statistics import robust_std
from erlif.core.units import count_of
from erlif.correction.camera import CameraMeasurement
from erlif.correction.view import BLOCKS, FrameView, mean_of_blocks

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
    """Share of the fine structure of a flat that the frames contain.

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
        raise FrameError(
            f"Expected the frames of {camera} to be brighter than its dark; half of their pixels "
            f"are below {level:.1f} DN, the dark has {darks.level:.1f} DN. Dark and flat may be "
            "exchanged, the dark recorded with light, or the offset of the camera changed. Correct "
            f"dark in [{camera}], or record darks with the shutter closed and the settings of the "
            "frames."
        )


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
        yield warn(
            camera,
            f"the dark shows {share:.1%} of the light of the frames, in their shape: light fell "
            "on the sensor. Record the darks again with the shutter closed and the laser off",
        )

    page_std = darks.level_std * np.sqrt(darks.pages) if darks.pages > 1 else 0.0
    if page_std > max(_UNSTEADY * typical, 1.0):
        yield warn(
            camera,
            f"the dark level changes by {page_std:.1f} DN from page to page, "
            f"{page_std / typical:.1%} of the light: some pages were lit, or the camera had not "
            "settled. Record the darks again",
        )


def _find_missing_pages(
    measured: CameraMeasurement, other: CameraMeasurement, camera: str
) -> Iterator[Note]:
    """Warn of a camera, or a light level, that has fewer pages than the others."""
    faults = []
    pages, others = measured.darks.pages, other.darks.pages
    if 0 < pages < others:
        faults.append(f"{count_of(pages, 'dark page')}, the other camera has {others}")

    levels = measured.level_pages
    if measured.has_flat and measured.flat_pages < other.flat_pages:
        count = count_of(measured.flat_pages, "flat page")
        faults.append(f"{count}, the other camera has {other.flat_pages}")
    elif len(levels) > 1 and levels[-1] < min(levels[:-1]):
        count = count_of(levels[-1], "page")
        most = min(levels[:-1])
        faults.append(f"{count} at the last light level of the flat, {most} and more at the others")
    cure = "The file may be cut short: export it again, or record it again"
    yield from (warn(camera, f"{fault}. {cure}") for fault in faults)


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
            yield warn(
                f"camera{number}",
                f"the light of the flat falls to {darkest:.0%} within the image, more than lenses "
                "do. It shows the beam of the laser, a film or a shadow in place of an even "
                "target. Record flats of an evenly lit target",
            )
    if len(blocks) < 2:
        return

    # the level of the lamps does not matter, its shape over the image does
    ratio = blocks[2] / blocks[1]
    ratio = ratio / np.median(ratio)
    low, high = float(ratio.min()), float(ratio.max())
    if max(high, 1 / low) > 1 + _UNLIKE:
        yield warn(
            "camera1 and camera2",
            f"the ratio is wrong by {low - 1:+.0%} to {high - 1:+.0%} over the image, by which "
            "the light of their flats differs. The flats show different targets or lamps: record "
            "those of both cameras with one evenly lit target",
        )


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
        raise FrameError(
            "Expected the response of the pixels of each camera in its own frames; the frames of "
            "camera1 show the pixels of the flat of camera2, and those of camera2 the pixels of "
            "the flat of camera1. The cameras look swapped: exchange files in [camera1] and "
            "[camera2], or dark and flat, whichever names the other camera."
        )
    for n in range(2):
        if (n, n) in shares and shares[n, n].is_missing:
            share = shares[n, n]
            yield warn(
                f"camera{n + 1}",
                "the frames do not show the response of the pixels that the flat shows "
                f"({share.value:.2f} ± {share.std:.2f} of it), which adds to the film. The flat "
                "is of another camera, another region of interest or another time: name the flat "
                "that belongs to these frames, or record one",
            )


def find_share(
    view: FrameView, measured: CameraMeasurement, references: References, flat: int
) -> PatternShare:
    """Estimate the share of the structure of a flat that the frames of a camera contain.

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
