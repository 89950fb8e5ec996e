"""NPY files of numpy: one array of frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from erlif.core.errors import FrameError
from erlif.io.readers.base import Format, FrameFile
from erlif.io.readers.raw import FrameLayout, RawFrames

_START = b"\x93NUMPY"

# Header that is interpreted; that of an array of numbers has about 100 characters.
_LONGEST = 4096


def open_npy(path: Path) -> FrameFile:
    """Open an array of shape (frame, y, x) or (y, x).

    As `Format.open`; only arrays of numbers are read, nothing is unpickled.
    """
    with path.open("rb") as file:
        try:
            version = np.lib.format.read_magic(file)
            read = {
                (1, 0): np.lib.format.read_array_header_1_0,
                (2, 0): np.lib.format.read_array_header_2_0,
            }[version]
            # a header that numpy 1 wrote under Python 2 needs a conversion, with a warning
            shape, by_columns, dtype = read(file, max_header_size=_LONGEST)
            start = file.tell()
        except Exception as error:  # a damaged header is refused with exceptions of several types
            raise FrameError("the file is damaged or not an NPY") from error

    if dtype.kind not in "iuf" or len(shape) not in (2, 3) or by_columns:
        order = ", by columns" if by_columns else ""
        raise FrameError(
            f"it holds an array of {dtype} of shape {shape}{order}. Save the frames as one array "
            "of numbers (frame, y, x), made contiguous by numpy.ascontiguousarray."
        )
    frames = shape[0] if len(shape) == 3 else 1
    layout = FrameLayout((int(shape[-2]), int(shape[-1])), dtype.str)
    return RawFrames(path, layout, layout.in_a_row(start, frames))


NPY = Format("NPY", (".npy",), lambda path, head: head[:6] == _START, open_npy)
