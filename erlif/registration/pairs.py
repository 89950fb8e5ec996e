"""Pairs of frames as they come in, checked and turned the right way."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import RegistrationError
from erlif.registration.bands import in_bands
from erlif.registration.normalise import REACH, binned, normalise
from erlif.registration.settings import RegistrationSettings, orient
from erlif.registration.warp import NOTHING_BAD, sample_spline, spline_coefficients

PairOfArrays = tuple[AnyArray, AnyArray, AnyArray | None, AnyArray | None]
Pairs = Sequence[PairOfArrays] | Callable[[], Iterable[PairOfArrays]]
"""(reference, moving, weight_reference, weight_moving) of each frame, read when needed."""


@dataclass(frozen=True)
class Pair:
    """One frame of each camera; ``moving`` is oriented like ``reference``."""

    reference: AnyArray
    moving: AnyArray
    weight_reference: AnyArray | None = None
    weight_moving: AnyArray | None = None


def make_pair(
    reference: AnyArray,
    moving: AnyArray,
    weight_reference: AnyArray | None,
    weight_moving: AnyArray | None,
    settings: RegistrationSettings,
) -> Pair:
    """Check a pair of frames and apply the orientation of the settings to camera 2.

    Raises
    ------
    RegistrationError
        If the arrays are not images of at least 64 by 64 pixels, a weight does not fit its image, or the frames of
        the two cameras differ too much in size to show the same field.
    """
    images = []
    weights: list[AnyArray | None] = []
    for camera, image, weight in ((1, reference, weight_reference), (2, moving, weight_moving)):
        image = np.asarray(image)
        if image.ndim != 2 or min(image.shape) < 64 or image.dtype.kind not in "uif":
            raise RegistrationError(
                f"Registration needs grey images (y, x) of at least 64 by 64 pixels; camera {camera} has "
                f"{image.dtype} of shape {image.shape}. Pass one frame of each camera."
            )
        if weight is not None and np.shape(weight) != image.shape:
            raise RegistrationError(
                f"The weight of camera {camera} has shape {np.shape(weight)}, its image {image.shape}; "
                "pass one weight for each pixel."
            )
        if camera == 2:
            image = orient(image, settings.orientation)
            weight = None if weight is None else orient(np.asarray(weight), settings.orientation)
        if image.dtype.kind == "f" and weight is None and not np.isfinite(image).all():
            weight = np.isfinite(image)
        if image.dtype not in (np.uint16, np.float32):
            image = image.astype(np.float32)
        images.append(np.ascontiguousarray(image))
        weights.append(None if weight is None else np.ascontiguousarray(weight, np.float32))
    return Pair(images[0], images[1], weights[0], weights[1])


@dataclass(frozen=True)
class Textures:
    """A pair of frames ready to be matched: what is left after illumination, and camera 2 as a spline."""

    a: AnyArray
    weight: AnyArray
    b: AnyArray
    weight_b: AnyArray

    def spline(self, threads: int) -> tuple[AnyArray, AnyArray]:
        """Spline coefficients of camera 2 and its marked pixels."""
        bad = NOTHING_BAD if (self.weight_b > 0).all() else self.weight_b == 0
        return spline_coefficients(self.b, threads=threads), bad


def textures(pair: Pair, binning: int, threads: int) -> Textures:
    """Normalise both frames, binned first if ``binning`` is above 1."""
    if binning == 1:
        a, wa = normalise(pair.reference, pair.weight_reference, threads=threads)
        b, wb = normalise(pair.moving, pair.weight_moving, threads=threads)
    else:
        reach = max(REACH / binning, 3.0)
        a, wa = normalise(
            *binned(pair.reference, pair.weight_reference, binning), reach=reach, threads=threads
        )
        b, wb = normalise(
            *binned(pair.moving, pair.weight_moving, binning), reach=reach, threads=threads
        )
    return Textures(a, wa, b, wb)


def laid_over(
    spline: tuple[AnyArray, AnyArray],
    dx: AnyArray,
    dy: AnyArray,
    drift: tuple[float, float],
    threads: int,
) -> AnyArray:
    """Texture of camera 2 at the pixels of camera 1; NaN where there is none."""
    out = np.empty(dx.shape, np.float32)
    coefficients, bad = spline
    x, y = float(drift[0]), float(drift[1])
    in_bands(
        lambda s, t: sample_spline(coefficients, dx, dy, x, y, bad, out, s, t), dx.shape[0], threads
    )
    return out


@dataclass(frozen=True)
class Frames:
    """Frames that can be gone through again and again, one pair in memory at a time."""

    source: Pairs
    count: int
    chosen: tuple[int, ...]
    """Those from which the map is made."""
    settings: RegistrationSettings

    def pick(self, wanted: Sequence[int]) -> Iterator[Pair]:
        """Read the pairs with these numbers, which must ascend."""
        if callable(self.source):
            keep = set(wanted)
            for number, pair in enumerate(self.source()):
                if number in keep:
                    yield make_pair(*pair, self.settings)
        else:
            for number in wanted:
                yield make_pair(*self.source[number], self.settings)


def open_frames(source: Pairs, settings: RegistrationSettings) -> Frames:
    """Count the frames and choose those for the map, evenly spaced."""
    count = sum(1 for _ in source()) if callable(source) else len(source)
    if count == 0:
        raise RegistrationError("Registration needs at least one pair of frames, got none.")
    most = min(count, settings.frames_for_map)
    chosen = tuple(sorted({round((i + 0.5) * count / most - 0.5) for i in range(most)}))
    return Frames(source, count, chosen, settings)
