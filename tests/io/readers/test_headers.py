"""Headers of camera formats that contradict their file, and recordings that were cut."""

from __future__ import annotations

import struct
from contextlib import closing

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import (
    random_frames,
    write_b16,
    write_cine,
    write_genicam,
    write_mraw,
    write_seq,
    write_spe2,
    write_spe3,
)

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.base import TRUNCATED

FRAMES = random_frames(np.random.default_rng(1))


def write_npy(path, frames):
    np.save(path, frames)
    return path


def write_pgm(path, frames):
    head = b"P5 8 6 65535\n"
    path.write_bytes(b"".join(head + frame.astype(">u2").tobytes() for frame in frames))
    return path


def write_described(path, frames):
    return write_genicam(path, frames, "Mono12p", frames=3, frame_rate=100)


def write_plain_header(path, frames):
    return write_mraw(path, frames, header="cih")


NUMBERS = [
    # writer, ending, place and code of the number that is overwritten, value, words of the refusal
    (write_cine, ".cine", 20, "<I", 10**9, "header names 1000000000 frames"),
    (write_cine, ".cine", 20, "<I", 0, "header names 0 frames"),
    (write_cine, ".cine", 20, "<I", 100_000, "truncated or damaged"),  # its table ends outside
    (write_cine, ".cine", 24, "<I", 2**32 - 1, "truncated or damaged"),
    (write_cine, ".cine", 28, "<I", 2**32 - 1, "truncated or damaged"),
    (write_cine, ".cine", 32, "<I", 2**32 - 1, "truncated or damaged"),
    (write_cine, ".cine", 28, "<I", 0, "no block of settings"),
    (write_cine, ".cine", 48, "<i", 0, "holds no image"),
    (write_cine, ".cine", 48, "<i", 2**31 - 1, "cannot hold"),
    (write_cine, ".cine", 52, "<i", -(2**31), "cannot hold"),
    (write_cine, ".cine", 58, "<H", 24, "colour frames of 24 bits"),
    (write_cine, ".cine", 60, "<I", 77, "unknown way"),
    (write_cine, ".cine", 4, "<H", 1, "JPEG-compressed"),
    (write_cine, ".cine", 4, "<H", 2, "from a colour sensor"),
    (write_seq, ".seq", 572, "<I", 10**9, "header names 1000000000 frames"),
    (write_seq, ".seq", 548, "<I", 0, "holds no image"),
    (write_seq, ".seq", 552, "<I", 2**32 - 1, "damaged"),
    (write_seq, ".seq", 548, "<I", 2**32 - 1, "damaged"),
    (write_seq, ".seq", 580, "<I", 0, "cannot lie 0 apart"),
    (write_seq, ".seq", 580, "<I", 95, "cannot lie 95 apart"),
    (write_seq, ".seq", 556, "<I", 24, "format 100 of NorPix with 24 bits"),
    (write_seq, ".seq", 568, "<I", 131, "format 131"),
    (write_seq, ".seq", 568, "<I", 200, "colour camera"),
    (write_seq, ".seq", 568, "<I", 101, "colour camera"),
    (write_seq, ".seq", 564, "<I", 97, "damaged"),
    (write_seq, ".seq", 620, "<I", 1, "compressed"),
    (write_seq, ".seq", (552, 564, 580), "<I", 0, "holds no image"),  # rows, size and step
    (write_spe2, ".spe", 1446, "<i", 10**9, "header names 1000000000 frames"),
    (write_spe2, ".spe", 1446, "<i", -1, "header names 0 frames"),
    (write_spe2, ".spe", 42, "<H", 0, "holds no image"),
    (write_spe2, ".spe", 656, "<H", 65535, "cannot hold"),
    (write_spe2, ".spe", 108, "<h", 4, "type 4"),
    (write_spe2, ".spe", 108, "<h", -1, "type -1"),
    (write_b16, ".b16", 0, "<i", 0, "does not begin as a B16 file"),
    (write_b16, ".b16", 8, "<i", 3, "ends at byte 3"),
    (write_b16, ".b16", 8, "<i", -5, "ends at byte -5"),
    (write_b16, ".b16", 8, "<i", 2**31 - 1, "header names 1 frames"),
    (write_b16, ".b16", 12, "<i", 0, "holds no image"),
    (write_b16, ".b16", 12, "<i", 2**31 - 1, "cannot hold"),
    (write_b16, ".b16", 16, "<i", -1, "holds no image"),
    (write_b16, ".b16", 24, "<i", 1, "colour camera"),
]

TEXTS = [
    # writer, name of the recording and ending of its text, what is replaced, words of the refusal
    (write_described, "a.raw", ".toml", "width = 8", "width = 7", "describes 3 frames of 63 bytes"),
    (write_described, "a.raw", ".toml", "width = 8", "width = 8.0", "width, 8.0"),
    (write_described, "a.raw", ".toml", "width = 8", "width = true", "width, True"),
    (write_described, "a.raw", ".toml", "width = 8", "width = -8", "width, -8"),
    (write_described, "a.raw", ".toml", "width = 8", "widht = 8", "width, {"),
    (write_described, "a.raw", ".toml", "width = 8", "", "width, {"),
    (write_described, "a.raw", ".toml", "width = 8", "width = 0", "holds no image"),
    (write_described, "a.raw", ".toml", "width = 8", "width =", "a.toml cannot be read"),
    (write_described, "a.raw", ".toml", "s = 3", "s = 1000000000", "names 1000000000 frames"),
    (write_described, "a.raw", ".toml", "s = 3", "s = 2", "describes 2 frames of 72 bytes"),
    (write_described, "a.raw", ".toml", '"Mono12p"', '"BayerRG12p"', "pixel_format, BayerRG12p"),
    (write_described, "a.raw", ".toml", '"Mono12p"', "12", "pixel_format, 12"),
    (write_described, "a.raw", ".toml", "rate = 100", "rate = 0", "frame_rate, 0"),
    (write_described, "a.raw", ".toml", "rate = 100", "rate = " + "9" * 400, "frame_rate, 999"),
    (write_described, "a.raw", ".toml", "rate = 100", "rate = 1e-320", "frame_rate, 1e-320"),
    (write_described, "a.raw", ".toml", "rate = 100", "rate = nan", "frame_rate, nan"),
    (write_spe3, "a.spe", ".spe", 'width="8"', 'width="0"', "holds no image"),
    (write_spe3, "a.spe", ".spe", 'width="8"', 'width="x"', "width = 'x'"),
    (write_spe3, "a.spe", ".spe", 'count="3"', 'count="999999999"', "names 999999999 frames"),
    (write_spe3, "a.spe", ".spe", 'count="3"', f'count="{10**20}"', "count = "),
    (write_spe3, "a.spe", ".spe", 'stride="104"', 'stride="9"', "cannot lie 9 apart"),
    (write_spe3, "a.spe", ".spe", 'type="Frame"', 'type="Fame"', "no block of frames"),
    (write_spe3, "a.spe", ".spe", "MonochromeUnsigned16", "Bayer16", "'Bayer16' is not read"),
    (write_plain_header, "a.mraw", ".cih", "Width : 8", "Width : wide", "Image Width is 'wide'"),
    (write_plain_header, "a.mraw", ".cih", "Width : 8", "Width : -8", "Image Width is '-8'"),
    (write_plain_header, "a.mraw", ".cih", "Width : 8", "Width : 1e999", "Image Width is '1e999'"),
    (write_plain_header, "a.mraw", ".cih", "Height : 6", "Height : 3.5", "Image Height is '3.5'"),
    (write_plain_header, "a.mraw", ".cih", "Total Frame : 3", "", "has no entry for Total Frame"),
    (write_plain_header, "a.mraw", ".cih", "Color Bit : 16", "Color Bit : 24", "names 24 bits"),
    (write_plain_header, "a.mraw", ".cih", "Depth : 12", "Depth : 99", "99 effective bits"),
    (write_plain_header, "a.mraw", ".cih", "Type : Mono", "Type : Color", "colour camera"),
    (
        write_plain_header,
        "a.mraw",
        ".cih",
        "Format : MRaw",
        "Format : TIFF",
        "describes TIFF files",
    ),
]


def refusal(path) -> str:
    """The message with which a recording is refused; empty where it is opened."""
    try:
        with closing(open_frames(path)):
            return ""
    except FrameError as error:
        return str(error)


def test_a_header_that_contradicts_its_file_is_refused(tmp_path):
    faults = []
    for write, suffix, place, code, value, words in NUMBERS:
        path = write(tmp_path / f"a{suffix}", FRAMES[0] if write is write_b16 else FRAMES)
        data = bytearray(path.read_bytes())
        for one in place if isinstance(place, tuple) else (place,):
            struct.pack_into(code, data, one, value)
        path.write_bytes(data)
        if words not in (message := refusal(path)):
            faults.append((suffix, place, value, message))
    assert not faults


def test_a_description_that_contradicts_its_file_is_refused(tmp_path):
    faults = []
    for write, name, suffix, old, new, words in TEXTS:
        path = write(tmp_path / name, FRAMES)
        text = path.with_suffix(suffix)
        content = text.read_bytes()
        assert old.encode() in content, old
        text.write_bytes(content.replace(old.encode(), new.encode(), 1))
        if words not in (message := refusal(path)):
            faults.append((suffix, new, message))
    assert not faults


@pytest.mark.parametrize(
    ("write", "suffix"),
    [
        (write_mraw, ".mraw"),
        (write_cine, ".cine"),
        (write_spe2, ".spe"),
        (write_described, ".raw"),
        (write_npy, ".npy"),
        (write_pgm, ".pgm"),
    ],
)
def test_a_recording_that_was_cut_keeps_its_whole_frames(tmp_path, write, suffix):
    path = write(tmp_path / f"a{suffix}", FRAMES)
    path.write_bytes(path.read_bytes()[:-1])
    with closing(open_frames(path)) as file:
        assert [kind == TRUNCATED for kind in file.kinds] == [False, False, True]
        npt.assert_array_equal(file.read(1), FRAMES[1])
        with pytest.raises(FrameError, match="truncated"):
            file.read(2)
