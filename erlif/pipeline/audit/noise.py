"""Whether the noise of the ratio is that of the counts by gain and read noise.

Counts that were halved, averaged or smoothed after the recording have less noise than their cameras
leave; the gain that darks, flats and settings give is then not that of the frames.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import cv2
import numpy as np

from erlif.core.notes import Note, warn
from erlif.core.statistics import robust_rms
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.recording.sample import Bands

# Noise over that which is expected, below which counts were changed: sound frames have 1.02 to 1.1,
# counts that were halved 0.8.
_LEAST = 0.9

_FEWEST = 2000  # pixels from which on the noise is known to 2 %

# A pixel less the mean of the eight two pixels away: removes the film, and what the interpolation
# correlates.
_RING = np.zeros((5, 5), np.float32)
_RING[::2, ::2] = -1 / 8
_RING[2, 2] = 1


def note_noise(chain: FrameChain, sample: Sequence[Bands]) -> Iterator[Note]:
    """Noise of the ratio that is too low for the cameras.

    Parameters
    ----------
    chain : FrameChain
    sample : sequence of tuple of AlignedFrames
        Parts of a few frame pairs.

    Yields
    ------
    Note
    """
    found = measure_noise(chain, sample)
    if found < _LEAST:
        yield warn(
            "counts",
            f"errors are wrong, and films may be: the counts have {found:.2f} of the noise that "
            "gain and read noise leave. Counts were halved, averaged or smoothed after the "
            "recording, or the gain is that of other settings. Export the raw counts",
        )


def measure_noise(chain: FrameChain, sample: Sequence[Bands]) -> float:
    """Noise of the ratio from pixel to pixel over that which gain and read noise give.

    Parameters
    ----------
    chain, sample
        As for `note_noise`.

    Returns
    -------
    float
        NaN where too few pixels are valid. [1]
    """
    parts = []
    for band in (band for bands in sample for band in bands):
        ratios = chain.divide(band)
        flagged = ratios.flags.values[0] != 0
        values = np.where(flagged, 0, ratios.log_ratio.values[0]).astype(np.float32)
        rest = cv2.filter2D(values, -1, _RING)

        # the mean of eight has an eighth of the variance of one
        std = np.sqrt(float((_RING**2).sum()) * ratios.log_ratio_var.values[0])
        sound = cv2.dilate(flagged.astype(np.uint8), np.ones_like(_RING, np.uint8)) == 0
        parts.append((rest[sound] / std[sound]).astype(np.float32))
    found = np.concatenate(parts) if parts else np.array([])
    return robust_rms(found) if found.size >= _FEWEST else float("nan")
