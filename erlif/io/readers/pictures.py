"""PNG, BMP and PGM pictures with grey counts."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError, reason_of
from erlif.io.readers.base import DEFLATED, Format, FrameFile, FrameKind, check_claim
from erlif.io.readers.raw import FrameLayout, RawFrames
from erlif.io.readers.source import Source

# Size of what a PNG may hold beside its image. [byte]
_LARGEST_REST = 2**26

_PALETTE = "it is a palette image, whose values are no counts. Save the raw counts as grey TIFF."
_COLOURS = "it is a colour image. Save the raw counts of the camera, one channel, as grey TIFF."

_PNG_START = b"\x89PNG\r\n\x1a\n"

# Sizes of the header of a BMP, from version 3 on. [byte]
_BMP_HEADERS = tuple(bytes([size, 0, 0, 0]) for size in (40, 52, 56, 108, 124))

# Size of the largest header of a BMP with its palette. [byte]
_LARGEST_BITMAP = 124 + 4 * 256

# Colour types of PNG.
_GREY, _INDEXED = 0, 3


class PngPicture(FrameFile):
    """A PNG picture."""

    def __init__(self, path: Path) -> None:
        import imagecodecs  # takes a tenth of a second to load

        self._decode = imagecodecs.png_decode
        self.path = path
        with Source(path) as source:
            head = source.read(0, 33)
            size = source.size
        if head[:8] != _PNG_START or head[12:16] != b"IHDR":
            raise FrameError("the file is damaged or not a PNG")
        width, height, depth, colour = struct.unpack_from(">IIBB", head, 16)
        if colour == _INDEXED:
            raise FrameError(_PALETTE)
        if colour != _GREY:
            raise FrameError(_COLOURS)
        if depth not in (8, 16):
            raise FrameError(f"it has {depth} bits for each pixel. Save 8 or 16-bit counts.")

        kind = FrameKind((height, width), f"uint{depth}")
        check_claim(1, kind, size, packing=DEFLATED)
        if size > _LARGEST_REST + 2 * height * width * depth // 8:
            raise FrameError(f"the file is damaged: {size} bytes are too many for its {kind}")
        self.kinds = [kind]

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        try:
            counts = np.asarray(self._decode(self.path.read_bytes()))
        except Exception as error:  # it raises several types on damaged bytes
            raise FrameError(f"the picture is damaged ({reason_of(error)})") from error
        shape, dtype = self.kinds[index]
        if counts.shape != shape:
            raise FrameError("the picture is damaged: it has another size than its header")
        return counts.astype(dtype, copy=False)


def open_bmp(path: Path) -> FrameFile:
    """Open a BMP picture of 8 grey bits.

    As `Format.open`: FrameError if it is damaged, compressed, or has colours.
    """
    with Source(path) as source:
        (start,) = struct.unpack("<I", source.read(10, 4))
        header = source.read(14, min(_LARGEST_BITMAP, source.size - 14))
        if len(header) < 40:
            raise FrameError("the file is damaged: the header of its images is too short")
        size, width, height, _, depth, codec = struct.unpack_from("<IiiHH4s", header)
        if size < 40 or codec != bytes(4) or depth != 8:
            name = codec.decode("latin-1").strip("\0 ") or f"{depth} bits"
            raise FrameError(
                f"its images are compressed or in colours ({name}), and no counts. Save the raw "
                "counts of the camera, one channel, as grey TIFF."
            )

        # the count of an entry of the palette is its grey
        (used,) = struct.unpack_from("<I", header, 32)
        palette = np.frombuffer(header[size:][: 4 * (used or 256)], np.uint8)
        greys = palette[: palette.size // 4 * 4].reshape(-1, 4)[:, :3]
        if len(greys) > 256 or (greys != np.arange(len(greys))[:, None]).any():
            raise FrameError(_PALETTE)

        row = -(-width // 4) * 4  # rows end at a multiple of four bytes
        shape = abs(height), width
        layout = FrameLayout(shape, "|u1", row_bytes=row, bottom_up=height > 0)
    return RawFrames(path, layout, [start])


def open_pgm(path: Path) -> FrameFile:
    """Open a PGM picture, or several that follow each other with the same header.

    As `Format.open`: FrameError if it is damaged or written as text.
    """
    with Source(path) as source:
        size = source.size
        head = source.read(0, min(1024, size))
        if head[:2] == b"P2":
            raise FrameError(
                "its counts are written as text. Save it as binary PGM (P5) or as TIFF."
            )
        # one blank at a time: a second repetition would need ages to fail
        gap = rb"(?:\s|#[^\n]*\n)+"
        match = re.match(rb"P5" + (gap + rb"(\d{1,9})") * 3 + rb"\s", head)
        if match is None:
            raise FrameError("the file is damaged or not a PGM")
        width, height, most = map(int, match.groups())
        if not 0 < most < 65536:
            raise FrameError(f"the file is damaged: its highest count is {most}")

        layout = FrameLayout((height, width), "|u1" if most < 256 else ">u2")
        step = match.end() + layout.size
        count = -(-size // step)
        for n in range(1, count):
            if source.read(n * step, min(match.end(), size - n * step)) != match[0]:
                raise FrameError("the file is damaged: it goes on behind its last count")
    places = layout.in_a_row(match.end(), count, step)
    return RawFrames(path, layout, places, bits=most.bit_length())


PNG = Format(
    "PNG",
    (".png",),
    lambda path, head: head[:8] == _PNG_START,
    PngPicture,
    extra="formats",
)
BMP = Format(
    "BMP",
    (".bmp", ".dib"),
    lambda path, head: head[:2] == b"BM" and head[14:18] in _BMP_HEADERS,
    open_bmp,
)
PGM = Format("PGM", (".pgm", ".pnm"), lambda path, head: head[:2] in (b"P5", b"P2"), open_pgm)
