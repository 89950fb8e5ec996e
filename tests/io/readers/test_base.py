"""The interface of a reader, and the formats behind it."""

from contextlib import closing
from functools import partial
from itertools import product

import numpy as np
import pytest
from scenes.camera_files import (
    random_frames,
    write_cine,
    write_genicam,
    write_im7,
    write_mraw,
    write_seq,
    write_spe2,
    write_spe3,
)
from scenes.reading import read

from erlif.core.errors import FrameError
from erlif.io.readers import FrameKind, open_frames
from erlif.io.readers.base import check_claim


@pytest.mark.parametrize(
    ("frames", "shape", "packing"),
    [(10**9, (64, 80), 1e12), (1, (10**9, 10**9), 1), (3, (64, 80), 1), (3, (64, 80), 1.49)],
)
def test_a_header_that_claims_more_than_its_file_holds_is_refused(frames, shape, packing):
    with pytest.raises(FrameError, match="the file is damaged: 20480 bytes cannot hold"):
        check_claim(frames, FrameKind(shape, "uint16"), 20_480, packing=packing)
    check_claim(3, FrameKind((64, 80), "uint16"), 20_480, packing=1.5)


@pytest.mark.parametrize(("frames", "shape"), [(0, (64, 80)), (1, (0, 80)), (1, ())])
def test_a_header_without_frames_is_refused(frames, shape):
    with pytest.raises(FrameError, match="holds no image"):
        check_claim(frames, FrameKind(shape, "uint16"), 20_480)


# the formats of cameras


def recordings():
    """Name and writer of a recording, options of its frames, and what its reader states."""
    for bits, form in product((10, 12), ("", "p", "Packed", "pmsb")):
        write = partial(write_genicam, pixel_format=f"Mono{bits}{form}", sidecar="json")
        yield "a.raw", write, {"bits": bits}, {"bits": bits, "times": None}
    for bits in (8, 14, 16):
        write = partial(write_genicam, pixel_format=f"Mono{bits}")
        yield "a.raw", write, {"bits": bits}, {"bits": bits}

    for header, (stored, bits) in product(("cihx", "cih"), ((8, 8), (12, 12), (16, 12))):
        write = partial(write_mraw, stored=stored, header=header, rate="50000", step=2500)
        yield "a.mraw", write, {"bits": bits}, {"bits": bits, "times": [0, 0.05, 0.1]}
    yield "a.mraw", partial(write_mraw, side="Higher"), {"shift": 4}, {"bits": None}

    for version, align in product((3, 4, 5), (1, 512, 8192)):
        for bits, used in ((8, 8), (16, 10), (16, 16)):
            write = partial(write_seq, version=version, align=align, bits=bits, significant=used)
            yield "a.seq", write, {"bits": used}, {"bits": used}
    for number in (112, 114):
        yield "a.seq", partial(write_seq, image_format=number), {"shift": 4}, {"bits": None}
    yield "a.seq", partial(write_seq, row_padding=2), {"columns": 7}, {}

    for sign, (stored, bits) in product(
        (1, -1), (("8", 8), ("16", 10), ("16", 14), ("16", 16), ("packed 12", 12))
    ):
        write = partial(write_cine, stored=stored, depth=bits, height_sign=sign)
        yield "a.cine", write, {"bits": bits}, {"bits": bits}
    for padded in (True, False):  # rows that end at multiples of four bytes
        write = partial(write_cine, stored="8", depth=8, padded_rows=padded)
        yield "a.cine", write, {"bits": 8, "columns": 9}, {}

    for kind, dtype in enumerate(("f4", "i4", "i2", "u2", None, "f8", "u1", None, "u4")):
        if dtype is not None:
            write = partial(write_spe2, kind=kind, resolution=14)
            known = {"bits": 14 if dtype in ("u2", "i2") else None}
            yield "a.spe", write, {"bits": 8, "dtype": dtype}, known
    for stamp in (0, 8, 24):
        yield "a.spe", partial(write_spe3, stamp=stamp), {}, {}

    for packing, columns, count in product(range(4), (3, 8, 9), (1, 2)):
        known = {
            "bits": 12 if packing == 3 else None,
            "channels": range(1, count + 1) if count > 1 else None,
        }
        options = {"columns": columns, "frames": count}
        yield "a.im7", partial(write_im7, packing=packing), options, known
    for packing in (0, 2):
        yield "a.im7", partial(write_im7, packing=packing, buffer=-3), {"dtype": "f4"}, {}
    yield "a.im7", partial(write_im7, buffer=-2), {"bits": 8}, {}


def test_every_format_of_a_camera_gives_the_counts_that_were_written(tmp_path):
    for number, (name, write, options, known) in enumerate(recordings()):
        shift, dtype = options.pop("shift", 0), options.pop("dtype", None)
        frames = random_frames(np.random.default_rng(number), **options) << shift
        frames = frames if dtype is None else frames.astype(dtype)
        (tmp_path / str(number)).mkdir()
        path = write(tmp_path / str(number) / name, frames)
        found = read(path)
        assert found.dtype == frames.dtype, (name, options)
        np.testing.assert_array_equal(found, frames, str((name, options)))
        with closing(open_frames(path)) as file:
            for key, value in known.items():
                np.testing.assert_equal(getattr(file, key), value, f"{name} {options} {key}")
            assert {path, *file.companions} == set(path.parent.iterdir())
