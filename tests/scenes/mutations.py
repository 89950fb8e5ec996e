"""Files of each format, damaged at random, and what a reader may do with them."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import tifffile
from PIL import Image

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.base import MOST_FRAMES, TRUNCATED
from scenes.camera_files import (
    random_frames,
    write_b16,
    write_bmp,
    write_cine,
    write_fits,
    write_genicam,
    write_im7,
    write_mraw,
    write_seq,
    write_spe2,
    write_spe3,
)
from scenes.tiff_pages import write_stk

RNG = np.random.default_rng(0)

FRAMES = random_frames(RNG, frames=3, rows=5, columns=7)
TIMES = 1_700_000_000.0 + np.arange(3.0)


def write_set(path: Path) -> Path:
    """A SET file with two images."""
    (path.parent / path.stem).mkdir(exist_ok=True)
    for number in range(2):
        write_im7(path.parent / path.stem / f"B{number}.im7", FRAMES, packing=number)
    path.write_text("SetType = 1")
    return path


def write_tiff(path: Path, **options: Any) -> Path:
    """A stack by tifffile."""
    tifffile.imwrite(path, FRAMES, photometric="minisblack", **options)
    return path


def write_libtiff(path: Path, compression: str) -> Path:
    """A stack by libtiff."""
    first, *rest = (Image.fromarray(frame) for frame in FRAMES)
    first.save(path, save_all=True, append_images=rest, compression=compression)
    return path


def write_picture(path: Path, counts: np.ndarray) -> Path:
    """A picture by Pillow."""
    Image.fromarray(counts).save(path, path.suffix[1:].replace("pgm", "ppm"))
    return path


def write_npy(path: Path) -> Path:
    """An array by numpy."""
    np.save(path, FRAMES)
    return path


def write_hdf5(path: Path, *, libver: str = "earliest", **options: Any) -> Path:
    """A dataset by h5py; the latest form of HDF5 has checksums in its headers."""
    with h5py.File(path, "w", libver=libver) as file:
        file.create_dataset("camera1/counts", data=FRAMES, **options)
    return path


def write_netcdf(path: Path) -> Path:
    """Frames with their times by h5netcdf."""
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"time": 3, "y": 5, "x": 7}
        file.create_variable("counts", ("time", "y", "x"), data=FRAMES)
        file.create_variable("time", ("time",), data=TIMES).attrs["units"] = "s"
    return path


SAMPLES: dict[str, tuple[Callable[[Path], Path], str]] = {
    "mraw cihx": (lambda d: write_mraw(d / "a.mraw", FRAMES, stored=12), "a.cihx"),
    "mraw cih": (lambda d: write_mraw(d / "a.mraw", FRAMES, header="cih"), "a.cih"),
    "mraw counts": (lambda d: write_mraw(d / "a.mraw", FRAMES, stored=12), "a.mraw"),
    "cine": (lambda d: write_cine(d / "a.cine", FRAMES, times=TIMES), "a.cine"),
    "cine packed": (lambda d: write_cine(d / "a.cine", FRAMES >> 2, stored="packed 10"), "a.cine"),
    "seq": (lambda d: write_seq(d / "a.seq", FRAMES, times=TIMES, align=1), "a.seq"),
    "seq 4": (lambda d: write_seq(d / "a.seq", FRAMES, version=4, align=1), "a.seq"),
    "raw toml": (
        lambda d: write_genicam(d / "a.raw", FRAMES, "Mono12p", frames=3, frame_rate=9),
        "a.toml",
    ),
    "raw json": (
        lambda d: write_genicam(d / "a.raw", FRAMES, "Mono12", sidecar="json", header_bytes=0),
        "a.json",
    ),
    "im7 plain": (lambda d: write_im7(d / "a.im7", FRAMES), "a.im7"),
    "im7 imx": (lambda d: write_im7(d / "a.im7", FRAMES, packing=1), "a.im7"),
    "im7 zlib": (lambda d: write_im7(d / "a.im7", FRAMES, packing=2), "a.im7"),
    "im7 12": (lambda d: write_im7(d / "a.im7", FRAMES, packing=3), "a.im7"),
    "set": (lambda d: write_set(d / "a.set"), "a/B1.im7"),
    "b16": (lambda d: write_b16(d / "a.b16", FRAMES[0]), "a.b16"),
    "spe 2": (lambda d: write_spe2(d / "a.spe", FRAMES), "a.spe"),
    "spe 3": (lambda d: write_spe3(d / "a.spe", FRAMES), "a.spe"),
    "tiff": (lambda d: write_tiff(d / "a.tif"), "a.tif"),
    "tiff deflate": (lambda d: write_tiff(d / "a.tif", compression="zlib", predictor=2), "a.tif"),
    "tiff big": (lambda d: write_tiff(d / "a.tif", bigtiff=True, byteorder=">"), "a.tif"),
    "tiff tiles": (lambda d: write_tiff(d / "a.tif", tile=(16, 16), compression="zlib"), "a.tif"),
    "tiff lzw": (lambda d: write_libtiff(d / "a.tif", "tiff_lzw"), "a.tif"),
    "tiff packbits": (lambda d: write_libtiff(d / "a.tif", "packbits"), "a.tif"),
    "stk": (lambda d: write_stk(d / "a.stk", FRAMES), "a.stk"),
    "tiff ome": (lambda d: write_tiff(d / "a.tif", ome=True, metadata={"axes": "TYX"}), "a.tif"),
    "tiff imagej": (lambda d: write_tiff(d / "a.tif", imagej=True), "a.tif"),
    "png": (lambda d: write_picture(d / "a.png", FRAMES[0]), "a.png"),
    "bmp": (lambda d: write_bmp(d / "a.bmp", (FRAMES[0] >> 10).astype(np.uint8)), "a.bmp"),
    "pgm": (lambda d: write_picture(d / "a.pgm", (FRAMES[0] >> 4).astype(np.uint8)), "a.pgm"),
    "npy": (lambda d: write_npy(d / "a.npy"), "a.npy"),
    "fits": (lambda d: write_fits(d / "a.fits", FRAMES), "a.fits"),
    "hdf5": (lambda d: write_hdf5(d / "a.h5"), "a.h5"),
    "hdf5 gzip": (lambda d: write_hdf5(d / "a.h5", chunks=(1, 5, 7), compression="gzip"), "a.h5"),
    "hdf5 latest": (
        lambda d: write_hdf5(d / "a.h5", libver="latest", chunks=(1, 5, 7), compression="gzip"),
        "a.h5",
    ),
    "hdf5 checked": (
        lambda d: write_hdf5(d / "a.h5", libver="latest", chunks=(1, 3, 7), fletcher32=True),
        "a.h5",
    ),
    "netcdf": (lambda d: write_netcdf(d / "a.nc"), "a.nc"),
}
"""For each format its writer, and the file that is damaged."""

NUMBERS = (0, 1, 2, 3, 7, 8, 255, 256, 65535, 65536, 10**9, 2**31 - 1, 2**31, 2**32 - 1, 2**63 - 1)
TEXTS = (
    *(b"0", b"4", b"9", b"-1", b"1e999", b"nan", b"999999999999", b"1" * 400, b"", b"3.5"),
    *(b"\xff\xfe", b"[["),
)


def mutate(data: bytes, rng: np.random.Generator) -> bytes:
    """Damage a file in one to three places."""
    out = bytearray(data)
    for _ in range(rng.integers(1, 4)):
        # fields are few and stand where bytes differ from zero
        used = np.flatnonzero(np.frombuffer(out, np.uint8))
        if not used.size:
            break
        place = int(rng.choice(used[:400] if rng.random() < 0.8 else used))
        match 6 if out.isascii() and rng.random() < 0.6 else rng.integers(0, 7):
            case 0:
                out[place] ^= 1 << int(rng.integers(0, 8))
            case 1:
                out[place] = int(rng.choice([0, 1, 127, 128, 255]))
            case 2 | 3:
                size = int(rng.choice([2, 4, 8]))
                number = int(rng.choice(NUMBERS)) if rng.random() < 0.7 else len(data)
                out[place : place + size] = (number % 256**size).to_bytes(size, "little")
            case 4:
                del out[place : place + int(rng.choice([1, 4, 100, len(out)]))]
            case 5:
                out[place:place] = bytes(int(rng.choice([1, 4, 64])))
            case 6:  # a number or a name of a text
                words = list(re.finditer(rb"[0-9.]+|[A-Za-z_]{3,}", bytes(out)))
                if words:
                    start, end = words[int(rng.integers(0, len(words)))].span()
                    out[start:end] = TEXTS[int(rng.integers(0, len(TEXTS)))]
    return bytes(out)


def check_reader(path: Path) -> str:
    """Read a file that may be damaged: its frames are of the stated kind, or a FrameError comes.

    Returns
    -------
    str
        "refused", "in part" or "read".
    """
    try:
        file = open_frames(path)
    except FrameError:
        return "refused"
    try:
        count = len(file.kinds)
        assert 0 < count <= MOST_FRAMES
        assert file.bits is None or 1 <= file.bits <= 64
        assert file.times is None or (len(file.times) == count and file.times.dtype == float)
        assert file.times is None or not np.isinf(file.times).any()
        outcome = "read"
        for index in {0, 1 % count, count // 2, count - 1}:
            kind = file.kinds[index]
            try:
                counts = file.read(index)
            except FrameError:
                outcome = "in part"
                continue
            assert kind != TRUNCATED
            assert counts.shape == kind.shape
            assert counts.dtype.name == kind.dtype
        return outcome
    finally:
        file.close()
