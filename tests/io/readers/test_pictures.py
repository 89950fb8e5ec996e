"""Pictures against Pillow and OpenCV, which wrote them, and against their specifications."""

import io
import struct
import time
import zlib

import cv2
import numpy as np
import pytest
from PIL import Image
from scenes.reading import read, refusal

from erlif.io.readers import open_frames

GREY = np.random.default_rng(5).integers(0, 65536, (64, 81), dtype=np.uint16)
SMALL = (GREY >> 8).astype(np.uint8)


def test_rows_of_a_bmp_may_be_stored_from_the_top(tmp_path):
    """A negative height (BITMAPINFOHEADER)."""
    Image.fromarray(SMALL).save(tmp_path / "a.bmp")
    content = bytearray((tmp_path / "a.bmp").read_bytes())
    struct.pack_into("<i", content, 22, -64)
    (tmp_path / "a.bmp").write_bytes(content)
    np.testing.assert_array_equal(read(tmp_path / "a.bmp"), SMALL[None, ::-1])


def test_pgm_files_may_have_comments_and_several_pictures(tmp_path):
    head = b"P5\n# camera 3\n81 64 # width and height\n4095\n"
    counts = GREY >> 4
    content = b"".join(head + image.astype(">u2").tobytes() for image in (counts, counts[::-1]))
    (tmp_path / "a.pgm").write_bytes(content)
    np.testing.assert_array_equal(read(tmp_path / "a.pgm"), [counts, counts[::-1]])
    file = open_frames(tmp_path / "a.pgm")
    assert file.bits == 12
    file.close()
    (tmp_path / "a.pgm").write_bytes(content + b"more")
    assert "goes on behind its last count" in refusal(tmp_path / "a.pgm")


@pytest.mark.parametrize("suffix", [".jpg", ".gif", ".webp", ".jp2"])
def test_a_format_that_changes_the_counts_is_refused(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    if suffix == ".jp2":
        assert cv2.imwrite(str(path), SMALL)
    else:
        Image.fromarray(SMALL).save(path)
    assert "no counts. Save the raw counts as TIFF." in refusal(path)
    path.rename(tmp_path / "a.dat")  # recognised by its content as well
    assert "no counts. Save the raw counts as TIFF." in refusal(tmp_path / "a.dat")


def test_a_changed_or_missing_chunk_of_a_png_is_refused(tmp_path):
    file = io.BytesIO()
    Image.fromarray(GREY).save(file, "PNG")
    content = bytearray(file.getvalue())
    path = tmp_path / "a.png"

    # the pixels with another, well-formed content and the old checksum
    start = content.index(b"IDAT")
    (length,) = struct.unpack_from(">I", content, start - 4)
    other = zlib.compress(bytes(64 * (2 * 81 + 1)))
    changed = content[: start - 4] + struct.pack(">I", len(other)) + b"IDAT" + other
    path.write_bytes(changed + content[start + 4 + length :])
    assert "the picture is damaged" in refusal(path)
    path.write_bytes(content[: start + 99])
    assert "the picture is damaged" in refusal(path)


def test_a_pgm_of_text_and_blanks_without_a_number_are_refused_at_once(tmp_path):
    """Each further blank had doubled the time: 26 took seconds, a thousand had no end."""
    path = tmp_path / "a.pgm"
    assert "binary PGM" in refusal(path, b"P2 2 2 255 1 2 3 4")
    path.write_bytes(b"P5" + b" " * 26 + b"x" + bytes(100))
    start = time.perf_counter()
    assert "not a PGM" in refusal(path)
    assert time.perf_counter() - start < 1.0


def test_a_png_of_a_gigabyte_for_few_pixels_is_refused_when_it_is_opened(tmp_path):
    path = tmp_path / "a.png"
    assert cv2.imwrite(str(path), GREY)
    with path.open("ab") as file:
        file.truncate(2**30)
    assert "1073741824 bytes are too many for its 81 x 64 uint16" in refusal(path)


@pytest.mark.parametrize(
    ("suffix", "counts"),
    [(".png", SMALL), (".png", GREY), (".pgm", SMALL), (".pgm", GREY), (".bmp", SMALL)],
)
def test_grey_counts_are_read_as_opencv_has_written_them(tmp_path, suffix, counts):
    path = tmp_path / f"a{suffix}"
    assert cv2.imwrite(str(path), counts)
    found = read(path)
    assert found.dtype == counts.dtype
    np.testing.assert_array_equal(found, counts[None])


@pytest.mark.parametrize(
    ("suffix", "mode", "words"),
    [
        (".png", "P", "palette image, whose values are no counts. Save"),
        (".bmp", "P", "palette image, whose values are no counts. Save"),
        *((".png", mode, "colour") for mode in ("RGB", "RGBA", "LA")),
        *((".bmp", mode, "colour") for mode in ("RGB", "RGBA")),
        (".png", "1", "it has 1 bits for each pixel. Save 8 or 16-bit counts."),
    ],
)
def test_values_that_are_no_counts_are_refused(tmp_path, suffix, mode, words):
    image = Image.fromarray(SMALL)
    image = image.convert("RGB").quantize(64) if mode == "P" else image.convert(mode)
    image.save(tmp_path / f"a{suffix}")
    assert words in refusal(tmp_path / f"a{suffix}")
