"""Speed of the readers: decoded counts per second, against reading the same bytes as they are.

    python benchmarks/camera_files.py                    # every format, 1024 x 1024 pixels
    python benchmarks/camera_files.py --directory /data # files on that disk and not in /tmp

Files are written with random counts and read once before the measurement, so that they come from
the memory of the system: the figures are those of decoding. A frame is read as `erlif process`
reads it, by its position in any order; np.fromfile reads the file in pieces of the same size. The
best of several passes is shown.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import tifffile
from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from scenes import camera_files as writers

from erlif.io.readers import FrameFile, open_frames

Writer = Callable[[Path, np.ndarray], Path]

PASSES = 7
FRAMES, SIDE = 24, 1024
SMALL = slice(0, 2)
"""Frames of the formats whose writers go pixel by pixel."""


def write_tiff(path: Path, frames: np.ndarray) -> Path:
    """One stack of plain pages."""
    with tifffile.TiffWriter(path) as file:
        for frame in frames:
            file.write(frame, contiguous=False, metadata=None)
    return path


def write_pages(path: Path, frames: np.ndarray, **options: Any) -> Path:
    """One TIFF by tifffile."""
    tifffile.imwrite(path, frames, photometric="minisblack", **options)
    return path


def write_libtiff(path: Path, frames: np.ndarray) -> Path:
    """One TIFF with LZW by libtiff."""
    first, *rest = (Image.fromarray(frame) for frame in frames)
    first.save(path, save_all=True, append_images=rest, compression="tiff_lzw")
    return path


def write_picture(path: Path, frames: np.ndarray) -> Path:
    """One picture by Pillow."""
    Image.fromarray(frames[0]).save(path, path.suffix[1:].replace("pgm", "ppm"))
    return path


def write_npy(path: Path, frames: np.ndarray) -> Path:
    """One array by numpy."""
    np.save(path, frames)
    return path


def write_hdf5(path: Path, frames: np.ndarray, **options: Any) -> Path:
    """One dataset by h5py, a chunk for each frame."""
    with h5py.File(path, "w") as file:
        file.create_dataset("counts", data=frames, **options)
    return path


def as_bytes(write: Writer) -> Writer:
    """A writer of 8-bit counts."""
    return lambda path, frames: write(path, frames.astype(np.uint8))


def davis(path: Path, frames: np.ndarray, packing: int) -> Path:
    """An IM7 image; smooth counts, which the compressions expect."""
    smooth = (2000 + np.cumsum(frames.astype(int) % 9 - 4, axis=2)).astype(np.uint16)
    return writers.write_im7(path, smooth, packing=packing)


FORMATS: dict[str, tuple[str, Writer, int, slice]] = {
    "TIFF, plain pages": ("a.tif", write_tiff, 12, slice(None)),
    "TIFF, deflate": (
        "aa.tif",
        lambda p, f: write_pages(p, f, compression="zlib", predictor=2),
        12,
        slice(None),
    ),
    "TIFF, LZW": ("ab.tif", write_libtiff, 12, slice(None)),
    "TIFF, tiles": ("ac.tif", lambda p, f: write_pages(p, f, tile=(256, 256)), 12, slice(None)),
    "TIFF, big endian": ("ad.tif", lambda p, f: write_pages(p, f, byteorder=">"), 12, slice(None)),
    "TIFF, OME": ("ae.tif", lambda p, f: write_pages(p, f, ome=True), 12, slice(None)),
    "TIFF, ImageJ": ("af.tif", lambda p, f: write_pages(p, f, imagej=True), 12, slice(None)),
    "NPY": ("ag.npy", write_npy, 12, slice(None)),
    "FITS": ("ah.fits", writers.write_fits, 12, slice(None)),
    "HDF5": ("ai.h5", write_hdf5, 12, slice(None)),
    "HDF5, gzip": (
        "aj.h5",
        lambda p, f: write_hdf5(p, f, chunks=(1, SIDE, SIDE), compression="gzip", shuffle=True),
        12,
        slice(0, 6),
    ),
    "PNG": ("ak.png", write_picture, 12, slice(0, 1)),
    "BMP": ("al.bmp", as_bytes(write_picture), 8, slice(0, 1)),
    "PGM": ("am.pgm", as_bytes(write_picture), 8, slice(0, 1)),
    "MRAW 8": ("b.mraw", lambda p, f: writers.write_mraw(p, f, stored=8), 8, slice(None)),
    "MRAW 12 packed": ("c.mraw", lambda p, f: writers.write_mraw(p, f, stored=12), 12, slice(None)),
    "MRAW 16": ("d.mraw", lambda p, f: writers.write_mraw(p, f), 12, slice(None)),
    "CINE 8": ("e.cine", lambda p, f: writers.write_cine(p, f, stored="8"), 8, slice(None)),
    "CINE 16": ("f.cine", writers.write_cine, 12, slice(None)),
    "CINE packed 10": (
        "g.cine",
        lambda p, f: writers.write_cine(p, f, stored="packed 10"),
        10,
        slice(None),
    ),
    "CINE packed 12": (
        "h.cine",
        lambda p, f: writers.write_cine(p, f, stored="packed 12"),
        12,
        slice(None),
    ),
    "SEQ 8": ("i.seq", lambda p, f: writers.write_seq(p, f, bits=8, significant=8), 8, slice(None)),
    "SEQ 16": ("j.seq", writers.write_seq, 12, slice(None)),
    "raw Mono12p": ("k.raw", lambda p, f: writers.write_genicam(p, f, "Mono12p"), 12, slice(None)),
    "raw Mono12Packed": (
        "l.raw",
        lambda p, f: writers.write_genicam(p, f, "Mono12Packed"),
        12,
        slice(None),
    ),
    "raw Mono10p": ("m.raw", lambda p, f: writers.write_genicam(p, f, "Mono10p"), 10, slice(None)),
    "B16": ("n.b16", lambda p, f: writers.write_b16(p, f[0]), 12, slice(0, 1)),
    "SPE 2": ("o.spe", writers.write_spe2, 12, slice(None)),
    "SPE 3": ("p.spe", writers.write_spe3, 12, slice(None)),
    "IM7 plain": ("q.im7", lambda p, f: davis(p, f, 0), 12, slice(None)),
    "IM7 12 bits": ("r.im7", lambda p, f: writers.write_im7(p, f, packing=3), 12, SMALL),
    "IM7 zlib, first frame": ("s.im7", lambda p, f: davis(p, f, 2), 12, slice(0, 1)),
    "IM7 IMX, first frame": ("t.im7", lambda p, f: davis(p, f, 1), 12, slice(0, 1)),
}
"""For each format the name of a file, its writer, the bits of its counts and the frames."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("formats", nargs="*", help="beginnings of names; default: all formats")
    parser.add_argument("--directory", type=Path, help="where the files are written; default: /tmp")
    options = parser.parse_args()

    columns = ("1 thread", "2 threads", "np.fromfile", "time ratio")
    print(f"{'GB/s of decoded counts':26}" + "".join(f"{name:>14}" for name in columns))
    rng = np.random.default_rng(1)
    with tempfile.TemporaryDirectory(dir=options.directory) as directory:
        for name, (file_name, write, bits, part) in FORMATS.items():
            if options.formats and not name.startswith(tuple(options.formats)):
                continue
            counts = writers.random_frames(rng, frames=FRAMES, rows=SIDE, columns=SIDE, bits=bits)
            path = write(Path(directory, file_name), counts[part])
            measure(name, path)
            path.unlink()


def measure(name: str, path: Path) -> None:
    """Print one row of the table."""
    file = open_frames(path)
    frames = range(len(file.kinds))
    size = sum(file.read(index).nbytes for index in frames)
    rates = [size / best(lambda: read_all(file, frames)) / 1e9]
    with ThreadPoolExecutor(2) as pool:
        halves = [frames[::2], frames[1::2]]
        rates.append(
            size / best(lambda: list(pool.map(lambda half: read_all(file, half), halves))) / 1e9
        )
    file.close()

    raw = best(lambda: read_pieces(path, len(frames)))
    ratio = size / rates[0] / 1e9 / raw
    print(
        f"{name:26}{rates[0]:14.2f}{rates[1]:14.2f}{path.stat().st_size / raw / 1e9:14.2f}"
        f"{ratio:14.2f}",
        flush=True,
    )


def read_all(file: FrameFile, frames: range) -> None:
    """Read frames from the last to the first."""
    for index in reversed(frames):
        file.read(index)


def read_pieces(path: Path, pieces: int) -> None:
    """Read the bytes of a file as they are, in pieces of the size of a frame."""
    piece = path.stat().st_size // pieces
    for place in range(pieces):
        np.fromfile(path, np.uint8, piece, offset=place * piece)


def best(work: Callable[[], object]) -> float:
    """Shortest time of several passes. [s]"""
    spent = []
    for _ in range(PASSES):
        start = time.perf_counter()
        work()
        spent.append(time.perf_counter() - start)
    return min(spent)


if __name__ == "__main__":
    main()
