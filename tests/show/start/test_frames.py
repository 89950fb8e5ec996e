"""Images as they are read, while settings have gaps."""

import numpy as np
import pytest
import tifffile

from erlif.core.errors import FrameError
from erlif.show.start.frames import FrameSource


@pytest.fixture
def folder(tmp_path):
    """Three frames of 4 x 6 pixels of each camera, in one file of both, and a dark."""
    counts = np.arange(6 * 24, dtype=np.uint16).reshape(6, 4, 6)
    tifffile.imwrite(tmp_path / "both.tif", counts)
    tifffile.imwrite(tmp_path / "dark.tif", np.full((4, 6), 7, np.uint16))
    return tmp_path, counts


VALUES = {
    "camera1": {"files": "both.tif", "part": "odd", "dark": "dark.tif", "bit_depth": 10},
    "camera2": {"files": "both.tif", "part": "even"},
    "registration": {"orientation": "rotated_90"},
}


def test_images_are_those_of_the_readers_and_camera_2_is_turned(folder):
    directory, counts = folder
    source = FrameSource(directory)
    assert source.count(VALUES) == {"frames": [3, 3], "dark": [1, 0]}
    one, two = (source.read(VALUES, camera, "frames", 1) for camera in (1, 2))
    np.testing.assert_array_equal(one.counts, counts[2])
    np.testing.assert_array_equal(two.counts, np.rot90(counts[3]))
    assert (one.full_scale, two.full_scale) == (1023, 4095)
    assert one.title == "image 2 of 3, both.tif[2] of camera 1"
    assert source.read(VALUES, 1, "dark", 0).counts.max() == 7


def test_what_cannot_be_shown_is_named(folder, tmp_path):
    directory, _ = folder
    (directory / "cut.tif").write_bytes(b"II*\0")
    source = FrameSource(directory)
    for values, message in (
        ({}, "name of the frames images of camera 1"),
        ({"camera1": {"files": "none*.tif"}}, "there is none"),
        ({"camera1": {"files": "../*.tif"}}, "leaves the directory"),
        ({"camera1": {"files": "cut.tif"}}, "cut.tif"),
    ):
        with pytest.raises(FrameError, match=message):
            source.read(values, 1, "frames", 0)
    with pytest.raises(FrameError, match="from 1 to 3"):
        source.read(VALUES, 1, "frames", 3)
