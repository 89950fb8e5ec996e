"""PNG, BMP and PGM pictures with grey counts; formats that change the counts are refused."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError
from erlif.readers.base import Format, FrameFile, FrameKind, check_claim

_DENSEST = 1100
"""Decoded bytes per byte of a file that deflate can reach."""

_GREY = {"L": "uint8", "I;16": "uint16", "I;16B": "uint16", "I;16L": "uint16", "I": "uint16"}
"""Types of the counts by Pillow's name of the pixels; "I" are the 16-bit counts of a PGM."""


class Picture(FrameFile):
    """A file with one picture, decoded by Pillow."""

    def __init__(self, path: Path) -> None:
        from PIL import Image

        # Pillow warns of sizes that are checked here
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                with Image.open(path) as image:
                    mode, (width, height) = image.mode, image.size
            except OSError as error:
                raise FrameError(f"the file is damaged ({error})") from error
            except Exception as error:  # Pillow raises several types on damaged bytes
                raise FrameError(f"the file is damaged ({type(error).__name__})") from error

        if mode == "P":
            raise FrameError(
                "it is a palette image, whose values are no counts. Save the raw counts as TIFF."
            )
        if mode not in _GREY:
            colours = Image.getmodebands(mode)
            kind = FrameKind((height, width, colours), "uint8")
        else:
            kind = FrameKind((height, width), _GREY[mode])
        check_claim(1, kind, path.stat().st_size, packing=_DENSEST)
        self.path, self.kinds = path, [kind]

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        from PIL import Image

        try:
            with Image.open(self.path) as image:
                return np.asarray(image).astype(self.kinds[index].dtype, copy=False)
        except Exception as error:  # Pillow raises several types on damaged bytes
            raise FrameError(f"the picture is damaged ({error})") from error


def _refuse(path: Path) -> FrameFile:
    raise FrameError(
        f"{path.suffix.lower() or 'this format'} is compressed with losses or has a palette: its "
        "values are no counts. Save the raw counts as TIFF."
    )


PNG = Format("PNG", (".png",), lambda path, head: head[:8] == b"\x89PNG\r\n\x1a\n", Picture)
BMP = Format("BMP", (".bmp", ".dib"), lambda path, head: head[:2] == b"BM", Picture)
PGM = Format("PGM", (".pgm", ".pnm"), lambda path, head: head[:2] in (b"P5", b"P2"), Picture)
LOSSY = Format(
    "JPEG, GIF",
    (".jpg", ".jpeg", ".jpe", ".gif"),
    lambda path, head: head[:3] == b"\xff\xd8\xff" or head[:4] == b"GIF8",
    _refuse,
)
