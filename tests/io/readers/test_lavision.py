"""LaVision IM7 images and SET folders."""

import re
import struct
from contextlib import closing

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_im7
from scenes.reading import read, refusal, times_of

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames


def test_a_set_is_its_images_in_the_order_of_their_numbers(tmp_path):
    frames = random_frames(np.random.default_rng(1), frames=6)
    folder = tmp_path / "run 1.5"
    folder.mkdir()
    for name, pair in (("B99999", 0), ("B100000", 4), ("B00007", 2)):
        write_im7(folder / f"{name}.im7", frames[pair : pair + 2], packing=1)
    (tmp_path / "run 1.5.set").write_text("SetType = 1")
    npt.assert_array_equal(read(tmp_path / "run 1.5.set"), frames[[2, 3, 0, 1, 4, 5]])
    with closing(open_frames(tmp_path / "run 1.5.set")) as file:
        names = [path.name for path in file.companions]
        assert file.channels == [1, 2, 1, 2, 1, 2]
    assert names == ["B00007.im7", "B99999.im7", "B100000.im7"]


def test_a_set_without_images_is_refused(tmp_path):
    (tmp_path / "a.set").write_text("SetType = 1")
    assert refusal(tmp_path / "a.set").endswith("Copy the folder a beside it.")
    (tmp_path / "a").mkdir()
    assert "holds no IM7 images. Export the recording as IM7" in refusal(tmp_path / "a.set")


@pytest.mark.parametrize("frame", [0, 1])
def test_counts_that_do_not_fit_the_checksum_of_zlib_are_refused(tmp_path, frame):
    frames = random_frames(np.random.default_rng(1), frames=2, rows=5, columns=7)
    path = write_im7(tmp_path / "a.im7", frames, packing=2)
    content = bytearray(path.read_bytes())
    place = 256 + 4 + 2 + 5 + 3  # header, length, zlib, block of random bytes as they are, count
    content[place] ^= 1
    path.write_bytes(content)
    damaged = pytest.raises(FrameError, match="compressed counts are damaged")
    with closing(open_frames(path)) as file, damaged:
        file.read(frame)


def test_the_damaged_image_of_a_set_is_named(tmp_path):
    (tmp_path / "a").mkdir()
    for number in (1, 2):
        write_im7(tmp_path / "a" / f"B0000{number}.im7", np.ones((1, 6, 8), np.uint16))
    (tmp_path / "a" / "B00002.im7").write_bytes(bytes(20))
    (tmp_path / "a.set").write_text("SetType = 1")
    assert "B00002.im7 in its folder: the file is trunc" in refusal(tmp_path / "a.set")


@pytest.mark.parametrize("packing", [0, 1, 2, 3])
@pytest.mark.parametrize("unit", [b" \xb5s", " µs".encode(), b" us", b""])
def test_times_of_a_set_are_those_of_its_attributes(tmp_path, packing, unit):
    """Microseconds from the start of the recording, one for each frame of each image."""
    (tmp_path / "a").mkdir()
    frames = random_frames(np.random.default_rng(1))[:2]
    for k, start in enumerate((20_000, 73_401)):
        texts = [b"AcqTimeSeries%d=%d%s" % (n, start + 7 * n, unit) for n in range(2)]
        write_im7(tmp_path / "a" / f"B0000{k + 1}.im7", frames, packing=packing, attributes=texts)
    (tmp_path / "a.set").write_text("SetType = 1")
    npt.assert_allclose(times_of(tmp_path / "a.set"), [0, 7e-6, 0.053401, 0.053408])
    npt.assert_allclose(times_of(tmp_path / "a" / "B00002.im7"), [0, 7e-6])
    npt.assert_array_equal(read(tmp_path / "a" / "B00002.im7"), frames)


@pytest.mark.parametrize(
    "texts", [(), (b"AcqTimeSeries0=5 ms", b"AcqTimeSeries1=6 ms"), (b"AcqTimeSeries0=5 us",)]
)
def test_a_frame_without_a_time_leaves_all_without(tmp_path, texts):
    frames = random_frames(np.random.default_rng(1))[:2]
    assert times_of(write_im7(tmp_path / "a.im7", frames, attributes=texts)) is None


@pytest.mark.parametrize("packing", [1, 2, 3])
def test_cut_counts_are_refused(tmp_path, packing):
    frames = random_frames(np.random.default_rng(1), rows=60, columns=80)
    path = write_im7(tmp_path / "a.im7", frames, packing=packing)
    assert re.search(r"end within|truncated|cannot hold", refusal(path, path.read_bytes()[:-6000]))


@pytest.mark.parametrize("length", [-1, 2**31 - 1])
def test_a_length_of_the_compressed_counts_beyond_the_file_is_refused(tmp_path, length):
    path = write_im7(tmp_path / "a.im7", random_frames(np.random.default_rng(1)), packing=2)
    data = bytearray(path.read_bytes())
    struct.pack_into("<i", data, 256, length)
    assert "truncated" in refusal(path, data)
