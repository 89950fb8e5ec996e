"""AVI films laid out after the description of RIFF."""

from contextlib import closing

import numpy as np
import pytest
from scenes.camera_files import RAMP, avi_film, avi_rows, chunk, chunks
from scenes.reading import read, refusal

from erlif.io.readers import open_frames

COUNTS = np.random.default_rng(5).integers(0, 256, (3, 64, 81), dtype=np.uint8)


ROWS = [avi_rows(image) for image in COUNTS]


def test_uncompressed_grey_frames_are_read_with_a_warning(tmp_path):
    np.testing.assert_array_equal(read(tmp_path / "a.avi", avi_film(ROWS)), COUNTS)
    with closing(open_frames(tmp_path / "a.avi")) as file:
        np.testing.assert_allclose(file.times, [0, 0.002, 0.004])
        assert "8 bits" in file.warning
        assert file.bits == 8


@pytest.mark.parametrize("codec", [b"Y800", b"GREY"])
def test_grey_codecs_have_their_rows_from_the_top(tmp_path, codec):
    content = avi_film([image.tobytes() for image in COUNTS], codec=codec)
    np.testing.assert_array_equal(read(tmp_path / "a.avi", content), COUNTS)


def test_a_long_film_has_several_lists(tmp_path):
    """OpenDML: further parts of the film follow as RIFF of the kind AVIX."""
    more = chunks(b"RIFF", b"AVIX", chunks(b"LIST", b"movi", chunk(b"00db", ROWS[2])))
    np.testing.assert_array_equal(read(tmp_path / "a.avi", avi_film(ROWS[:2]) + more), COUNTS)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (avi_film(ROWS, codec=b"MJPG"), "compressed or in colours (MJPG), and no counts"),
        (avi_film(ROWS, bits=24), "compressed or in colours (24 bits)"),
        (avi_film(ROWS, palette=RAMP[::-1]), "palette image"),
        # a chunk of length 0 repeats the frame before it, and such frames have no pulse
        (avi_film([ROWS[0], b"", ROWS[2]]), "1 of its 3 frames are empty"),
        (chunks(b"RIFF", b"AVI "), "no stream of images"),
        (avi_film([]) + bytes(9000), "names 0 frames"),
        # zeros are empty chunks; each of the million was read
        (b"RIFF\xff\xff\xff\xffAVI " + bytes(4_000_000), "hardly any of its chunks is a frame"),
    ],
)
def test_other_films_are_refused(tmp_path, content, reason):
    assert reason in refusal(tmp_path / "a.avi", content)
