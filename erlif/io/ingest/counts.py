"""Pixels as a file stores them to counts: whole numbers from 0 to 65535."""

from __future__ import annotations

from datetime import datetime

import numpy as np

from erlif.core.arrays import AnyArray, Counts
from erlif.core.errors import FrameError

# Highest count: a camera has at most 16 bits.
_MOST = 65535

# Types in which programs store counts, by numpy's names.
STORED_TYPES = frozenset(
    (
        *("uint8", "uint16", "uint32", "uint64", "int8", "int16", "int32", "int64"),
        *("float16", "float32", "float64"),
    )
)


# Pixels of the first row in which PCO cameras write image number and time, two digits in each.
_STAMPED = 14

# Distinct counts up to which an image is too uniform to show bits that are never set.
FEW_LEVELS = 16


def count_padding(set_bits: int) -> int:
    """Number of low bits that no count sets; one may be chance, so that 0 stands for it.

    Parameters
    ----------
    set_bits : int
        Bits that any of the counts sets.

    Returns
    -------
    int

    Examples
    --------
    >>> count_padding(0b111_0000), count_padding(0b1110)
    (4, 0)
    """
    unused = (set_bits & -set_bits).bit_length() - 1
    return unused if unused >= 2 else 0


def convert_counts(image: AnyArray) -> Counts:
    """Counts that a program has stored in another type.

    LabVIEW stores counts as int16, DaVis and ImageJ export them as float32.

    Parameters
    ----------
    image : array, (y, x)
        Of any type of whole or real numbers. [DN]

    Returns
    -------
    array of uint8 or uint16, (y, x)
        [DN]

    Raises
    ------
    FrameError
        With the bare reason, if a value is no whole number from 0 to 65535.

    Examples
    --------
    >>> convert_counts(np.array([[0.0, 4095.0]], np.float32))
    array([[   0, 4095]], dtype=uint16)
    >>> convert_counts(np.array([[0.0, 0.5]], np.float32))
    Traceback (most recent call last):
    ...
    erlif.core.errors.FrameError: its float32 values are no counts: 0.5 in row 0, column 1. ...
    """
    if image.dtype in (np.uint8, np.uint16):
        return image.astype(image.dtype.newbyteorder("="), copy=False)

    if image.dtype.name == "float16":
        image = image.astype(np.float32)  # 65535 is not a float16

    # a comparison with NaN is false, so that NaN is no count
    valid = (image >= 0) & (image <= _MOST)
    if image.dtype.kind == "f":
        valid &= image == np.rint(image)
    if not valid.all():
        row, column = np.unravel_index(int(np.argmin(valid)), image.shape)
        raise FrameError(
            f"its {image.dtype.name} values are no counts: {image[row, column]:g} in row {row}, "
            f"column {column}. Save the raw counts of the camera, whole numbers from 0 to {_MOST} "
            "without scaling, correction or averaging."
        )
    return image.astype(np.uint16)


def align_right(counts: Counts, shift: int) -> Counts:
    """Left-aligned counts, moved to the low bits.

    Parameters
    ----------
    counts : array of uint16, (y, x)
        Counts in the high bits of 16. [DN]
    shift : int
        Low bits that hold nothing, 16 - bit_depth.

    Returns
    -------
    array of uint16, (y, x)
        [DN]

    Raises
    ------
    FrameError
        With the bare reason, if the low bits are in use.

    Examples
    --------
    >>> align_right(np.array([[16, 65520]], np.uint16), 4)
    array([[   1, 4095]], dtype=uint16)
    """
    if not shift:
        return counts
    low = counts & np.uint16((1 << shift) - 1) if counts.dtype == np.uint16 else counts
    if low.any():
        row, column = np.unravel_index(int(np.argmax(low != 0)), counts.shape)
        raise FrameError(
            f"its counts are not left-aligned: {counts[row, column]} in row {row}, column {column} "
            f"is no multiple of {1 << shift}. Remove alignment, or correct bit_depth."
        )
    return counts >> np.uint16(shift)


def find_stamp(counts: Counts) -> str:
    """The time that a PCO camera has written over the first pixels of an image.

    The pixels hold two decimal digits each, four bits for a digit: image number (8 digits), year,
    month, day, hour, minute, second and microsecond; pco.edge User Manual, "Timestamp".

    Parameters
    ----------
    counts : array of uint8 or uint16, (y, x)
        Right-aligned. [DN]

    Returns
    -------
    str
        Empty where the pixels hold light.

    Examples
    --------
    >>> digits = bytes.fromhex("00000123 2023 01 20 18 21 53 096300")
    >>> find_stamp(np.frombuffer(digits, np.uint8)[np.newaxis])
    '2023-01-20 18:21:53'
    """
    first = counts[0, :_STAMPED]
    if first.size < _STAMPED or first.max() > 0x99:
        return ""
    digits = first.astype(np.uint8).tobytes().hex()
    if not digits.isdecimal():
        return ""
    try:
        time = datetime.strptime(digits[8:22], "%Y%m%d%H%M%S")
    except ValueError:
        return ""
    return str(time) if 2000 <= time.year < 2100 else ""
