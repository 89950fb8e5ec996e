"""Raw frames with their format in a file beside them."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_genicam

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.genicam import open_raw


def test_a_header_of_the_recorder_is_skipped_and_the_rate_gives_times(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    path = write_genicam(
        tmp_path / "a.raw", frames, "Mono12", header=bytes(100), header_bytes=100, frame_rate=250
    )
    file = open_raw(path)
    npt.assert_array_equal(file.read(2), frames[2])
    npt.assert_allclose(file.times, [0, 0.004, 0.008])
    file.close()


def test_a_missing_description_is_asked_for(tmp_path):
    (tmp_path / "a.raw").write_bytes(bytes(100))
    with pytest.raises(FrameError, match=r'Put a\.toml beside them, with width = 1280, .*"\.$'):
        open_frames(tmp_path / "a.raw")


@pytest.mark.parametrize("text", ["[1, 2]", "[" * 100_000, '{"width": ', "\xff"])
def test_a_damaged_json_file_is_refused(tmp_path, text):
    (tmp_path / "a.raw").write_bytes(bytes(100))
    (tmp_path / "a.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(FrameError, match=r"a\.json cannot be read"):
        open_raw(tmp_path / "a.raw")
