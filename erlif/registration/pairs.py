"""Pairs of frames: checked, turned into the orientation of camera 1, normalised."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from erlif.core.arrays import AnyArray, Image, Mask
from erlif.core.errors import RegistrationError
from erlif.registration.interpolation import NOTHING_BAD, spline_coefficients
from erlif.registration.normalise import REACH, binned, normalise
from erlif.registration.settings import RegistrationSettings, orient

# Frames below this side hold too few blocks for the coarse alignment. [px]
SMALLEST_SIDE: Final = 64

# Smallest standard deviation of the local mean of a binned image. [binned px]
LEAST_REACH: Final = 3.0

# An image and its weight, None where all pixels count.
Weighted = tuple[AnyArray, AnyArray | None]

# `(reference, moving, weight_reference, weight_moving)` of one frame.
PairOfArrays = tuple[AnyArray, AnyArray, AnyArray | None, AnyArray | None]

# The pairs of a run; a sequence may read each when it is indexed.
Pairs = Sequence[PairOfArrays]


@dataclass(frozen=True)
class Pair:
    """One frame of each camera, in the orientation of camera 1.

    Attributes
    ----------
    reference : AnyArray
        Camera 1, (y, x), uint16 or float32. [counts]
    moving : AnyArray
        Camera 2, (y, x), uint16 or float32. [counts]
    weight_reference : Image | None
        0 for pixels of camera 1 that must not count, float32; None if all count. [1]
    weight_moving : Image | None
        The same for camera 2. [1]
    """

    reference: AnyArray
    moving: AnyArray
    weight_reference: Image | None = None
    weight_moving: Image | None = None

    @property
    def smaller(self) -> tuple[int, int]:
        """Rows and columns that both cameras have."""
        (h, w), (height, width) = self.reference.shape, self.moving.shape
        return min(h, height), min(w, width)

    def turned(self, orientation: str) -> tuple[AnyArray, Image | None]:
        """Camera 2 and its weight in another orientation."""
        moving, weight = self.moving, self.weight_moving
        turned = None if weight is None else np.ascontiguousarray(orient(weight, orientation))
        return np.ascontiguousarray(orient(moving, orientation)), turned


def make_pair(
    reference: AnyArray,
    moving: AnyArray,
    weight_reference: AnyArray | None,
    weight_moving: AnyArray | None,
    settings: RegistrationSettings,
) -> Pair:
    """Check a pair of frames and apply the orientation of the settings to camera 2.

    Parameters
    ----------
    reference, moving, weight_reference, weight_moving : array, (y, x)
        As for `register`. Pixels that are not finite get weight 0 if no weight is given.
    settings : RegistrationSettings
        Gives the orientation.

    Returns
    -------
    Pair
        Contiguous arrays in the types that the kernels take.

    Raises
    ------
    RegistrationError
        If the arrays are not images of at least 64 by 64 pixels, or a weight does not fit its
        image.
    """
    one, weight_one = _as_kernels_take(1, reference, weight_reference)
    two, weight_two = _as_kernels_take(2, moving, weight_moving)
    turned, weight_turned = Pair(one, two, weight_one, weight_two).turned(settings.orientation)
    return Pair(one, turned, weight_one, weight_turned)


def _as_kernels_take(
    camera: int, image: AnyArray, weight: AnyArray | None
) -> tuple[AnyArray, Image | None]:
    """The image and its weight as the kernels take them; anything but a grey image is refused."""
    image = np.asarray(image)
    if image.ndim != 2 or min(image.shape) < SMALLEST_SIDE or image.dtype.kind not in "uif":
        raise RegistrationError(
            f"Registration needs grey images (y, x) of at least {SMALLEST_SIDE} by {SMALLEST_SIDE} "
            f"pixels; camera {camera} has {image.dtype} of shape {image.shape}. Pass one frame of "
            "each camera."
        )
    if weight is not None and np.shape(weight) != image.shape:
        raise RegistrationError(
            f"The weight of camera {camera} has shape {np.shape(weight)}, its image {image.shape}; "
            "pass one weight for each pixel."
        )
    if weight is None and image.dtype.kind == "f" and not np.isfinite(image).all():
        weight = np.isfinite(image)

    # the types for which the kernels are compiled
    if image.dtype not in (np.uint16, np.float32):
        image = image.astype(np.float32)
    image = np.ascontiguousarray(image)
    return image, None if weight is None else np.ascontiguousarray(weight, np.float32)


@dataclass(frozen=True)
class Textures:
    """A pair of frames without illumination, ready to be matched.

    Attributes
    ----------
    a : Image
        Texture of camera 1, (y, x), mean 0, rms about 1. [1]
    weight : Image
        Its weight, 0 where the texture is unknown. [1]
    b : Image
        Texture of camera 2 on its own pixels, (y, x). [1]
    weight_b : Image
        Its weight. [1]
    """

    a: Image
    weight: Image
    b: Image
    weight_b: Image

    def spline(self, threads: int) -> tuple[Image, Mask]:
        """Spline coefficients of camera 2, and its pixels without weight as a mask."""
        bad = NOTHING_BAD if (self.weight_b > 0).all() else self.weight_b == 0
        return spline_coefficients(self.b, threads=threads), bad


def textures(pair: Pair, binning: int, threads: int) -> Textures:
    """Normalise both frames, binned first if ``binning`` is above 1."""
    one, two = (pair.reference, pair.weight_reference), (pair.moving, pair.weight_moving)
    if binning > 1:
        one, two = binned(*one, binning), binned(*two, binning)
    return normalise_both(one, two, binning=binning, threads=threads)


def normalise_both(one: Weighted, two: Weighted, *, binning: int, threads: int = 1) -> Textures:
    """The textures of images that are binned already."""
    # the window covers the same field of view, but enough binned pixels for a mean
    reach = max(REACH / binning, LEAST_REACH)
    return Textures(
        *normalise(*one, reach=reach, threads=threads),
        *normalise(*two, reach=reach, threads=threads),
    )


@dataclass(frozen=True)
class PairSeries:
    """Frames that can be read again and again, one pair in memory at a time.

    Attributes
    ----------
    source : Pairs
        Where the pairs come from.
    count : int
        Number of pairs.
    chosen : tuple[int, ...]
        Numbers of the pairs from which the map is made, ascending.
    settings : RegistrationSettings
        Settings under which each pair is checked and turned.
    """

    source: Pairs
    count: int
    chosen: tuple[int, ...]
    settings: RegistrationSettings

    def pick(self, wanted: Sequence[int]) -> Iterator[Pair]:
        """Read the pairs with these numbers."""
        for number in wanted:
            yield make_pair(*self.source[number], self.settings)


def open_series(source: Pairs, settings: RegistrationSettings) -> PairSeries:
    """Count the frames and choose those for the map, evenly spaced.

    Raises
    ------
    RegistrationError
        If there are none.
    """
    count = len(source)
    if count == 0:
        raise RegistrationError(
            "Registration needs at least one pair of frames, got none. Pass one or more."
        )

    # the middle of each of equal parts of the run
    most = min(count, settings.frames_for_map)
    chosen = tuple(sorted({round((i + 0.5) * count / most - 0.5) for i in range(most)}))
    return PairSeries(source, count, chosen, settings)
