"""Parts of a file against slices of the array it holds."""

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.ingest.selection import WHOLE, Selection, may_share_files, select_counts
from erlif.io.readers import FrameFile, FrameKind
from erlif.io.settings import CameraSettings

CORNERS = {
    "left": (slice(None), slice(0, 3)),
    "right": (slice(None), slice(4, 7)),
    "top": (slice(0, 2), slice(None)),
    "bottom": (slice(3, 5), slice(None)),
}


class Five(FrameFile):
    """Five frames that alternate between two channels, beginning with the second."""

    kinds = (FrameKind((5, 7), "uint16"),) * 5
    channels = (2, 1, 2, 1, 2)

    def read(self, index):
        return np.arange(35, dtype=np.uint16).reshape(5, 7)


class Plain(Five):
    """The same without channels."""

    channels = None


@pytest.mark.parametrize("part", CORNERS)
def test_halves_leave_out_the_middle_of_an_odd_number(part):
    image = Five().read(0)
    found = Selection(part).crop(image)
    np.testing.assert_array_equal(found, image[CORNERS[part]])
    assert Selection(part).crop_shape((5, 7)) == found.shape
    assert Selection(part).crop_shape((5, 7, 3)) == (*found.shape, 3)
    assert list(Selection(part).pages(Five())) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize(
    ("part", "frames"),
    [("", [0, 1, 2, 3, 4]), ("odd", [0, 2, 4]), ("even", [1, 3]), ("channel 1", [1, 3])],
)
def test_the_first_page_is_odd_and_channels_count_from_one(part, frames):
    assert list(Selection(part).pages(Five())) == frames
    assert Selection(part).crop_shape((5, 7)) == (5, 7)


def test_a_part_that_a_file_does_not_have_is_refused():
    with pytest.raises(FrameError, match=r"no channels.*use part = \"odd\""):
        Selection("channel 1").pages(Plain())
    with pytest.raises(FrameError, match="no frame that belongs"):
        Selection("channel 3").pages(Five())


@pytest.mark.parametrize(
    ("one", "two", "may"),
    [
        *(("left", "right", True), ("bottom", "top", True), ("channel 2", "channel 1", True)),
        *(("channel 1", "channel 3", True), ("channel 3", "channel 3", False)),
        *(("left", "left", False), ("left", "", False), ("", "", False), ("odd", "left", False)),
    ],
)
def test_parts_that_exclude_one_another_may_share_a_file(one, two, may):
    assert may_share_files(Selection(one), Selection(two)) is may
    assert may_share_files(Selection(two), Selection(one)) is may


def test_different_datasets_may_share_a_file():
    assert may_share_files(Selection(dataset="/one"), Selection(dataset="/two"))
    assert not may_share_files(Selection(dataset="/one"), Selection(dataset="/one"))


def test_darks_and_flats_have_the_part_and_alignment_of_the_frames():
    camera = CameraSettings(
        files="a.h5",
        band="580 nm",
        bit_depth=10,
        offset="0 DN",
        part="top",
        alignment="left",
        dataset="/frames",
        flat_dataset="/flat",
    )
    assert select_counts(camera) == Selection("top", "/frames", 6)
    assert select_counts(camera, "dark") == Selection("top", "/frames", 6)
    assert select_counts(camera, "flat") == Selection("top", "/flat", 6)
    plain = CameraSettings(files="a.tif", band="580 nm", offset="0 DN")
    assert select_counts(plain) == WHOLE
