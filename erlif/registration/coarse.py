"""The coarse alignment: offset, rotation and scale of camera 2 from small images.

The frames are binned until they are some 200 pixels wide. A cross-correlation of the whole frame
gives the offset for each of a bank of rotations and scales. Blocks matched around the best of them
give an affine map that enough of the blocks must agree on. Frames that do not agree are refused;
the message names the orientation or the offset at which they would fit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from scipy import fft

from erlif.core.arrays import AnyArray, Array, Image, Mask
from erlif.core.errors import RegistrationError
from erlif.core.statistics import robust_rms
from erlif.registration.blocks import FEWEST, Agreement, agree, match_blocks
from erlif.registration.interpolation import laid_over
from erlif.registration.normalise import binned, normalise
from erlif.registration.pairs import Pair, Textures
from erlif.registration.settings import ORIENTATIONS, RegistrationSettings, orient
from erlif.registration.whitening import padded_size

# The frames are binned by powers of two until their longer side is at most this. [px]
COARSE_SIZE: Final = 256

# The shorter side is not binned below this. [px]
SHORTEST_SIDE: Final = 48

# Blocks are searched this far around the prediction, half as far the second time. [px]
REACH: Final = 6

# Rotations of the bank. [rad]
ROTATIONS: Final = np.radians([0.0, 1.25, -1.25, 2.5, -2.5, 3.75, -3.75, 5.0, -5.0])

# Scales of the bank. [1]
SCALES: Final = (1.0, 1.0125, 0.9875, 1.025, 0.975, 1.0375, 0.9625, 1.05, 0.95)

# Height of a correlation peak over the scatter of the correlation that chance does not reach.
SIGNIFICANT: Final = 7.0

# Height from which on no other blur of the correlation is tried.
CLEAR: Final = 3 * SIGNIFICANT

# Blur of the correlation that takes its noise off. [px]
SHARP: Final = 0.7

# Blur that gathers a peak smeared by a slight rotation or scale. [px]
BROAD: Final = 2.0

# Part of the frame that both cameras must see at an offset. [1]
SHARED: Final = 0.25

# Largest offset that leaves as much of the frame, tried only to explain a failure. [1]
FARTHEST: Final = 0.75

# Every fifth value is enough for the median of the correlation.
EVERY: Final = 5

# Textures are clipped at so many rms, so that a few bright specks do not decide. [1]
CLIPPED: Final = 4.0

# Standard deviation of the local mean of the coarse images. [binned px]
TEXTURE_REACH: Final = 3.0

# Part of the blocks that must agree on an affine map. [1]
AGREEMENT: Final = 0.4

# The same for the frame as it is: with fewer, the bank may hold a better start.
AGREEMENT_UNTURNED: Final = 0.6

# The same for another orientation, which a message is to name.
AGREEMENT_TURNED: Final = 0.5

# Largest departure of the affine map from unity, well above the bank. [1]
LARGEST_SLOPE: Final = 0.2

# Peaks of the bank around which blocks are matched.
BEST_OF_BANK: Final = 4

# Part of the frame that must be lit and sound. [1]
LIT: Final = 0.05

# An offset of this part of the search range is beyond it, for its peak is cut. [1]
AT_THE_LIMIT: Final = 0.98


def coarse_binning(shape: tuple[int, int]) -> int:
    """Power of two that brings the longer side to `COARSE_SIZE` and keeps `SHORTEST_SIDE`."""
    factor = 1
    while max(shape) / factor > COARSE_SIZE and min(shape) / (2 * factor) >= SHORTEST_SIDE:
        factor *= 2
    return factor


def combined_orientation(first: str, second: str) -> str:
    """The one orientation that turns an image as ``first`` and then ``second`` do.

    Examples
    --------
    >>> combined_orientation("rotated_90", "rotated_90")
    'rotated_180'
    """
    probe = np.arange(6).reshape(2, 3)
    both = orient(orient(probe, first), second)
    return next(name for name in ORIENTATIONS if np.array_equal(orient(probe, name), both))


@dataclass(frozen=True)
class Peak:
    """A peak of the cross-correlation for one rotation and scale, about the centre of the frame.

    Attributes
    ----------
    significance : float
        Height over the scatter of the correlation. [1]
    linear : Array
        (2, 2): camera 2 = linear @ (camera 1 - centre) + centre + shift. [1]
    shift : Array
        (2,), x first. [binned px]
    """

    significance: float
    linear: Array
    shift: Array


def _textures(image: AnyArray, weight: AnyArray | None, factor: int) -> tuple[AnyArray, AnyArray]:
    """Texture of a frame after binning, clipped, and its weight."""
    texture, weight = normalise(*binned(image, weight, factor), reach=TEXTURE_REACH)
    return np.clip(texture, -CLIPPED, CLIPPED), weight


def _centre(shape: tuple[int, int]) -> AnyArray:
    """Centre (x, y) of an image. [px]"""
    return np.array([(shape[1] - 1) / 2, (shape[0] - 1) / 2])


def _bank() -> Iterator[AnyArray]:
    """Matrices of all rotations and scales that are tried."""
    for rotation in ROTATIONS:
        c, s = np.cos(rotation), np.sin(rotation)
        for scale in SCALES:
            yield scale * np.array([[c, -s], [s, c]])


@dataclass(frozen=True)
class CoarsePair:
    """The two coarse textures, ready to be compared under any affine map.

    Attributes
    ----------
    textures : Textures
        Of both cameras, binned and clipped.
    factor : int
        Binning of the frames. [px]
    """

    textures: Textures
    factor: int

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of camera 1. [binned px]"""
        return self.textures.a.shape[0], self.textures.a.shape[1]

    @cached_property
    def spline(self) -> tuple[Image, Mask]:
        """Spline of camera 2, see `Textures.spline`."""
        return self.textures.spline(1)

    def turned(self, linear: Array, shift: Array) -> tuple[AnyArray, AnyArray]:
        """Texture and weight of camera 2 at ``linear @ (x - centre) + centre + shift``.

        Both are 0 outside.
        """
        h, w = self.shape
        centre = _centre(self.shape)
        offset = centre + shift - linear @ centre
        x, y = np.meshgrid(np.arange(w, dtype=np.float32), np.arange(h, dtype=np.float32))
        dx = (linear[0, 0] - 1) * x + linear[0, 1] * y + offset[0]
        dy = linear[1, 0] * x + (linear[1, 1] - 1) * y + offset[1]

        fields = dx.astype(np.float32), dy.astype(np.float32)
        out = laid_over(self.spline, *fields, (0.0, 0.0), 1)
        sound = np.isfinite(out)
        return np.where(sound, out, np.float32(0)), sound.astype(np.float32)


class Correlator:
    """Cross-correlation of camera 1 with camera 2, turned in any way, at every offset at once."""

    def __init__(self, coarse: CoarsePair, search: float) -> None:
        h, w = coarse.shape
        both = coarse.textures

        # twice the size, so that the far sides do not meet
        larger = map(max, both.a.shape, both.b.shape)
        self.size = padded_size([2 * side for side in larger])
        self.spectrum = np.conj(fft.rfft2(both.a, self.size))
        self.offset_y = fft.fftfreq(self.size[0], 1 / self.size[0])[:, None]
        self.offset_x = fft.fftfreq(self.size[1], 1 / self.size[1])[None, :]

        # pixels that both cameras see at each offset; turning by a few degrees changes them little
        weights = fft.rfft2(both.weight_b, self.size) * np.conj(fft.rfft2(both.weight, self.size))
        shared = fft.irfft2(weights, self.size)
        self.enough = shared > SHARED * h * w
        near = (np.abs(self.offset_x) <= search * w) & (np.abs(self.offset_y) <= search * h)
        self.inside = self.enough & near
        self.scale = np.where(self.enough, 1 / np.sqrt(np.maximum(shared, 1)), 0).astype(np.float32)

    def peak(self, texture: AnyArray, blur: float) -> tuple[float, AnyArray]:
        """Find the best alignment.

        Parameters
        ----------
        texture : array, (y, x)
            Camera 2, turned.
        blur : float
            Standard deviation of the Gaussian over which the correlation is averaged. [px]

        Returns
        -------
        significance : float
            Height over the scatter of the correlation; 0 if there is none. [1]
        offset : array, (2,)
            Offset (x, y) of camera 2. [binned px]
        """
        # each offset over the square root of its pixels, so that chance has one size everywhere
        ky, kx = fft.fftfreq(self.size[0]), fft.rfftfreq(self.size[1])
        product = fft.rfft2(texture, self.size)
        product *= self.spectrum
        product *= _gaussian(ky, blur)[:, None]
        product *= _gaussian(kx, blur)[None, :]
        value = fft.irfft2(product, self.size, overwrite_x=True)
        value *= self.scale

        if not self.inside.any():
            return 0.0, np.zeros(2)
        chance = robust_rms(value[self.enough][::EVERY])
        if not chance > 0:
            return 0.0, np.zeros(2)

        j, i = np.unravel_index(int(np.argmax(np.where(self.inside, value, -np.inf))), value.shape)
        offset = np.array([float(self.offset_x[0, i]), float(self.offset_y[j, 0])])
        return float(value[j, i]) / chance, offset


def _gaussian(frequency: AnyArray, blur: float) -> AnyArray:
    """Response of a Gaussian of that standard deviation [px] at frequencies [cycles/px]."""
    return np.asarray(np.exp(-0.5 * (2 * np.pi * frequency * blur) ** 2), np.float32)


def _refine_peak(coarse: CoarsePair, peak: Peak) -> Agreement | None:
    """Match blocks about a peak, twice, and keep the affine map if enough of them agree."""
    centre = _centre(coarse.shape)
    linear, shift = peak.linear, peak.shift
    for reach in (REACH, REACH // 2):
        b, wb = coarse.turned(linear, shift)
        centres, vectors, strength = match_blocks(coarse.textures.a, b, wb, reach)
        matrix, offset, agreement = agree(centres - centre, vectors, strength)
        if agreement * len(centres) < FEWEST:
            return None

        # camera 2 was read at L (x - c) + c + s and matches at x + M (x - c) + o
        shift = shift + linear @ offset
        linear = linear @ (np.eye(2) + matrix)
    if agreement < AGREEMENT or np.abs(linear - np.eye(2)).max() > LARGEST_SLOPE:
        return None

    # binned pixel i lies at f i + (f - 1)/2 of the full frame
    f = coarse.factor
    middle = f * centre + (f - 1) / 2
    matrix = linear - np.eye(2)
    return Agreement(matrix, f * shift - matrix @ middle, agreement)


NO_PEAK: Final = Peak(0.0, np.eye(2), np.zeros(2))


def _search_unturned(coarse: CoarsePair, correlator: Correlator) -> tuple[Agreement | None, Peak]:
    """Try the frame as it is, without the bank of rotations and scales."""
    best = NO_PEAK
    for blur in (SHARP, BROAD):
        significance, offset = correlator.peak(coarse.textures.b, blur)
        if significance > best.significance:
            best = Peak(significance, np.eye(2), offset)
        if best.significance > CLEAR:
            break

    if best.significance > SIGNIFICANT:
        start = _refine_peak(coarse, best)
        if start is not None and start.part > AGREEMENT_UNTURNED:
            return start, best
    return None, best


def _peaks_of_bank(coarse: CoarsePair, correlator: Correlator) -> list[Peak]:
    """The peak for each rotation and scale of the bank, the highest first."""
    peaks = []
    for linear in _bank():
        b, _ = coarse.turned(linear, np.zeros(2))
        significance, offset = correlator.peak(b, SHARP)
        peaks.append(Peak(significance, linear, linear @ offset))
    peaks.sort(key=lambda p: -p.significance)
    return peaks


def _search_bank(coarse: CoarsePair, correlator: Correlator) -> tuple[Agreement | None, Peak]:
    """Try the bank of rotations and scales."""
    peaks = _peaks_of_bank(coarse, correlator)
    for peak in peaks[:BEST_OF_BANK]:
        if peak.significance < SIGNIFICANT:
            break
        start = _refine_peak(coarse, peak)
        if start is not None:
            return start, peak
    return None, peaks[0]


# The searches, the quick one first.
SEARCHES: Final[tuple[Callable[[CoarsePair, Correlator], tuple[Agreement | None, Peak]], ...]] = (
    _search_unturned,
    _search_bank,
)


def find_start(pair: Pair, settings: RegistrationSettings) -> Agreement:
    """Find camera 2's offset, rotation and scale against camera 1.

    Parameters
    ----------
    pair : Pair
        Counts above dark; the orientation of the settings is applied to camera 2 already.
    settings : RegistrationSettings
        ``search`` bounds the offset.

    Returns
    -------
    Agreement
        The affine displacement in pixels of the full frame.

    Raises
    ------
    RegistrationError
        If the frames share no texture, if camera 2 is mirrored or turned against the settings, or
        if the offset is beyond the search range.
    """
    factor = coarse_binning(pair.smaller)
    a, wa = _textures(pair.reference, pair.weight_reference, factor)
    b, wb = _textures(pair.moving, pair.weight_moving, factor)
    coarse = CoarsePair(Textures(a, wa, b, wb), factor)
    _check_light(coarse)

    correlator = Correlator(coarse, settings.search)
    best = NO_PEAK
    for search in SEARCHES:
        start, peak = search(coarse, correlator)
        if start is not None:
            return start
        best = max(best, peak, key=lambda p: p.significance)

    # why the frames do not fit: turned, too far off, or nothing in common
    _refuse_turned(pair, settings, coarse)
    _refuse_distant(settings, coarse)
    raise RegistrationError(
        "No common texture found in the images of the two cameras: the highest peak of their "
        f"cross-correlation stands {best.significance:.1f} times above chance, {SIGNIFICANT:.0f} "
        f"are needed, within an offset of {settings.search:.0%} of the frame, 5 degrees and 5 % of "
        "scale. Check that both cameras see the same field in focus and in the same pulse, and "
        "that more light than noise reaches them."
    )


def _check_light(coarse: CoarsePair) -> None:
    """Refuse frames without light, and name the camera."""
    both = coarse.textures
    for camera, weight in ((1, both.weight), (2, both.weight_b)):
        if not (weight > 0).mean() > LIT:
            raise RegistrationError(
                "Registration needs light on both cameras, but hardly any pixel of camera "
                f"{camera} is both lit and sound. Check the exposure, the dark frames and the "
                "masks."
            )


def _refuse_turned(pair: Pair, settings: RegistrationSettings, coarse: CoarsePair) -> None:
    """Raise the error that names the orientation of camera 2, if it fits in another one."""
    for search in SEARCHES:
        for other in ORIENTATIONS[1:]:
            b, weight_b = _textures(*pair.turned(other), coarse.factor)
            trial = replace(coarse, textures=replace(coarse.textures, b=b, weight_b=weight_b))
            start, peak = search(trial, Correlator(trial, settings.search))
            agreement = 0.0 if start is None else start.part
            if agreement < AGREEMENT_TURNED or peak.significance < SIGNIFICANT:
                continue

            total = combined_orientation(settings.orientation, other)
            raise RegistrationError(
                f"Camera 2 is expected in orientation {settings.orientation!r} but its image fits "
                f'that of camera 1 when it is taken as {total!r}. Set orientation = "{total}" in '
                "the settings of the registration, or mount the camera the other way."
            )


def _refuse_distant(settings: RegistrationSettings, coarse: CoarsePair) -> None:
    """Raise the error that names the offset of camera 2, if it fits beyond the search range."""
    best = _peaks_of_bank(coarse, Correlator(coarse, FARTHEST))[0]
    reach = settings.search * np.array(coarse.shape[::-1])
    beyond = bool((np.abs(best.shift) > AT_THE_LIMIT * reach).any())
    if best.significance > SIGNIFICANT and beyond:
        dx, dy = (float(v) * coarse.factor for v in best.shift)
        raise RegistrationError(
            f"Camera 2 is searched within {settings.search:.0%} of the frame, but its image fits "
            f"at an offset of ({dx:.0f}, {dy:.0f}) px. Move its region of interest by that much, "
            "or raise search (at most 0.4)."
        )
