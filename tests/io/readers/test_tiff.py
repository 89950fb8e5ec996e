"""TIFF files against tifffile and libtiff, which wrote them."""

import struct
import time
import tracemalloc
import zlib
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import numpy as np
import pytest
import tifffile
from PIL import Image
from scenes.reading import read, refusal, times_of
from scenes.tiff_pages import write_encoded, write_stk

from erlif.core.errors import FrameError
from erlif.io.readers.base import TRUNCATED, FrameKind
from erlif.io.readers.tiff import TIFF

GREY = np.random.default_rng(5).integers(0, 4096, (3, 64, 80), dtype=np.uint16)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int16, np.float32])
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"bigtiff": True},
        {"byteorder": ">"},
        {"compression": "zlib"},
        {"compression": "zlib", "predictor": 2, "byteorder": ">"},
        {"tile": (16, 32)},
        {"tile": (48, 48), "compression": "zlib"},
        {"rowsperstrip": 7},
    ],
    ids=lambda options: " ".join(map(str, options.values())),
)
def test_each_page_of_a_stack_is_read_in_any_order(tmp_path, options, dtype):
    if dtype is np.float32:
        options = {name: value for name, value in options.items() if name != "predictor"}
    path = tmp_path / "a.bin"
    tifffile.imwrite(path, GREY.astype(dtype), photometric="minisblack", **options)
    assert TIFF.recognise(path, path.read_bytes()[:512])
    np.testing.assert_array_equal(read(path), GREY.astype(dtype))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("predictor", [1, 2])
@pytest.mark.parametrize(
    "compression", ["raw", "tiff_lzw", "packbits", "tiff_adobe_deflate", "tiff_deflate"]
)
def test_pages_of_libtiff_are_read(tmp_path, compression, predictor, dtype):
    images = [Image.fromarray(image.astype(dtype)) for image in GREY]
    images[0].save(
        tmp_path / "a.tif",
        save_all=True,
        append_images=images[1:],
        compression=compression,
        tiffinfo={317: predictor} if predictor > 1 and compression != "packbits" else {},
    )
    np.testing.assert_array_equal(read(tmp_path / "a.tif"), GREY.astype(dtype))


@pytest.mark.parametrize(
    "options",
    [
        {"compression": "lzw"},
        {"compression": "lzw", "predictor": 2, "byteorder": ">"},
        {"compression": "lzw", "tile": (32, 32)},
        {"compression": "packbits"},
        {"compression": "zstd"},
        *({"bitspersample": bits} for bits in (10, 12, 14)),
    ],
    ids=lambda options: " ".join(map(str, options.values())),
)
def test_pages_of_imagecodecs_are_read(tmp_path, options):
    counts = GREY >> 2 if options.get("bitspersample") == 10 else GREY
    write_encoded(tmp_path / "a.tif", counts, **options)
    np.testing.assert_array_equal(read(tmp_path / "a.tif"), counts)


def test_damaged_data_of_lzw_are_refused_without_a_word_of_libtiff(tmp_path, capfd):
    """Codes that the table of LZW does not have yet; GREY has 80 columns of 64 rows."""
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY[0], compression="lzw", photometric="minisblack", rowsperstrip=64)
    with tifffile.TiffFile(path) as file:
        (start,), (size,) = file.pages.first.dataoffsets, file.pages.first.databytecounts
    content = bytearray(path.read_bytes())
    content[start + 20 : start + size] = b"\xff" * (size - 20)
    path.write_bytes(content)
    with pytest.raises(FrameError, match="LZW data are damaged"):
        read(path)
    assert capfd.readouterr() == ("", "")


# ImageJ and OME


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("directories", [True, False], ids=["whole", "above 4 GB"])
def test_an_imagej_stack_is_read_with_and_without_its_directories(tmp_path, order, directories):
    """Above 4 GB ImageJ writes the first directory only; all images follow its own."""
    path = tmp_path / "a.tif"
    counts = np.random.default_rng(2).integers(0, 65536, (3, 2, 64, 80), dtype=np.uint16)
    metadata = {"axes": "TCYX", "finterval": 0.5}
    tifffile.imwrite(path, counts, imagej=True, byteorder=order, metadata=metadata)
    if not directories:
        content = bytearray(path.read_bytes())
        (start,) = struct.unpack_from(f"{order}I", content, 4)
        (entries,) = struct.unpack_from(f"{order}H", content, start)
        struct.pack_into(f"{order}I", content, start + 2 + 12 * entries, 0)
        path.write_bytes(content)

    np.testing.assert_array_equal(read(path), counts.reshape(-1, 64, 80))
    with closing(TIFF.open(path)) as file:
        assert list(file.channels) == [1, 2] * 3
        np.testing.assert_allclose(file.times, [0, 0, 0.5, 0.5, 1, 1])


@pytest.mark.parametrize("options", [{}, {"compression": "zlib"}, {"byteorder": ">"}])
def test_an_ome_file_has_channels_and_times(tmp_path, options):
    path = tmp_path / "a.ome.tif"
    counts = np.random.default_rng(2).integers(0, 4096, (2, 3, 64, 80), dtype=np.uint16)
    metadata = {"axes": "CTYX", "Plane": {"DeltaT": [1.0, 2, 4, 1, 2, 4]}}
    tifffile.imwrite(path, counts, ome=True, metadata=metadata, **options)
    np.testing.assert_array_equal(read(path), counts.reshape(-1, 64, 80))
    with closing(TIFF.open(path)) as file:
        assert list(file.channels) == [1, 1, 1, 2, 2, 2]
        np.testing.assert_allclose(file.times, [0, 1, 3, 0, 1, 3])


# images without a directory of their own, and directories of previews


@pytest.mark.parametrize("planes", [1, 2, 3])
@pytest.mark.parametrize("strips", [1, 2, 8])
@pytest.mark.parametrize("name", ["a.stk", "a.tif"])
def test_all_planes_of_metamorph_are_read(tmp_path, planes, strips, name):
    path = write_stk(tmp_path / name, GREY[:planes], strips=strips)
    with tifffile.TiffFile(path) as file:
        assert file.is_stk
    np.testing.assert_array_equal(read(path), GREY[:planes])


def test_times_of_metamorph_are_those_of_its_planes(tmp_path):
    np.testing.assert_allclose(times_of(write_stk(tmp_path / "a.stk", GREY)), [0, 0.02, 0.04])
    assert times_of(write_stk(tmp_path / "b.stk", GREY, step=0)) is None


def test_a_stack_of_tifffile_with_one_directory_is_read(tmp_path):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY, photometric="minisblack", truncate=True)
    np.testing.assert_array_equal(read(path), GREY)

    # versions before 2026.2 write the keys of the description in the other order
    content, shape, mark = path.read_bytes(), b'"shape": [3, 64, 80]', b'"truncated": true'
    (order,) = {b", ".join(pair) for pair in ((shape, mark), (mark, shape))} - {
        content[content.index(b"{") + 1 : content.index(b"}")]
    }
    start = content.index(b"{") + 1
    path.write_bytes(content[:start] + order + content[start + len(order) :])
    np.testing.assert_array_equal(read(path), GREY)
    path.write_bytes(content.replace(b"[3, 64, 80]", b"[9999999]  "))
    assert read(path).shape == (1, 64, 80)


def test_images_that_no_directory_shows_are_not_lost(tmp_path):
    """The description of ImageJ claims them, and a compressed image does not show where they lie.

    So it is with the planes of MetaMorph in a file with several directories.
    """
    text = "ImageJ=1.53t\nimages=3\nslices=3\n"
    tifffile.imwrite(tmp_path / "a.tif", GREY[0], description=text, compression="zlib")
    assert "it holds 3 images, and directories for 1. Save" in refusal(tmp_path / "a.tif")

    path = write_stk(tmp_path / "b.stk", GREY)
    content = bytearray(path.read_bytes())
    struct.pack_into("<I", content, 8 + 2 + 12 * 12, len(content))
    path.write_bytes(bytes(content) + content[8 : 8 + 2 + 12 * 12] + bytes(4))
    assert "it holds 3 images, and directories for 2. Save" in refusal(path)


@pytest.mark.parametrize("place", [0, 1, 3])
def test_previews_are_no_frames(tmp_path, place):
    path = tmp_path / "a.tif"
    images = [*GREY[:place], None, *GREY[place:]]
    with tifffile.TiffWriter(path) as file:
        for image in images:
            kind = {"subfiletype": int(image is None), "metadata": None, "contiguous": False}
            file.write(GREY[0, ::4, ::4] if image is None else image, **kind)
    np.testing.assert_array_equal(read(path), GREY)


@pytest.mark.parametrize("step", [2, 4, 8])
@pytest.mark.parametrize("place", [0, 1, 3])
def test_smaller_pages_without_a_mark_are_previews(tmp_path, place, step):
    small = GREY[0, ::step, ::step]
    images = [*GREY[:place], small, *GREY[place:]]
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for image in images:
            file.write(image, photometric="minisblack", metadata=None, contiguous=False)
    np.testing.assert_array_equal(read(tmp_path / "a.tif"), GREY)


def test_a_page_of_another_region_is_kept_to_be_refused(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for image in (*GREY, GREY[0, :60]):
            file.write(image, photometric="minisblack", metadata=None, contiguous=False)
    with closing(TIFF.open(tmp_path / "a.tif")) as opened:
        assert [kind.shape for kind in opened.kinds] == [*[(64, 80)] * 3, (60, 80)]


# what is no stack of counts


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_a_mark_of_inverted_counts_is_refused(tmp_path, dtype):
    """TIFF 6.0 has inverted counts there, ImageJ an inverted look-up table alone.

    tifffile returns both as they are stored.
    """
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY.astype(dtype), photometric="miniswhite", metadata=None)
    assert "marked as inverted (MINISWHITE)" in refusal(path)
    np.testing.assert_array_equal(tifffile.imread(path), GREY.astype(dtype))


@pytest.mark.parametrize("tags", [[(33421, 3, 2, (2, 2), True)], []], ids=["CFA", "photometric"])
def test_the_mosaic_of_a_colour_camera_is_refused(tmp_path, tags):
    path = tmp_path / "a.dng"
    photometric = "minisblack" if tags else "cfa"
    tifffile.imwrite(path, GREY[0], photometric=photometric, extratags=tags)
    assert "image is of a colour camera" in refusal(path)


def test_a_stack_is_not_taken_for_colours(tmp_path):
    """Frames of three columns have the shape of a colour image."""
    narrow = GREY[:, :, :3]
    tifffile.imwrite(tmp_path / "a.tif", narrow, photometric="minisblack")
    np.testing.assert_array_equal(read(tmp_path / "a.tif"), narrow)


@pytest.mark.parametrize("planar", ["contig", "separate"])
def test_colours_are_the_last_axis(tmp_path, planar):
    image = np.random.default_rng(1).integers(0, 255, (64, 80, 3), dtype=np.uint8)
    stored = image if planar == "contig" else np.moveaxis(image, 2, 0)
    tifffile.imwrite(tmp_path / "a.tif", stored, photometric="rgb", planarconfig=planar)
    np.testing.assert_array_equal(read(tmp_path / "a.tif"), image[None])


@pytest.mark.parametrize(
    ("mode", "options", "words"),
    [
        ("P", {}, "palette image, whose values are no counts. Save"),
        ("L", {"compression": "jpeg"}, "compressed with JPEG, which may change the counts. Save"),
    ],
)
def test_values_that_are_no_counts_are_refused(tmp_path, mode, options, words):
    Image.fromarray(GREY[0].astype(np.uint8)).convert(mode).save(tmp_path / "a.tif", **options)
    assert words in refusal(tmp_path / "a.tif")


@pytest.mark.parametrize(
    ("options", "tag", "first"),
    [({"tile": (16, 16)}, "TileOffsets", 0), ({}, "StripByteCounts", 9)],
)
def test_a_strip_without_place_or_too_short_is_truncated(tmp_path, options, tag, first):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY[0], **options)
    with tifffile.TiffFile(path, mode="r+") as file:
        entry = file.pages[0].tags[tag]
        rest = entry.value[1:] if isinstance(entry.value, tuple) else ()
        entry.overwrite([first, *rest] if rest else first)
    assert "truncated" in refusal(path)


def test_nothing_is_printed_about_a_damaged_file(tmp_path, capfd):
    (tmp_path / "a.tif").write_bytes(b"MM\0*" + struct.pack(">I", 9999))
    assert "holds no image" in refusal(tmp_path / "a.tif")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("options", [{}, {"tile": (16, 16)}], ids=["plain", "tiles"])
def test_threads_read_different_pages_at_once(tmp_path, options):
    tifffile.imwrite(tmp_path / "a.tif", GREY, photometric="minisblack", **options)
    with closing(TIFF.open(tmp_path / "a.tif")) as file, ThreadPoolExecutor(3) as threads:
        found = list(threads.map(file.read, [0, 1, 2] * 60))
    np.testing.assert_array_equal(found, np.tile(GREY, (60, 1, 1)))


# damages


@pytest.mark.parametrize("compression", [5, 8], ids=["LZW", "deflate"])
def test_a_tile_of_a_terabyte_is_refused(tmp_path, compression):
    entries = {256: 64, 257: 64, 258: 16, 259: compression, 262: 1, 277: 1}
    entries |= {322: 2**20, 323: 2**20, 324: 200, 325: 20}
    table = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in entries.items())
    head = b"II*\0" + struct.pack("<IH", 8, len(entries)) + table + bytes(4)
    path = tmp_path / "a.tif"
    content = head.ljust(200, b"\0") + bytes(20_000)
    assert "bytes cannot hold 1 frame of 1048576 x 1048576" in refusal(path, content)


@pytest.fixture
def deflated(tmp_path):
    """A deflated page in one strip, its directory in front, and where the strip lies."""
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY[0], compression="deflate", rowsperstrip=64)
    with tifffile.TiffFile(path) as file:
        page = file.pages[0]
        return path, page.offset, page.dataoffsets[0], page.databytecounts[0]


def test_a_strip_whose_checksum_is_wrong_is_not_accepted(deflated):
    path, _, start, length = deflated
    content = bytearray(path.read_bytes())
    content[start + length - 1] ^= 1
    path.write_bytes(content)
    assert "a strip of the image is damaged" in refusal(path)


def test_a_strip_takes_no_more_memory_than_the_header_states(deflated):
    """A file of 30 kB expanded to 30 MB before its length was compared."""
    path, directory, start, length = deflated
    bomb = zlib.compress(bytes(30_000_000))
    data = bytearray(path.read_bytes())
    place = data.index(struct.pack("<HHII", 279, 4, 1, length), directory)
    data[place + 8 : place + 12] = struct.pack("<I", len(bomb))
    data[start:] = bomb
    path.write_bytes(data)
    tracemalloc.start()
    assert "a strip of the image is damaged" in refusal(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000


def test_a_chain_that_was_cut_off_keeps_the_pages_before(tmp_path):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, np.zeros((3, 64, 80), np.uint16), photometric="minisblack")
    path.write_bytes(path.read_bytes()[:-50])
    assert 1 <= len(read(path)) < 3


def entries_of(entries: int, following: int, kind: int = 3, count: int = 1) -> bytes:
    """A directory of entries for a private tag, and the place of the next directory."""
    entry = struct.pack(">HHIHH", 65000, kind, count, 1, 0)
    return struct.pack(">H", entries) + entries * entry + struct.pack(">I", following)


HEAD = b"MM\0*" + struct.pack(">I", 8)

REFUSED = [
    (HEAD + entries_of(2, 8), "form a ring or overlap"),
    (HEAD + entries_of(5, 74) + entries_of(7, 8), "form a ring or overlap"),
    (HEAD + entries_of(60, 0, kind=99), "no list of entries"),
    (HEAD + entries_of(1, 0, count=10**9), "no list of entries"),
    # found at random: tifffile went round in a circle of broken directories behind it
    (HEAD + entries_of(2, 40) + bytes(2) + entries_of(1, 2)[:-4], "holds no image"),
    (b"", "empty"),
    (b"II*", "not a TIFF"),
    (b"PK\3\4 no TIFF", "not a TIFF"),
    (b"II+\0\x08\0\0\0", "truncated"),
]


def test_damaged_chains_and_other_files_are_refused(tmp_path):
    for content, reason in REFUSED:
        assert reason in refusal(tmp_path / "a.tif", content), content[:40]


def test_directories_through_the_pixels_are_refused_at_once(tmp_path):
    """Found at random: 65,535 entries in each directory took tifffile minutes and 11 GB."""
    words = np.full(200_000, 3, ">u2")  # any place is a directory of three entries
    words[1::7] = 0xFFFF
    (tmp_path / "a.tif").write_bytes(b"MM\0*" + struct.pack(">I", 10) + words.tobytes())
    start = time.perf_counter()
    refusal(tmp_path / "a.tif")
    assert time.perf_counter() - start < 1


# directories that are alike

MIXED = [
    (np.full((64, 80), 7, np.uint16), {}),
    (np.full((64, 80), 7, np.uint8), {}),
    (np.full((64, 96), 7, np.uint16), {}),
    (np.full((64, 80), 7, np.uint16), {"compression": "zlib"}),
    (np.full((64, 80), 7, np.uint16), {"rowsperstrip": 16}),
    (np.full((64, 80, 3), 7, np.uint8), {"photometric": "rgb"}),
    (np.full((64, 80), 7, np.uint16), {"description": "a page with its own description"}),
]


@pytest.mark.parametrize("bigtiff", [False, True])
@pytest.mark.parametrize("byteorder", ["<", ">"])
def test_each_page_has_its_kind_whatever_pages_are_around_it(tmp_path, bigtiff, byteorder):
    pages = [MIXED[n] for n in np.random.default_rng(4).integers(0, len(MIXED), 60)]
    path = tmp_path / "mixed.tif"
    with tifffile.TiffWriter(path, bigtiff=bigtiff, byteorder=byteorder) as file:
        for image, options in pages:
            file.write(image, contiguous=False, **({"metadata": None} | options))
    with closing(TIFF.open(path)) as file:
        assert file.kinds == [FrameKind(image.shape, image.dtype.name) for image, _ in pages]
        for k in (0, 17, 59):
            np.testing.assert_array_equal(file.read(k), pages[k][0])


def test_alike_directories_are_read_once_and_pages_that_are_cut_off_are_found(tmp_path):
    path = tmp_path / "stack.tif"
    with tifffile.TiffWriter(path) as file:
        for k in range(40):
            file.write(np.full((64, 80), k, np.uint16), contiguous=False, metadata=None)
    with tifffile.TiffFile(path) as file:
        tables = [page.offset for page in file.pages]
        last = file.pages[39].aspage().dataoffsets[0]
    # directories at the end, as some cameras write them, are simulated by a place beyond the end
    content = bytearray(path.read_bytes())
    place = content.index(struct.pack("<I", last), tables[39])
    content[place : place + 4] = struct.pack("<I", len(content) - 100)
    path.write_bytes(content)
    read = []
    with pytest.MonkeyPatch.context() as patch:
        page = tifffile.TiffPage
        patch.setattr(tifffile, "TiffPage", lambda *a, **k: read.append(k) or page(*a, **k))
        with closing(TIFF.open(path)) as file:
            assert file.kinds[:39] == [FrameKind((64, 80), "uint16")] * 39
            assert file.kinds[39] == TRUNCATED
    assert len(read) <= 3
