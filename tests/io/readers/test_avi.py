"""AVI films laid out after the description of RIFF."""

from __future__ import annotations

import numpy as np
import pytest
from scenes.camera_files import RAMP, avi_film, avi_rows, chunk, chunks
from scenes.reading import refusal

from erlif.io.readers import open_frames

COUNTS = np.random.default_rng(5).integers(0, 256, (3, 64, 81), dtype=np.uint8)


def read(path, content):
    path.write_bytes(content)
    file = open_frames(path)
    try:
        return np.stack([file.read(index) for index in range(len(file.kinds))]), file
    finally:
        file.close()


def test_uncompressed_grey_frames_are_read_with_a_warning(tmp_path):
    found, file = read(tmp_path / "a.avi", avi_film([avi_rows(image) for image in COUNTS]))
    np.testing.assert_array_equal(found, COUNTS)
    np.testing.assert_allclose(file.times, [0, 0.002, 0.004])
    assert "8 bits" in file.warning
    assert file.bits == 8


@pytest.mark.parametrize("codec", [b"Y800", b"GREY"])
def test_grey_codecs_have_their_rows_from_the_top(tmp_path, codec):
    frames = [image.tobytes() for image in COUNTS]
    found, _ = read(tmp_path / "a.avi", avi_film(frames, codec=codec))
    np.testing.assert_array_equal(found, COUNTS)


def test_a_long_film_has_several_lists(tmp_path):
    """OpenDML: further parts of the film follow as RIFF of the kind AVIX."""
    more = chunks(b"RIFF", b"AVIX", chunks(b"LIST", b"movi", chunk(b"00db", avi_rows(COUNTS[2]))))
    found, _ = read(tmp_path / "a.avi", avi_film([avi_rows(image) for image in COUNTS[:2]]) + more)
    np.testing.assert_array_equal(found, COUNTS)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"codec": b"MJPG"}, "compressed or in colours (MJPG), and no counts"),
        ({"bits": 24}, "compressed or in colours (24 bits)"),
        ({"palette": RAMP[::-1]}, "palette image"),
    ],
)
def test_other_films_are_refused(tmp_path, options, reason):
    frames = [avi_rows(image) for image in COUNTS]
    assert reason in refusal(tmp_path / "a.avi", avi_film(frames, **options))


def test_a_frame_that_the_camera_lost_is_refused(tmp_path):
    """A chunk of length 0 repeats the frame before it; such frames have no pulse."""
    frames = [avi_rows(COUNTS[0]), b"", avi_rows(COUNTS[2])]
    assert "1 of its 3 frames are empty" in refusal(tmp_path / "a.avi", avi_film(frames))


def test_a_film_without_images_is_refused(tmp_path):
    assert "no stream of images" in refusal(tmp_path / "a.avi", chunks(b"RIFF", b"AVI "))
    assert "names 0 frames" in refusal(tmp_path / "a.avi", avi_film([]) + bytes(9000))


def test_a_file_of_zeros_behind_its_first_bytes_is_refused_early(tmp_path):
    """Zeros are empty chunks; each of the million was read."""
    reason = refusal(tmp_path / "a.avi", b"RIFF\xff\xff\xff\xffAVI " + bytes(4_000_000))
    assert "hardly any of its chunks is a frame" in reason
