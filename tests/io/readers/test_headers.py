"""Headers of camera formats that contradict their file, and recordings that were cut."""

import struct
import tomllib
from contextlib import closing
from functools import partial
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import (
    random_frames,
    write_b16,
    write_cine,
    write_genicam,
    write_im7,
    write_mraw,
    write_seq,
    write_spe2,
    write_spe3,
)
from scenes.reading import refusal

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


HEADERS = tomllib.loads(Path(__file__).with_name("headers.toml").read_text(encoding="utf-8"))

WRITERS = {
    "cine": (write_cine, "a.cine"),
    "seq": (write_seq, "a.seq"),
    "spe2": (write_spe2, "a.spe"),
    "spe3": (write_spe3, "a.spe"),
    "b16": (lambda path, frames: write_b16(path, frames[0]), "a.b16"),
    "described": (write_described, "a.raw"),
    "plain header": (lambda path, frames: write_mraw(path, frames, header="cih"), "a.mraw"),
    **{f"im7 {n}": (partial(write_im7, packing=n), "a.im7") for n in range(4)},
}
"""Writers of the recordings in headers.toml, with the names of their files."""


def test_a_header_that_contradicts_its_file_is_refused(tmp_path):
    faults = []
    for kind, places, code, value, words in HEADERS["numbers"]:
        write, name = WRITERS[kind]
        path = write(tmp_path / name, FRAMES)
        data = bytearray(path.read_bytes())
        for place in places:
            struct.pack_into(code, data, place, value)
        path.write_bytes(data)
        if words not in (message := refusal(path)):
            faults.append((kind, places, value, message))
    assert not faults


def test_a_description_that_contradicts_its_file_is_refused(tmp_path):
    faults = []
    for kind, suffix, old, new, words in HEADERS["texts"]:
        write, name = WRITERS[kind]
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
