"""TIFF files: single images, stacks and BigTIFF, whatever their suffix."""

from __future__ import annotations

import importlib.util
import math
import os
from pathlib import Path

import numpy as np
import tifffile

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError
from erlif.readers.base import TRUNCATED, Format, FrameFile, FrameKind, describe_shape
from erlif.readers.plain_tiff import find_plain_pages, read_plain_page

_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
"""First bytes of TIFF and of BigTIFF in both byte orders."""

_DENSEST = 1100
"""Pixels per byte of a file that deflate can reach; a header that claims more is damaged."""


class TiffFrames(FrameFile):
    """The pages of a TIFF file.

    Attributes
    ----------
    headers : list[int]
        Where the directory of each page begins where all pages are plain; else empty. [byte]
    """

    headers: list[int]

    def __init__(self, path: Path) -> None:
        self.path = path
        plain = find_plain_pages(path)
        if plain is not None:
            self.headers = [page.header for page in plain]
            self.kinds = [FrameKind(page.shape, page.dtype) for page in plain]
            self._file = None
        else:
            self.headers = []
            self._file = _open_other(path)
            try:
                self.kinds = _kinds_of_pages(self._file, path.stat().st_size)
            except Exception:
                self._file.close()
                raise

        # headers of damaged files may claim sizes that no memory holds
        size = path.stat().st_size
        for kind in set(self.kinds):
            if math.prod(kind.shape) > _DENSEST * size:
                self.close()
                raise FrameError(
                    f"the file is damaged: {size} bytes cannot hold {describe_shape(kind.shape)} "
                    "pixels"
                )

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        if self.headers:
            counts = read_plain_page(self.path, self.headers[index])
            if counts is not None:
                return counts
        try:
            if self._file is None:
                return np.asarray(tifffile.imread(self.path, key=index))
            page = self._file.pages[index]
            page = page if isinstance(page, tifffile.TiffPage) else page.aspage()
            return np.asarray(page.asarray())
        except Exception as error:  # decoders of damaged bytes raise exceptions of many types
            raise FrameError(_reason(error)) from error

    def close(self) -> None:
        """As `FrameFile.close`."""
        if self._file is not None:
            self._file.close()


TIFF = Format(
    "TIFF",
    (".tif", ".tiff", ".btf", ".tf8", ".tf2"),
    lambda path, head: head[:4] in _STARTS,
    TiffFrames,
)


def _open_other(path: Path) -> tifffile.TiffFile:
    try:
        return tifffile.TiffFile(path)
    except OSError:
        raise
    except Exception as error:  # tifffile raises exceptions of many types on damaged bytes
        raise FrameError(f"the file is damaged or not a TIFF ({error})") from error


def _kinds_of_pages(file: tifffile.TiffFile, size: int) -> list[FrameKind]:
    kinds = []
    try:
        for page in file.pages:
            page = page if isinstance(page, tifffile.TiffPage) else page.aspage()
            # data behind the end of the file were cut off; a page without data has none at all
            ends = [a + b for a, b in zip(page.dataoffsets, page.databytecounts, strict=False)]
            whole = ends and max(ends) <= size
            shape = tuple(int(n) for n in page.shape)
            kinds.append(FrameKind(shape, np.dtype(page.dtype).name) if whole else TRUNCATED)
    except OSError:
        raise
    except Exception as error:  # as above
        raise FrameError(f"the file is damaged or not a TIFF ({error})") from error
    return kinds


def _reason(error: Exception) -> str:
    """Why a page cannot be decoded, with the package that is missing where one is."""
    text = os.linesep.join(str(error).splitlines()[:1]) or type(error).__name__
    if "imagecodecs" not in text:
        return text
    if importlib.util.find_spec("imagecodecs") is None:
        return (
            f"{text}. The Python package imagecodecs is not installed; install it with: "
            "pip install 'erlif[formats]'."
        )
    return f"{text}. The installed imagecodecs has no decoder for it; save the file uncompressed."
