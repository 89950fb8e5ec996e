"""Raw frames with their format in a file beside them."""

import re

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_genicam
from scenes.reading import read, refusal, times_of


def test_a_header_of_the_recorder_is_skipped_and_the_rate_gives_times(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    path = write_genicam(
        tmp_path / "a.raw", frames, "Mono12", header=bytes(100), header_bytes=100, frame_rate=250
    )
    npt.assert_array_equal(read(path), frames)
    npt.assert_allclose(times_of(path), [0, 0.004, 0.008])


def test_a_missing_description_is_asked_for(tmp_path):
    message = refusal(tmp_path / "a.raw", bytes(100))
    assert re.search(r'Put a\.toml beside them, with width = 1280, .*"\.$', message)


@pytest.mark.parametrize("text", ["[1, 2]", "[" * 100_000, '{"width": ', "\xff"])
def test_a_damaged_json_file_is_refused(tmp_path, text):
    (tmp_path / "a.json").write_bytes(text.encode("latin-1"))
    assert "a.json cannot be read" in refusal(tmp_path / "a.raw", bytes(100))


@pytest.mark.parametrize(
    ("form", "words"),
    [
        ("BayerRG12", "the recording is of a colour camera"),
        ("BayerGB12Packed", "the recording is of a colour camera"),
        ("RGB8", "the recording is of a colour camera"),
        ("Mono12P", "pixel_format is 'Mono12P'. Expected Mono8 to Mono16, or Mono10 and Mono12"),
    ],
)
def test_other_pixel_formats_are_refused_by_name(tmp_path, form, words):
    (tmp_path / "a.toml").write_text(f'width = 8\nheight = 8\npixel_format = "{form}"\n')
    assert words in refusal(tmp_path / "a.raw", bytes(128))
