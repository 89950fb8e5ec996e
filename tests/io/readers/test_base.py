"""The interface of a reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.readers import Format, FrameFile, FrameKind
from erlif.io.readers.base import check_claim


class OneRamp(FrameFile):
    """A file with a single frame, whose counts are their column."""

    kinds = (FrameKind((2, 3), "uint16"),)

    def read(self, index):
        return np.tile(np.arange(3, dtype=np.uint16), (2, 1))


def test_a_reader_without_read_cannot_be_opened():
    class Empty(FrameFile):
        """Lacks `read`."""

    with pytest.raises(TypeError, match="read"):
        Empty()


def test_a_third_party_needs_a_class_and_a_format():
    ramp = Format(
        "ramp", (".ramp",), lambda path, head: head[:4] == b"RAMP", lambda path: OneRamp()
    )
    assert ramp.recognise(Path("a.ramp"), b"RAMP1")
    assert not ramp.recognise(Path("a.ramp"), b"II*\0")
    file = ramp.open(Path("a.ramp"))
    assert file.read(0).shape == file.kinds[0].shape
    assert file.bits is None
    assert file.times is None


@pytest.mark.parametrize(
    ("frames", "shape", "packing"),
    [(10**9, (64, 80), 1e12), (1, (10**9, 10**9), 1), (3, (64, 80), 1), (3, (64, 80), 1.49)],
)
def test_a_header_that_claims_more_than_its_file_holds_is_refused(frames, shape, packing):
    with pytest.raises(FrameError, match="the file is damaged: 20480 bytes cannot hold"):
        check_claim(frames, FrameKind(shape, "uint16"), 20_480, packing=packing)
    check_claim(3, FrameKind((64, 80), "uint16"), 20_480, packing=1.5)


@pytest.mark.parametrize(("frames", "shape"), [(0, (64, 80)), (1, (0, 80)), (1, ())])
def test_a_header_without_frames_is_refused(frames, shape):
    with pytest.raises(FrameError, match="holds no image"):
        check_claim(frames, FrameKind(shape, "uint16"), 20_480)
