"""Weight the spatial frequencies by what the two cameras share.

The best weight of a frequency for finding a delay is C/((1 - C) |S12|), C the squared coherence and S12 the cross
spectrum of the two signals (C. H. Knapp, G. C. Carter, IEEE Trans. Acoust. Speech Signal Process. 24 (1976) 320).
Filtering both textures by its square root makes the Gauss-Newton sums do that.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy import fft

from erlif.core.arrays import AnyArray

SIDE: Final = 64
"""Side of the blocks whose spectra are averaged. [px]"""
MOST_BLOCKS: Final = 160
REACH: Final = 4
"""Pixels next to an edge or a hole that the filter changes noticeably. [px]"""


@dataclass(frozen=True)
class Spectra:
    """Sums of block spectra: of camera 1, camera 2, and between them; frequencies as in ``rfft2``."""

    first: AnyArray
    second: AnyArray
    cross: AnyArray
    blocks: int

    def __add__(self, other: "Spectra") -> "Spectra":
        return Spectra(
            self.first + other.first,
            self.second + other.second,
            self.cross + other.cross,
            self.blocks + other.blocks,
        )


def measure_spectra(a: AnyArray, weight: AnyArray, b: AnyArray) -> Spectra:
    """Spectra of the aligned textures in Hann windows (P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70).

    Parameters
    ----------
    a, weight : array, (y, x)
        Texture of camera 1 and its weight.
    b : array, (y, x)
        Texture of camera 2 at the pixels of camera 1, NaN where there is none. Blocks with less than nine tenths of
        their pixels are left out.
    """
    h, w = a.shape
    side = min(SIDE, 1 << int(np.log2(min(h, w) // 2)))
    rows, cols = (h - side) // (side // 2) + 1, (w - side) // (side // 2) + 1
    corners = [(r * side // 2, c * side // 2) for r in range(rows) for c in range(cols)]
    every = -(-len(corners) // MOST_BLOCKS)
    taper = np.hanning(side + 2)[1:-1].astype(np.float32)
    taper = taper[:, None] * taper[None, :]
    first, second, tapers = [], [], []
    for y, x in corners[::every]:
        part = (slice(y, y + side), slice(x, x + side))
        ok = (weight[part] > 0) & (np.abs(b[part]) < np.inf)
        if np.count_nonzero(ok) < 0.9 * side * side:
            continue
        first.append(a[part])
        second.append(b[part])
        tapers.append(ok)
    shape = (side, side // 2 + 1)
    if not first:
        return Spectra(np.zeros(shape), np.zeros(shape), np.zeros(shape), 0)
    sound = np.stack(tapers)
    f = fft.rfft2(_tapered(np.stack(first), sound, taper))
    s = fft.rfft2(_tapered(np.stack(second), sound, taper))
    return Spectra(
        (np.abs(f) ** 2).sum(0).astype(float),
        (np.abs(s) ** 2).sum(0).astype(float),
        (f * np.conj(s)).real.sum(0).astype(float),  # the aligned textures are in phase
        len(first),
    )


def _tapered(blocks: AnyArray, sound: AnyArray, taper: AnyArray) -> AnyArray:
    """Blocks (n, y, x) without their mean and without what is not sound, faded out towards their edges."""
    blocks[~sound] = 0
    mean = blocks.sum((1, 2), keepdims=True) / sound.sum((1, 2), keepdims=True).astype(np.float32)
    return np.asarray((blocks - mean) * (taper * sound))


@dataclass(frozen=True)
class Filter:
    """A radial filter: its amplitude on equidistant spatial frequencies."""

    amplitude: AnyArray
    spacing: float
    """Distance of the frequencies. [cycles/px]"""
    coherence: AnyArray
    """Squared coherence at the same frequencies. [1]"""

    def on_grid(self, shape: tuple[int, int]) -> AnyArray:
        """Amplitude at the frequencies of ``rfft2`` of an image of that shape; float32."""
        ky = np.abs(fft.fftfreq(shape[0]))[:, None].astype(np.float32)
        kx = fft.rfftfreq(shape[1])[None, :].astype(np.float32)
        k = np.sqrt(ky * ky + kx * kx)
        k *= np.float32(1 / self.spacing)
        values = np.append(self.amplitude, self.amplitude[-1]).astype(np.float32)
        np.minimum(k, np.float32(len(self.amplitude) - 1), out=k)
        low = k.astype(np.int32)
        k -= low
        base = values[low]
        result: AnyArray = base + k * (values[low + 1] - base)
        return result


def make_filter(spectra: Spectra) -> Filter | None:
    """The filter that weighs the frequencies best, or None when the spectra show nothing to gain.

    Where the coherence is below its own scatter the amplitude is 0.
    """
    if spectra.blocks < 4:
        return None
    side = spectra.first.shape[0]
    ky = np.abs(fft.fftfreq(side))[:, None]
    kx = fft.rfftfreq(side)[None, :]
    radius = np.rint(np.hypot(ky, kx) * side).astype(int)
    n = side // 2 + side // 4
    count = np.bincount(radius.ravel(), minlength=n + 1)[:n]

    def ring(values: AnyArray) -> AnyArray:
        total = np.bincount(radius.ravel(), weights=values.ravel(), minlength=n + 1)[:n]
        return np.asarray(total / np.maximum(count, 1))

    s11, s22, s12 = ring(spectra.first), ring(spectra.second), ring(spectra.cross)
    with np.errstate(divide="ignore", invalid="ignore"):
        gamma = np.where((s11 > 0) & (s22 > 0), s12 / np.sqrt(s11 * s22), 0)
    independent = np.maximum(count * spectra.blocks / 2, 1)  # half-overlapping Hann blocks
    coherence = np.where(gamma > 0, gamma**2, 0)
    coherence = np.clip(coherence - 1 / independent, 0, 0.9999)
    coherence[:2] = 0  # below the taper's own width
    significant = coherence > 3 / np.sqrt(independent)
    if not significant.any():
        return None
    coherence = np.where(significant, coherence, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        power = np.where(significant, coherence / ((1 - coherence) * np.abs(s12)), 0)
    amplitude = np.sqrt(power)
    amplitude[1:-1] = 0.25 * amplitude[:-2] + 0.5 * amplitude[1:-1] + 0.25 * amplitude[2:]
    amplitude[0] = amplitude[1]
    return Filter(amplitude / amplitude.max(), 1.0 / side, coherence)


def slope_gain(spectra: Spectra, filter_: Filter | None) -> float:
    """By how much the five-point derivative falls short of the slope with which a score answers to a displacement.

    A texture of wave number k answers with k D(k), D the response of the derivative, where the sums hold D(k)^2; both
    weighted by the texture common to the cameras. 1 for smooth texture, more for a fine one.
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
        common = (
            common
            * np.interp(
                radius, filter_.spacing * np.arange(len(filter_.amplitude)), filter_.amplitude
            )
            ** 2
        )
    answer, held = 0.0, 0.0
    for k in (kx, ky):
        derivative = (8 * np.sin(k) - np.sin(2 * k)) / 6
        answer += float((k * derivative * common).sum())
        held += float((derivative**2 * common).sum())
    return max(answer / held, 1.0) if held > 0 else 1.0


def padded_size(shape: tuple[int, ...]) -> tuple[int, int]:
    """Size at least as large as the frame that the Fourier transform is fast at."""
    return fft.next_fast_len(shape[0], real=True), fft.next_fast_len(shape[1], real=True)


def whiten(
    texture: AnyArray, weight: AnyArray, amplitude: AnyArray, *, threads: int = 1
) -> tuple[AnyArray, AnyArray]:
    """Filter a texture; its weight becomes 0 near the frame's edge and around holes, where the filter saw no light.

    Parameters
    ----------
    texture, weight : array, (y, x)
        As from `normalise`.
    amplitude : array
        From `Filter.on_grid` of the `padded_size` of the texture.
    """
    h, w = texture.shape
    size = padded_size((h, w))
    spectrum = fft.rfft2(texture, size, workers=threads)
    spectrum *= amplitude
    filtered = np.ascontiguousarray(
        fft.irfft2(spectrum, size, overwrite_x=True, workers=threads)[:h, :w]
    )
    scale = float(np.sqrt(np.mean(filtered**2)))
    if scale > 0:
        filtered *= np.float32(1 / scale)
    kept = weight.copy()
    kept[:REACH] = 0
    kept[h - REACH :] = 0
    kept[:, :REACH] = 0
    kept[:, w - REACH :] = 0
    return filtered, kept
