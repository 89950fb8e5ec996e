"""Raw frames with their format in a file beside them."""

from __future__ import annotations

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_genicam

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.base import TRUNCATED
from erlif.io.readers.genicam import open_raw


@pytest.mark.parametrize(
    ("pixel_format", "bits"),
    [
        ("Mono8", 8),
        ("Mono10", 10),
        ("Mono12", 12),
        ("Mono14", 14),
        ("Mono16", 16),
        ("Mono10p", 10),
        ("Mono12p", 12),
        ("Mono10Packed", 10),
        ("Mono12Packed", 12),
        ("Mono10pmsb", 10),
        ("Mono12pmsb", 12),
    ],
)
@pytest.mark.parametrize("sidecar", ["toml", "json"])
def test_known_counts(tmp_path, pixel_format, bits, sidecar):
    frames = random_frames(np.random.default_rng(bits), bits=bits)
    path = write_genicam(tmp_path / "a.raw", frames, pixel_format, sidecar=sidecar)
    file = open_frames(path)
    npt.assert_array_equal([file.read(k) for k in range(3)], frames)
    assert file.bits == bits
    assert file.times is None
    assert [companion.name for companion in file.companions] == [f"a.{sidecar}"]
    file.close()


def test_a_header_of_the_recorder_is_skipped_and_the_rate_gives_times(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    path = write_genicam(
        tmp_path / "a.raw", frames, "Mono12", header=bytes(100), header_bytes=100, frame_rate=250
    )
    file = open_raw(path)
    npt.assert_array_equal(file.read(2), frames[2])
    npt.assert_allclose(file.times, [0, 0.004, 0.008])
    file.close()


def test_an_incomplete_last_frame_is_truncated(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    path = write_genicam(tmp_path / "a.raw", frames, "Mono12p")
    path.write_bytes(path.read_bytes()[:-1])
    file = open_raw(path)
    assert [kind == TRUNCATED for kind in file.kinds] == [False, False, True]
    file.close()


def test_a_missing_description_is_asked_for(tmp_path):
    (tmp_path / "a.raw").write_bytes(bytes(100))
    with pytest.raises(FrameError, match=r'Put a\.toml beside them, with width = 1280, .*"\.$'):
        open_frames(tmp_path / "a.raw")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("width = 8", "width = 7", "a.toml describes 3 frames of 63 bytes"),
        ("width = 8", "width = 8.0", "has width = 8.0; expected a whole number"),
        ("width = 8", "width = true", "has width = True; expected a whole number"),
        ("width = 8", "width = -8", "has width = -8; expected a whole number"),
        ("width = 8", "widht = 8", "unknown key 'widht'. Did you mean width?"),
        ("width = 8", "", "has no width; expected a whole number"),
        ("width = 8", "width = 0", "holds no image"),
        ("width = 8", "width =", "a.toml cannot be read"),
        ("frames = 3", "frames = 1000000000", "header names 1000000000 frames"),
        ("frames = 3", "frames = 2", "a.toml describes 2 frames of 72 bytes"),
        ('"Mono12p"', '"BayerRG12p"', "has the pixel_format 'BayerRG12p'. Read are Mono8,"),
        ('"Mono12p"', "12", "has the pixel_format 12. Read are"),
        ("frame_rate = 100", "frame_rate = 0", "has frame_rate = 0; expected a number of Hz"),
        ("frame_rate = 100", "frame_rate = " + "9" * 400, "has frame_rate = 999"),
        ("frame_rate = 100", "frame_rate = 1e-320", "has frame_rate = 1e-320"),
        ("frame_rate = 100", "frame_rate = nan", "has frame_rate = nan; expected a number"),
    ],
)
def test_a_wrong_description_is_refused(tmp_path, old, new, words):
    frames = random_frames(np.random.default_rng(1))
    path = write_genicam(tmp_path / "a.raw", frames, "Mono12p", frames=3, frame_rate=100)
    text = path.with_suffix(".toml").read_text()
    assert old in text
    path.with_suffix(".toml").write_text(text.replace(old, new))
    with pytest.raises(FrameError, match=words):
        open_raw(path)


@pytest.mark.parametrize("text", ["[1, 2]", "[" * 100_000, '{"width": ', "\xff"])
def test_a_damaged_json_file_is_refused(tmp_path, text):
    (tmp_path / "a.raw").write_bytes(bytes(100))
    (tmp_path / "a.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(FrameError, match=r"a\.json (cannot be read|holds no keys)"):
        open_raw(tmp_path / "a.raw")
