"""The interface of a reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from erlif.readers import Format, FrameFile, FrameKind


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
