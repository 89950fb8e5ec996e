"""Plain TIFF pages against tifffile, which wrote them; whatever is not plain is left alone."""

import struct
import tracemalloc
import zlib

import numpy as np
import pytest
import tifffile

from erlif.io.readers.plain_tiff import decode_plain_page, find_plain_pages, read_plain_page

GREY = np.random.default_rng(5).integers(0, 4096, (64, 80), dtype=np.uint16)

PLAIN = {
    "as it is": {},
    "strips": {"rowsperstrip": 10},
    "one strip": {"rowsperstrip": 64},
    "deflate": {"compression": "deflate"},
    "deflated strips": {"compression": "deflate", "rowsperstrip": 10},
    "differences": {"compression": "deflate", "predictor": True, "rowsperstrip": 10},
    "big": {"bigtiff": True},
    "big strips": {"bigtiff": True, "compression": "deflate", "rowsperstrip": 10},
    "described": {"description": "pulse 12", "software": "camera", "datetime": True},
    "resolution": {"resolution": (300, 300), "resolutionunit": "INCH"},
    "inverted scale": {"photometric": "miniswhite"},
}


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("options", PLAIN.values(), ids=PLAIN)
def test_a_plain_page_is_read_as_it_was_written(tmp_path, options, dtype):
    image = GREY.astype(dtype)
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, image, **options)
    (page,) = find_plain_pages(path)
    assert (page.shape, page.dtype) == (image.shape, image.dtype.name)
    for found in (
        read_plain_page(path, page.header),
        decode_plain_page(path.read_bytes(), page.header),
    ):
        assert found.dtype == dtype
        assert found.flags.writeable
        assert found.flags.aligned
        np.testing.assert_array_equal(found, image)


@pytest.mark.parametrize("options", PLAIN.values(), ids=PLAIN)
def test_pages_of_a_stack_are_found_by_their_own_place(tmp_path, options):
    images = [GREY, GREY[::-1], GREY[:, ::-1]]
    path = tmp_path / "a.tif"
    with tifffile.TiffWriter(path, bigtiff=options.get("bigtiff", False)) as file:
        for image in images:
            file.write(
                image, **{name: value for name, value in options.items() if name != "bigtiff"}
            )
    pages = find_plain_pages(path)
    assert len(pages) == 3
    for page, image in reversed(list(zip(pages, images, strict=True))):
        np.testing.assert_array_equal(read_plain_page(path, page.header), image)


def test_strips_may_lie_in_any_order(tmp_path):
    """TIFF 6.0 allows it; the strips of this file are written from the last to the first."""
    strips = [GREY[first : first + 16].tobytes() for first in range(0, 64, 16)]
    places = [8 + 16 * 160 * n for n in (3, 2, 1, 0)]
    tags = [
        *((256, 3, 1, 80), (257, 3, 1, 64), (258, 3, 1, 16), (259, 3, 1, 1), (262, 3, 1, 1)),
        *((273, 4, 4, 8 + 64 * 160), (277, 3, 1, 1), (278, 3, 1, 16)),
        (279, 4, 4, 8 + 64 * 160 + 16),
    ]
    arrays = struct.pack("<4I", *places) + struct.pack("<4I", *(len(one) for one in strips))
    directory = struct.pack("<H", len(tags))
    directory += b"".join(struct.pack("<HHII", *tag) for tag in tags) + bytes(4)
    start = 8 + 64 * 160 + len(arrays)
    path = tmp_path / "a.tif"
    path.write_bytes(
        b"II*\0" + struct.pack("<I", start) + b"".join(strips[::-1]) + arrays + directory
    )
    np.testing.assert_array_equal(tifffile.imread(path), GREY)
    (page,) = find_plain_pages(path)
    np.testing.assert_array_equal(read_plain_page(path, page.header), GREY)


NOT_PLAIN = {
    "big endian": (GREY, {"byteorder": ">"}),
    "float": (GREY.astype(np.float32), {}),
    "signed": (GREY.astype(np.int16), {}),
    "32 bits": (GREY.astype(np.uint32), {}),
    "colours": (np.zeros((64, 80, 3), np.uint8), {"photometric": "rgb"}),
    "tiles": (GREY, {"tile": (16, 16)}),
    "single row": (GREY[:1], {}),
    "with an extra tag": (GREY, {"extratags": [(65000, 3, 1, 7, True)]}),
}


@pytest.mark.parametrize(("image", "options"), NOT_PLAIN.values(), ids=NOT_PLAIN)
def test_other_pages_are_left_to_tifffile(tmp_path, image, options):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, image, **options)
    assert find_plain_pages(path) is None


@pytest.mark.parametrize(
    "content", [b"", b"II", b"II*\0", b"II*\0" + bytes(4), b"MM\0*" + bytes(9)]
)
def test_a_file_that_is_no_tiff_is_left_to_tifffile(tmp_path, content):
    (tmp_path / "a.tif").write_bytes(content)
    assert find_plain_pages(tmp_path / "a.tif") is None


def test_a_chain_of_directories_that_bites_its_tail_is_left_to_tifffile(tmp_path):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY)
    content = bytearray(path.read_bytes())
    (start,) = struct.unpack_from("<I", content, 4)
    (entries,) = struct.unpack_from("<H", content, start)
    struct.pack_into("<I", content, start + 2 + 12 * entries, start)
    path.write_bytes(content)
    assert find_plain_pages(path) is None


def test_a_strip_whose_checksum_is_wrong_is_not_accepted(tmp_path):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY, compression="deflate", rowsperstrip=64)
    (page,) = find_plain_pages(path)
    content = bytearray(path.read_bytes())
    content[page.offsets[0] + page.lengths[0] - 1] ^= 1
    with pytest.raises(zlib.error):
        zlib.decompress(content[page.offsets[0] :][: page.lengths[0]])
    assert decode_plain_page(bytes(content), page.header) is None


def expected(path):
    """What tifffile reads of the first page, None where it fails."""
    try:
        return tifffile.imread(path, key=0)
    except Exception:  # it raises exceptions of many types on damaged bytes
        return None


@pytest.mark.parametrize("options", [{}, {"compression": "deflate"}], ids=["as it is", "deflate"])
def test_no_damaged_byte_gives_counts_that_tifffile_does_not_give(tmp_path, options):
    path, damaged = tmp_path / "a.tif", tmp_path / "b.tif"
    tifffile.imwrite(path, GREY[:6, :8], rowsperstrip=4, metadata=None, **options)
    whole = path.read_bytes()
    (page,) = find_plain_pages(path)
    rng = np.random.default_rng(6)
    for place in range(len(whole)):
        content = bytearray(whole)
        content[place] ^= int(rng.integers(1, 256))
        damaged.write_bytes(content)
        for header in {page.header, *(one.header for one in find_plain_pages(damaged) or ())}:
            found = decode_plain_page(bytes(content), header)
            if found is not None and find_plain_pages(damaged) is not None:
                np.testing.assert_array_equal(found, expected(damaged))


@pytest.mark.parametrize("options", [{}, {"compression": "deflate"}], ids=["as it is", "deflate"])
def test_a_page_that_is_cut_off_is_not_accepted(tmp_path, options):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY[:6, :8], rowsperstrip=4, metadata=None, **options)
    whole = path.read_bytes()
    (page,) = find_plain_pages(path)
    end = page.offsets[-1] + page.lengths[-1]
    for size in range(end):
        path.write_bytes(whole[:size])
        assert find_plain_pages(path) is None
        assert decode_plain_page(whole[:size], page.header) is None
        assert read_plain_page(path, page.header) is None


def test_a_strip_takes_no_more_memory_than_the_header_states(tmp_path):
    """A file of 30 kB expanded to 30 MB before its length was compared."""
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY, compression="deflate", rowsperstrip=64)
    (page,) = find_plain_pages(path)
    bomb = zlib.compress(bytes(30_000_000))
    data = bytearray(path.read_bytes())
    place = data.index(struct.pack("<HHII", 279, 4, 1, page.lengths[0]), page.header)
    data[place + 8 : place + 12] = struct.pack("<I", len(bomb))
    data[page.offsets[0] :] = bomb
    tracemalloc.start()
    assert decode_plain_page(bytes(data), page.header) is None
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000
