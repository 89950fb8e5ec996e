"""The maps of a report, read as the viewer of the page reads them."""

from __future__ import annotations

import base64
import zlib
from typing import NamedTuple

import numpy as np

from erlif.show.report.maps import block_shape, describe_coding


class DecodedMap(NamedTuple):
    """Thickness and prediction (row, column), standard deviations of blocks [um]; NaN without."""

    thickness: np.ndarray
    flags: np.ndarray
    std: np.ndarray
    std_shared: np.ndarray
    predicted: np.ndarray | None


def decode_map(text, *, shape, coding):
    """Read the text of `erlif.show.report.maps.embed_map`; `shape` is that of the kept pixels."""
    constants = describe_coding(coding)
    data = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8)
    pixels, blocks = shape[0] * shape[1], block_shape(shape)
    end = 4 * pixels + 2 * blocks[0] * blocks[1]

    high, low, more, few = data[: 4 * pixels].reshape(4, *shape).astype(float)
    flags = 256 * more + few
    thickness = np.where(flags == 0, (high * 256 + low) * coding.step, np.nan)
    codes = data[4 * pixels : end].reshape(2, *blocks).astype(float)
    std = constants["leastStd"] * 2 ** ((codes - 1) / constants["perOctave"])
    std = np.where(codes > 0, std, np.nan)
    if data.size == end:
        return DecodedMap(thickness, flags, *std, None)

    high, low = data[end:].reshape(2, *shape).astype(float)
    counts = high * 256 + low
    predicted = np.where(counts < constants["fullScale"], counts * coding.step, np.nan)
    return DecodedMap(thickness, flags, *std, predicted)
