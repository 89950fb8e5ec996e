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
    ("texts", "times"),
    [
        # of 1camera.im7 of readim7, whose vector field has FrameDt0=10000 us
        ((b"AcqTime1=10500 \xb5s", b"AcqTime0=500 \xb5s"), [0, 0.01]),
        # of its 2cameras.im7
        ((b"AcqTime0=500", b"AcqTime1=700", b"AcqTime2=500", b"AcqTime3=700"), [0, 2e-4] * 2),
        # a frame without a delay, and a delay in another unit
        ((b"AcqTime0=500 \xb5s",), [0, 0]),
        ((b"AcqTime0=1 ms", b"AcqTime1=11 ms"), [0, 0]),
    ],
)
def test_exposures_of_one_trigger_are_apart_by_their_delays(tmp_path, texts, times):
    series = [b"AcqTimeSeries%d=18040840 \xb5s" % n for n in range(len(times))]
    frames = random_frames(np.random.default_rng(1), frames=len(times))
    path = write_im7(tmp_path / "a.im7", frames, packing=1, attributes=[*series, *texts])
    npt.assert_allclose(times_of(path), times, atol=1e-12)


@pytest.mark.parametrize("delay", [10_500.0, np.nextafter(10_500, 2e4), np.inf, np.nan, -1e300])
def test_delays_are_read_as_later_versions_store_them(tmp_path, delay):
    """As lvpyio 1.5, the library of LaVision, writes them: a number of 64 bits behind the name."""
    series = [b"AcqTimeSeries%d=18040840 \xb5s" % n for n in range(12)]
    frames = random_frames(np.random.default_rng(1), frames=12)
    path = write_im7(tmp_path / "a.im7", frames, packing=2, attributes=series)
    content = path.read_bytes()[:-8]
    for n in range(12):
        name = b"Acq.Time%d" % n
        name = name.ljust(-(-len(name) // 4) * 4, b"\0")
        value = struct.pack("<d", delay if n % 2 else 500)
        content += struct.pack("<ii", 13, len(name) + 8) + name + value
    path.write_bytes(content + bytes(8))
    step = delay / 1e6 - 5e-4 if 0 < delay < 1e6 else 0
    npt.assert_allclose(times_of(path), [0, step] * 6, atol=1e-12)


def test_a_vector_field_is_refused_by_what_it_is(tmp_path):
    path = write_im7(tmp_path / "B00001.VC7", np.ones((1, 6, 8), np.uint16))
    header = bytearray(path.read_bytes())
    header[4:6] = struct.pack("<h", 3)
    found = refusal(path, bytes(header))
    assert (
        found == "it holds a vector field and no counts. Name the camera images of the recording."
    )


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
