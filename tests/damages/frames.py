"""Damaged frames, darks and flats."""

import os
import zlib

import numpy as np
import tifffile
from PIL import Image

from damages.bench import Damage


def _frame(name, change, *words):
    return Damage(f"frame: {name}", change, "process run", words)


def _content(name, content, *words):
    """One frame with other bytes."""
    return _frame(name, lambda b: b.write(b.frame(2), content(b.frame(2).read_bytes())), *words)


def _cut(share):
    return _content(
        f"cut at {share}",
        lambda data: data[: share if share < len(data) else len(data) - 1],
        "frame_0002.tif",
        "--skip-bad-frames",
    )


def _save(change, **options):
    """Write one frame again, in another form."""

    def damage(bench):
        image = tifffile.imread(bench.frame(2))
        bench.frame(2).unlink()
        tifffile.imwrite(bench.frame(2), change(image), **options)

    return damage


def _picture(suffix, mode=None):
    """Every frame of camera 1 saved by a picture program."""

    def damage(bench):
        for number in range(6):
            image = Image.fromarray((tifffile.imread(bench.frame(number)) >> 4).astype(np.uint8))
            bench.frame(number).unlink()
            image = image if mode is None else image.convert(mode)
            image.save(bench.frame(number).with_suffix(suffix))
        bench.edit(bench.run / "run.toml", ("camera1/*.tif", f"camera1/*{suffix}"))

    return damage


def _loop(path):
    """A link that leads to itself."""
    path.unlink()
    path.symlink_to(path.name)


def _pipe(path):
    path.unlink()
    os.mkfifo(path)


def _claim(path):
    """Two gigabytes of zeros in two megabytes: tiles of 32 MB that all hold the same bytes."""
    path.unlink()
    tiles = [zlib.compress(bytes(2 * 4096**2))] * 64
    options = {"shape": (30_000, 30_000), "dtype": np.uint16, "tile": (4096, 4096)}
    tifffile.imwrite(path, iter(tiles), compression="zlib", **options)


def _taken(name, source, order, *words):
    """Frame k of camera 2 has the content of frame order[k] of a camera."""

    def damage(bench):
        content = [bench.frame(k, source).read_bytes() for k in range(6)]
        for k, n in enumerate(order):
            bench.write(bench.frame(k, 2), content[n])

    return _frame(name, damage, *words)


def _dark(name, change, *words, flat=False):
    kind = "flat" if flat else "dark"
    return Damage(
        f"{kind}: {name}",
        lambda bench: change(bench, bench.run / f"camera1_{kind}.tif"),
        "process run",
        words,
    )


FRAMES = [
    _frame("a link to itself", lambda b: _loop(b.frame(2)), "camera1/frame_0002.tif", "symbolic"),
    _dark("a link to itself", lambda b, path: _loop(path), "camera1_dark.tif", "symbolic"),
    _dark("a pipe", lambda b, path: _pipe(path), "camera1_dark.tif", "not an ordinary file"),
    _dark("a pipe", lambda b, path: _pipe(path), "camera1_flat.tif", "not an ordinary", flat=True),
    _dark("2 GB of zeros", lambda b, path: _claim(path), "30000 x 30000", "268 MP"),
    # files that are missing or too many
    _frame(
        "missing from camera 1",
        lambda b: b.frame(2).unlink(),
        "camera1 has 5, camera2 has 6",
        "--skip-bad-frames",
    ),
    _frame(
        "missing from camera 2",
        lambda b: b.frame(2, 2).unlink(),
        "camera1 has 6, camera2 has 5",
        "unmatched one is camera1/frame_0002.tif",
    ),
    _frame(
        "missing from both",
        lambda b: [b.frame(2, camera).unlink() for camera in (1, 2)],
        "5 frames",
        "6 rows",
    ),
    _frame(
        "one too many",
        lambda b: b.write(b.frame(6), b.frame(5).read_bytes()),
        "camera1 has 7, camera2 has 6",
    ),
    _frame(
        "one too many in both",
        lambda b: [b.write(b.frame(6, c), b.frame(5, c).read_bytes()) for c in (1, 2)],
        "7 frames",
        "6 rows",
    ),
    _frame(
        "renamed",
        lambda b: b.frame(2).rename(b.frame(2).with_name("copy of frame_0002.tif")),
        "frame_0002.tif",
    ),
    _frame(
        "one missing from each",
        lambda b: (b.frame(2).unlink(), b.frame(4, 2).unlink()),
        "camera1 has 5, camera2 has 5",
        "unmatched one is camera1/frame_0004.tif",
    ),
    _frame(
        "folder is empty",
        lambda b: [path.unlink() for path in (b.run / "camera1").iterdir()],
        "there is none",
    ),
    _frame(
        "link to nowhere",
        lambda b: (b.frame(2).unlink(), b.frame(2).symlink_to("nowhere.tif")),
        "frame_0002.tif",
        "cannot be read",
    ),
    # bytes
    *(_cut(share) for share in (1, 3, 4, 7, 8, 20, 100, 200, 1000, 5000, 10_000, 20_000, 10**9)),
    _content("empty", lambda data: b"", "frame_0002.tif", "the file is empty"),
    _content("zeros", lambda data: bytes(len(data)), "frame_0002.tif", "damaged"),
    _content("text", lambda data: b"lunch at noon" * 100, "frame_0002.tif", "damaged"),
    _content("web page", lambda data: b"<!DOCTYPE html><html>" * 50, "frame_0002.tif", "damaged"),
    _content("ZIP archive", lambda data: b"PK\3\4" + data[4:], "frame_0002.tif", "damaged"),
    _content("HDF5 head", lambda data: b"\x89HDF\r\n\x1a\n" + data[8:], "frame_0002.tif"),
    _content("line ends converted", lambda data: data.replace(b"\n", b"\r\n"), "frame_0002.tif"),
    _content("first half twice", lambda data: data[: len(data) // 2] * 2, "frame_0002.tif"),
    _content("shifted by a byte", lambda data: b"\0" + data, "frame_0002.tif", "damaged"),
    _content("header in a ring", lambda data: data[:4] + b"\4\0\0\0" + data[8:], "frame_0002.tif"),
    # form
    _frame("RGB", _save(lambda i: np.dstack([i] * 3), photometric="rgb"), "frame_0002.tif"),
    _frame("cropped", _save(lambda i: i[:-2]), "uint16; camera1/frame_0002.tif is 128 x 94"),
    _frame("turned", _save(lambda i: np.rot90(i)), "frame_0002.tif", "96 x 128"),
    _frame("two pages", _save(lambda i: np.stack([i, i])), "camera1 has 7"),
    _frame("32-bit", _save(lambda i: i.astype(np.uint32)), "frame_0002.tif", "uint32"),
    _frame("float", _save(lambda i: i.astype(np.float32)), "frame_0002.tif", "float32"),
    _frame("complex", _save(lambda i: i.astype(np.complex64)), "frame_0002.tif"),
    _frame("8-bit", _save(lambda i: (i >> 4).astype(np.uint8)), "frame_0002.tif", "uint8"),
    _frame("all JPEG", _picture(".jpg"), "compressed with losses"),
    _frame("all GIF", _picture(".gif"), "a palette"),
    _frame("all PNG with a palette", _picture(".png", "P"), "palette"),
    _frame("all PNG in colour", _picture(".png", "RGB"), "colour"),
    # counts
    _frame("counts above full scale", lambda b: b.all_frames(lambda i: i | 0x3000), "bit_depth"),
    _frame("left-aligned", lambda b: b.all_frames(lambda i: i << 4), 'alignment = "left"'),
    _frame("saturated", lambda b: b.all_frames(lambda i: i * 0 + 4095), "frame"),
    _frame("all dark", lambda b: b.all_frames(lambda i: i * 0 + 64), "frame"),
    _frame("camera 2 constant", lambda b: b.all_frames(lambda i: i * 0 + 900, 2), "camera"),
    _frame(
        "one camera stuck",
        lambda b: [b.write(b.frame(k), b.frame(0).read_bytes()) for k in range(1, 6)],
        "camera1",
        "the same",
        "Record the run again",
    ),
    # frames in the place of others
    _taken("camera 2, two exchanged", 2, [0, 2, 1, 3, 4, 5], "frame_0001.tif shows the pulse of"),
    _taken("camera 2 early", 2, [1, 2, 3, 4, 5, 0], "camera 2 is one pulse early"),
    _taken("camera 2 late", 2, [4, 5, 0, 1, 2, 3], "camera 2 is 2 pulses late"),
    _taken("camera 2 in reverse", 2, [5, 4, 3, 2, 1, 0], "camera 2 are in reverse order"),
    _taken("camera 1 for both", 1, range(6), "the same image. Correct files in [camera1] or"),
    _frame(
        "one pair for all",
        lambda b: [
            b.write(b.frame(k, c), b.frame(0, c).read_bytes()) for k in range(1, 6) for c in (1, 2)
        ],
        "all 6 pairs show the same image",
    ),
    _frame(
        "negative counts", lambda b: b.all_frames(lambda i: i.astype(np.int16) - 4000), "no counts"
    ),
    _frame("fractions", lambda b: b.all_frames(lambda i: i.astype(np.float32) / 3), "no counts"),
    _frame(
        "NaN", lambda b: b.all_frames(lambda i: np.where(i > 900, np.nan, i)), "no counts", "nan"
    ),
    _frame("small", lambda b: b.all_frames(lambda i: i[:40, :40]), "at least 64 x 64 pixels"),
    # darks and flats
    _dark("cut", lambda b, p: b.write(p, p.read_bytes()[:9000]), "camera1_dark.tif"),
    _dark("missing", lambda b, p: p.unlink(), "camera1_dark.tif", "Put them there"),
    _dark("other shape", lambda b, p: b.pages(p, lambda i: i[:-1]), "camera1_dark.tif"),
    _dark("as bright as the frames", lambda b, p: b.pages(p, lambda i: i * 0 + 3900), "dark"),
    _dark("left-aligned", lambda b, p: b.pages(p, lambda i: i << 4), "camera1_dark.tif"),
    _dark("fractions", lambda b, p: b.pages(p, lambda i: i / 3), "camera1_dark.tif", "no counts"),
    _dark("cut", lambda b, p: b.write(p, p.read_bytes()[:9000]), "camera1_flat.tif", flat=True),
    _dark("missing", lambda b, p: p.unlink(), "camera1_flat.tif", "Put them there", flat=True),
    _dark("other shape", lambda b, p: b.pages(p, lambda i: i[1:]), "camera1_flat.tif", flat=True),
    _dark("zeros", lambda b, p: b.pages(p, lambda i: i * 0), "flat", flat=True),
    _dark("saturated", lambda b, p: b.pages(p, lambda i: i * 0 + 4095), "flat", flat=True),
    _dark("is a frame in colour", lambda b, p: b.write(p, _colour()), "camera1_flat", flat=True),
]


def _colour():
    import io

    target = io.BytesIO()
    tifffile.imwrite(target, np.zeros((96, 128, 3), np.uint8), photometric="rgb")
    return target.getvalue()
