"""Frames of a file, read whole, and the message with which a file is refused."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames


def read(path: Path, content: bytes | None = None, *, dataset: str = "") -> np.ndarray:
    """All frames, from the last to the first, each of the kind that the header states."""
    if content is not None:
        path.write_bytes(content)
    with closing(open_frames(path, dataset=dataset)) as file:
        found = [file.read(index) for index in reversed(range(len(file.kinds)))]
        for image, kind in zip(found, reversed(file.kinds), strict=True):
            assert (image.shape, image.dtype.name) == kind
            assert image.dtype.isnative
    return np.stack(found[::-1])


def times_of(path: Path, *, dataset: str = "") -> np.ndarray | None:
    """Times of the frames; None where the file has none."""
    with closing(open_frames(path, dataset=dataset)) as file:
        return file.times


def refusal(path: Path, content: bytes | None = None, *, dataset: str = "") -> str:
    """The message."""
    with pytest.raises(FrameError) as refused:
        read(path, content, dataset=dataset)
    return str(refused.value)
