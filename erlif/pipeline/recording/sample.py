"""A sample of a recording: bands of a few frame pairs, aligned, for what needs no more.

The difference of sharpness and the order of the cameras follow from a million pixels. The pairs
are read and aligned once for both.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from erlif.core.arrays import Image
from erlif.core.products import AlignedFrames, RatioImages
from erlif.pipeline.chain import FrameChain, one_thread_per_frame
from erlif.ratio import BlurDifference, ExcessSums, measure_blur

# Frame pairs of the sample.
_FRAMES = 4

# Pixels up to which frames are taken whole. [px]
_WHOLE = 500_000

# Bands of a large frame, evenly spread, and their rows. A quarter of 1280 x 1024 pixels: the
# difference of sharpness of the virtual rig, 0.042 px2, then has a standard deviation of 0.001 px2
# in place of 0.0005, and the ghost that this leaves is 3 % of the one removed.
_BANDS, _ROWS = 4, 64


# Rows of both cameras of one frame pair on the pixels of camera 1.
Bands = tuple[AlignedFrames, ...]

# Their ratios.
SampleRatios = list[list[RatioImages]]


def sample_frames(chain: FrameChain) -> tuple[Bands, ...]:
    """Read and align parts of a few frame pairs, evenly spread over the recording.

    Parameters
    ----------
    chain : FrameChain

    Returns
    -------
    tuple of tuple of AlignedFrames
        The bands of each pair.
    """
    # the same rows of every frame: marks of the surfaces enter all of them alike
    rows = choose_bands(chain.pairs.shape)
    with one_thread_per_frame():
        return tuple(chain.align_bands(frame, rows) for frame in chain.pairs.spread(_FRAMES))


def choose_bands(shape: tuple[int, int]) -> list[slice]:
    """Rows of the sample.

    Parameters
    ----------
    shape : (rows, columns)
        [px]

    Returns
    -------
    list of slice

    Examples
    --------
    >>> choose_bands((480, 640))
    [slice(0, 480, None)]
    >>> [(band.start, band.stop) for band in choose_bands((1024, 1280))]
    [(96, 160), (352, 416), (608, 672), (864, 928)]
    """
    rows, columns = shape
    if rows * columns <= _WHOLE or rows < _BANDS * _ROWS:
        return [slice(0, rows)]
    starts = [(2 * n + 1) * rows // (2 * _BANDS) - _ROWS // 2 for n in range(_BANDS)]
    return [slice(start, start + _ROWS) for start in starts]


def compare_sharpness(chain: FrameChain, sample: tuple[Bands, ...]) -> BlurDifference:
    """Difference of sharpness between the cameras, and the excess of the ratio that it leaves."""
    parts = [band for bands in sample for band in bands]
    blur, excess = measure_blur(parts), ExcessSums()
    plain, corrected = replace(chain, blur=BlurDifference()), replace(chain, blur=blur)
    for band in parts:
        ratios = plain.divide(band)
        excess.add(band, ratios, corrected.divide(band) if blur.significant else ratios)
    found, std = excess.solve()
    return replace(blur, excess=found, excess_std=std)


def divide_sample(chain: FrameChain, sample: Sequence[Bands]) -> SampleRatios:
    """Ratio images of the bands of a sample."""
    return [[chain.divide(band) for band in bands] for bands in sample]


def ratios_of(sample: SampleRatios) -> Iterator[tuple[Image, Image]]:
    """Ratios of the sound pixels of each pair of a sample.

    Parameters
    ----------
    sample : list of list of RatioImages
        From `divide_sample`.

    Yields
    ------
    log_ratio : array, (pixel,)
        Logarithm of the ratio. [1]
    noise : array, (pixel,)
        Its standard deviation. [1]
    """
    for bands in sample:
        log_ratios: list[Image] = []
        noise: list[Image] = []
        for ratios in bands:
            good = ratios.flags.values == 0
            log_ratios.append(ratios.log_ratio.values[good])
            noise.append(np.sqrt(ratios.log_ratio_var.values[good]))
        if any(ratio.size for ratio in log_ratios):
            yield np.concatenate(log_ratios), np.concatenate(noise)
