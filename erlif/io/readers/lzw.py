"""LZW and PackBits, the compressions of TIFF 6.0 that cameras and ImageJ use beside deflate."""

from __future__ import annotations

import numpy as np
from numba import njit

from erlif.core.errors import FrameError

_CLEAR, _END = 256, 257
"""Codes of LZW that are no text; TIFF 6.0, section 13."""

_Bytes = np.ndarray[tuple[int], np.dtype[np.uint8]]


def decode_lzw(data: bytes, size: int) -> _Bytes:
    """Decode a strip that is compressed with LZW.

    Parameters
    ----------
    data : bytes
        The strip as it is stored, highest bit first.
    size : int
        Length of the decoded strip. [byte]

    Returns
    -------
    array of uint8, (size,)

    Raises
    ------
    FrameError
        With the bare reason, if the strip is damaged or has another length.

    Examples
    --------
    The codes 256, 7, 258 and 257 of nine bits stand for three times the byte 7:

    >>> bits = "".join(f"{code:09b}" for code in (256, 7, 258, 257)).ljust(40, "0")
    >>> decode_lzw(int(bits, 2).to_bytes(5), 3)
    array([7, 7, 7], dtype=uint8)
    """
    found = np.empty(size, np.uint8)
    if _decode_lzw(np.frombuffer(data, np.uint8), found) != size:
        raise FrameError("a strip of the image is damaged (LZW)")
    return found


def decode_packbits(data: bytes, size: int) -> _Bytes:
    """Decode a strip that is compressed with PackBits.

    Parameters
    ----------
    data : bytes
        The strip as it is stored.
    size : int
        Length of the decoded strip. [byte]

    Returns
    -------
    array of uint8, (size,)

    Raises
    ------
    FrameError
        With the bare reason, if the strip is damaged or has another length.

    Examples
    --------
    Two bytes as they are, and one byte three times:

    >>> decode_packbits(bytes([1, 8, 9, 254, 7]), 5)
    array([8, 9, 7, 7, 7], dtype=uint8)
    """
    found = np.empty(size, np.uint8)
    if _decode_packbits(np.frombuffer(data, np.uint8), found) != size:
        raise FrameError("a strip of the image is damaged (PackBits)")
    return found


# one signature each, so that one function is compiled, once per machine
@njit("int64(Array(uint8, 1, 'C', readonly=True), uint8[::1])", nogil=True, cache=True)
def _decode_lzw(data: _Bytes, out: _Bytes) -> int:
    """Number of bytes decoded; -1 for a code that cannot occur."""
    # A code stands for the text of an earlier code and the byte after it. Both lie side by side in
    # the output, so that a table of places and lengths there replaces one of texts.
    start, length = np.zeros(4096, np.int64), np.zeros(4096, np.int64)
    following, width = 258, 9
    last_start, last_length = 0, 0
    buffer, bits, place, written = 0, 0, 0, 0

    while written < out.size:
        while bits < width:
            if place >= data.size:
                return written
            buffer = ((buffer << 8) | int(data[place])) & 0xFFFFFF
            place, bits = place + 1, bits + 8
        bits -= width
        code = (buffer >> bits) & ((1 << width) - 1)

        if code == _CLEAR:
            following, width, last_length = 258, 9, 0
            continue
        if code == _END:
            return written

        # the newest code stands for the last text and its own first byte
        if code < 256:
            count = 1
        elif last_length and code < following:
            begin, count = start[code], length[code]
        elif last_length and code == following:
            begin, count = last_start, last_length + 1
        else:
            return -1
        if written + count > out.size:
            return -1

        # byte by byte, because a text may overlap its own copy
        if code < 256:
            out[written] = code
        else:
            for n in range(count):
                out[written + n] = out[begin + n]

        if last_length and following < 4096:
            start[following], length[following] = last_start, last_length + 1
            following += 1
        # the width grows one code early; TIFF 6.0 has it so
        if following + 1 >= (1 << width) and width < 12:
            width += 1
        last_start, last_length = written, count
        written += count
    return written


@njit("int64(Array(uint8, 1, 'C', readonly=True), uint8[::1])", nogil=True, cache=True)
def _decode_packbits(data: _Bytes, out: _Bytes) -> int:
    """Number of bytes decoded; -1 where the data are too short or too long."""
    place, written = 0, 0
    while place < data.size and written < out.size:
        head = int(data[place])
        place += 1
        if head == 128:  # no operation
            continue
        count = head + 1 if head < 128 else 257 - head
        taken = count if head < 128 else 1
        if place + taken > data.size or written + count > out.size:
            return -1
        for n in range(count):
            out[written + n] = data[place + n] if head < 128 else data[place]
        place, written = place + taken, written + count
    return written
