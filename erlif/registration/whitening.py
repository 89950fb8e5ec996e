"""Weight the spatial frequencies by the texture that the two cameras share.

The best weight of a frequency for finding a delay is C/((1 - C) |S12|), with C the squared
coherence and S12 the cross spectrum of the two signals (Knapp and Carter, 1976). Filtering both
textures by its square root gives the Gauss-Newton sums that weight.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from scipy import fft

from erlif.core.arrays import AnyArray, Array, Image

# Side of the blocks whose spectra are averaged. [px]
SIDE: Final = 64

# Blocks of one frame that are averaged; evenly spaced if there are more.
MOST_BLOCKS: Final = 250

# Fewer blocks give a coherence by chance.
FEWEST_BLOCKS: Final = 4

# A block needs this part of its pixels. [1]
SOUND_PART: Final = 0.9

# Pixels next to an edge that the filter changes noticeably. [px]
REACH: Final = 4

# A squared coherence counts above this over the root of the number of independent values. [1]
SIGNIFICANT: Final = 3.0

# Squared coherence of noise-free textures, for which the weight would be infinite. [1]
LARGEST_COHERENCE: Final = 0.9999

# Frequencies that the taper smears into the mean; they get no weight.
TAPER_WIDTH: Final = 2


def padded_size(shape: Sequence[int]) -> tuple[int, int]:
    """Smallest size, at least that of the frame, for which the Fourier transform is fast."""
    return fft.next_fast_len(shape[0], real=True), fft.next_fast_len(shape[1], real=True)


@dataclass(frozen=True)
class Spectra:
    """Sums of block spectra; frequencies (y, x) as in ``rfft2``.

    Attributes
    ----------
    first : Array
        Power of camera 1.
    second : Array
        Power of camera 2.
    cross : Array
        Real part of the cross spectrum; aligned textures are in phase.
    blocks : int
        Number of blocks that were added.
    """

    first: Array
    second: Array
    cross: Array
    blocks: int

    def __add__(self, other: "Spectra") -> "Spectra":
        return Spectra(
            self.first + other.first,
            self.second + other.second,
            self.cross + other.cross,
            self.blocks + other.blocks,
        )


def measure_spectra(a: Image, weight: Image, b: Image) -> Spectra:
    """Spectra of the aligned textures in overlapping Hann windows (Welch, 1967).

    Parameters
    ----------
    a, weight : array, (y, x)
        Texture of camera 1 and its weight. [1]
    b : array, (y, x)
        Texture of camera 2 at the pixels of camera 1, NaN where there is none. Blocks with less
        than nine tenths of their pixels are left out. [1]

    Returns
    -------
    Spectra
        Zeros if no block is left.
    """
    h, w = a.shape

    # blocks overlap by half; a small frame holds at least two along each side
    side = min(SIDE, 1 << int(np.log2(min(h, w) // 2)))
    rows, cols = (h - side) // (side // 2) + 1, (w - side) // (side // 2) + 1
    corners = [(r * side // 2, c * side // 2) for r in range(rows) for c in range(cols)]
    every = -(-len(corners) // MOST_BLOCKS)
    taper = np.hanning(side + 2)[1:-1].astype(np.float32)
    taper = taper[:, None] * taper[None, :]

    first, second, masks = [], [], []
    for y, x in corners[::every]:
        part = (slice(y, y + side), slice(x, x + side))
        ok = (weight[part] > 0) & (np.abs(b[part]) < np.inf)
        if np.count_nonzero(ok) < SOUND_PART * side * side:
            continue
        first.append(a[part])
        second.append(b[part])
        masks.append(ok)
    shape = (side, side // 2 + 1)
    if not first:
        return Spectra(np.zeros(shape), np.zeros(shape), np.zeros(shape), 0)

    sound = np.stack(masks)
    f = fft.rfft2(_tapered(np.stack(first), sound, taper))
    s = fft.rfft2(_tapered(np.stack(second), sound, taper))
    return Spectra(
        (np.abs(f) ** 2).sum(0).astype(float),
        (np.abs(s) ** 2).sum(0).astype(float),
        (f * np.conj(s)).real.sum(0).astype(float),
        len(first),
    )


def _tapered(blocks: AnyArray, sound: AnyArray, taper: AnyArray) -> AnyArray:
    """Blocks (n, y, x) without their mean, faded out towards their edges; 0 where not sound."""
    blocks[~sound] = 0
    mean = blocks.sum((1, 2), keepdims=True) / sound.sum((1, 2), keepdims=True).astype(np.float32)
    return np.asarray((blocks - mean) * (taper * sound))


@dataclass(frozen=True)
class Filter:
    """A radial filter: its amplitude on equidistant spatial frequencies.

    Attributes
    ----------
    amplitude : Array
        Factor of each frequency, at most 1. [1]
    spacing : float
        Distance of the frequencies. [cycles/px]
    """

    amplitude: Array
    spacing: float

    def on_grid(self, shape: tuple[int, int]) -> Image:
        """Amplitude at the frequencies of ``rfft2`` of an image of that shape; float32."""
        ky = np.abs(fft.fftfreq(shape[0]))[:, None].astype(np.float32)
        kx = fft.rfftfreq(shape[1])[None, :].astype(np.float32)
        k = np.sqrt(ky * ky + kx * kx)
        k *= np.float32(1 / self.spacing)

        # linear between the frequencies, constant beyond the last
        values = np.append(self.amplitude, self.amplitude[-1]).astype(np.float32)
        np.minimum(k, np.float32(len(self.amplitude) - 1), out=k)
        low = k.astype(np.int32)
        k -= low
        base = values[low]
        result: Image = base + k * (values[low + 1] - base)
        return result


def make_filter(spectra: Spectra) -> Filter | None:
    """Make the filter that weights the frequencies best.

    Parameters
    ----------
    spectra : Spectra
        Of the aligned textures.

    Returns
    -------
    Filter or None
        Amplitude 0 where the coherence is within its own scatter; None where that is so at all
        frequencies, or where there are too few blocks.
    """
    if spectra.blocks < FEWEST_BLOCKS:
        return None

    # averages over rings of one frequency, out to the corners of the spectrum nearly
    side = spectra.first.shape[0]
    ky = np.abs(fft.fftfreq(side))[:, None]
    kx = fft.rfftfreq(side)[None, :]
    radius = np.rint(np.hypot(ky, kx) * side).astype(int)
    n = side // 2 + side // 4
    count = np.bincount(radius.ravel(), minlength=n + 1)[:n]

    def ring(values: AnyArray) -> AnyArray:
        total = np.bincount(radius.ravel(), weights=values.ravel(), minlength=n + 1)[:n]
        return np.asarray(total / np.maximum(count, 1))

    # the squared coherence of unrelated textures is 1/n on average, n independent values
    s11, s22, s12 = ring(spectra.first), ring(spectra.second), ring(spectra.cross)
    with np.errstate(divide="ignore", invalid="ignore"):
        gamma = np.where((s11 > 0) & (s22 > 0), s12 / np.sqrt(s11 * s22), 0)
    independent = np.maximum(count * spectra.blocks / 2, 1)  # half-overlapping Hann blocks
    coherence = np.where(gamma > 0, gamma**2, 0)
    coherence = np.clip(coherence - 1 / independent, 0, LARGEST_COHERENCE)
    coherence[:TAPER_WIDTH] = 0
    significant = coherence > SIGNIFICANT / np.sqrt(independent)
    if not significant.any():
        return None

    # Knapp and Carter's weight; each texture takes its square root
    coherence = np.where(significant, coherence, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        power = np.where(significant, coherence / ((1 - coherence) * np.abs(s12)), 0)
    amplitude = np.sqrt(power)

    # a 1-2-1 average keeps the scatter of single rings out of the filter
    amplitude[1:-1] = 0.25 * amplitude[:-2] + 0.5 * amplitude[1:-1] + 0.25 * amplitude[2:]
    amplitude[0] = amplitude[1]
    return Filter(amplitude / amplitude.max(), 1.0 / side)


def slope_gain(spectra: Spectra, filter_: Filter | None) -> float:
    """Factor by which the five-point derivative falls short of the true slope of a score.

    The score of a texture of wave number k rises as k D(k) with the displacement, D being the
    response of the derivative, while the gradient products hold D(k)^2. Both are weighted by the
    texture that the cameras share.

    Parameters
    ----------
    spectra : Spectra
        Of the aligned textures, before the filter.
    filter_ : Filter or None
        The filter that both textures have passed.

    Returns
    -------
    float
        1 for smooth texture, more for a fine one. [1]
    """
    if spectra.blocks == 0:
        return 1.0
    side = spectra.first.shape[0]
    ky = 2 * np.pi * fft.fftfreq(side)[:, None]
    kx = 2 * np.pi * fft.rfftfreq(side)[None, :]
    common = np.maximum(spectra.cross, 0)
    common[0, 0] = 0
    if filter_ is not None:
        radius = np.hypot(ky, kx) / (2 * np.pi)
        frequencies = filter_.spacing * np.arange(len(filter_.amplitude))
        common = common * np.interp(radius, frequencies, filter_.amplitude) ** 2

    true, held = 0.0, 0.0
    for k in (kx, ky):
        derivative = (8 * np.sin(k) - np.sin(2 * k)) / 6
        true += float((k * derivative * common).sum())
        held += float((derivative**2 * common).sum())
    return max(true / held, 1.0) if held > 0 else 1.0


def whiten_texture(
    texture: Image,
    weight: Image,
    amplitude: Image,
    *,
    threads: int = 1,
    out: tuple[Image, Image] | None = None,
) -> tuple[Image, Image]:
    """Filter a texture.

    Parameters
    ----------
    texture, weight : array, (y, x)
        As from `normalise`.
    amplitude : array
        From `Filter.on_grid` of the `padded_size` of the texture.
    threads : int
        Threads to use; the result does not depend on it.
    out : tuple of two array, (y, x), float32, optional
        Receive the result; they may be the given texture and weight.

    Returns
    -------
    texture : array, (y, x), float32
        Rms 1 over the frame. [1]
    weight : array, (y, x), float32
        As given, but 0 next to the edges of the frame, beyond which the filter finds no light.
    """
    h, w = texture.shape
    size = padded_size((h, w))
    spectrum = fft.rfft2(texture, size, workers=threads)
    spectrum *= amplitude
    filtered = np.ascontiguousarray(
        fft.irfft2(spectrum, size, overwrite_x=True, workers=threads)[:h, :w]
    )

    scale = cv2.norm(filtered) / np.sqrt(filtered.size)  # the rms, summed in double precision
    result, kept = (filtered, np.empty_like(weight)) if out is None else out
    np.multiply(filtered, np.float32(1 / scale if scale > 0 else 1), out=result)

    kept[:] = weight
    kept[:REACH] = 0
    kept[h - REACH :] = 0
    kept[:, :REACH] = 0
    kept[:, w - REACH :] = 0
    return result, kept
