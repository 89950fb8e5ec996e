"""Numbers in MATLAB 5 files, by the format that MathWorks documents (MAT-File Format, level 5).

The reader of scipy ends the process on some damaged files; this one reads numbers and structures of
numbers only, and checks every length.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator

import numpy as np

from erlif.core.arrays import AnyArray

HEADER = 128
"""Length of the header of a file. [byte]"""

_ENDIAN = slice(126, 128)
_BYTE_ORDER = {b"IM": "<", b"MI": ">"}

_NUMBERS = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
"""Types of data elements that hold numbers."""

_MATRIX, _COMPRESSED = 14, 15  # types of data elements
_STRUCTURE = 2  # class of an array
_NUMERIC = range(6, 16)  # classes of arrays
_COMPLEX = 0x0800  # bit of the flags of an array
_FEWEST_PARTS = 4  # of an array of numbers: flags, dimensions, name, numbers
_DEEPEST = 8  # structures within structures

_Element = tuple[int, bytes]
"""Type and contents of a data element."""


def read_matlab(content: bytes, *, largest: int) -> Iterator[tuple[str, AnyArray]]:
    """Yield the arrays of numbers in a MATLAB 5 file.

    Parameters
    ----------
    content : bytes
        The whole file.
    largest : int
        Size of all variables together above which they are refused, after expansion. [byte]

    Yields
    ------
    (str, array)
        Name and numbers; a field of a structure as "log/angle".

    Raises
    ------
    ValueError
        If the file is damaged or its variables too large.

    Examples
    --------
    >>> import io
    >>> from scipy.io import savemat
    >>> file = io.BytesIO()
    >>> savemat(file, {"angle": [1.0, 2.0]})
    >>> [(name, values.tolist()) for name, values in read_matlab(file.getvalue(), largest=1000)]
    [('angle', [[1.0, 2.0]])]
    """
    order = _BYTE_ORDER.get(content[_ENDIAN])
    if order is None:
        raise ValueError("its header has no byte order")
    left = largest
    for kind, data in _elements(content[HEADER:], order):
        if kind == _COMPRESSED:
            expander = zlib.decompressobj()
            try:
                inner = expander.decompress(data, left + 1)  # 0 would be without a bound
            except zlib.error as error:
                raise ValueError(f"a variable cannot be expanded, {error}") from error
            left -= len(inner)
            if not expander.eof or left < 0:
                raise ValueError("a compressed variable is cut short or too large")
            yield from _read_variables(inner, order)
        elif kind == _MATRIX:
            yield from _read_array(data, order, "", 0)


def _read_variables(content: bytes, order: str) -> Iterator[tuple[str, AnyArray]]:
    for kind, data in _elements(content, order):
        if kind == _MATRIX:
            yield from _read_array(data, order, "", 0)


def _elements(content: bytes, order: str) -> Iterator[_Element]:
    """Data elements one after another."""
    place = 0
    while place < len(content):
        kind, length = _integers(content[place : place + 8], order, 2)
        small = kind >> 16
        if small:  # a few bytes within the tag itself
            start, length, kind, step = place + 4, small, kind & 0xFFFF, 8
        else:
            start = place + 8
            step = 8 + length if kind == _COMPRESSED else 8 + -(-length // 8) * 8
        if start + length > len(content) or (small and length > 4):
            raise ValueError("it ends within a variable")
        yield kind, content[start : start + length]
        place += step


def _integers(content: bytes, order: str, count: int) -> list[int]:
    if len(content) < 4 * count:
        raise ValueError("it ends within a variable")
    return [int(one) for one in np.frombuffer(content, f"{order}u4", count)]


def _read_array(
    content: bytes, order: str, path: str, depth: int, given: str | None = None
) -> Iterator[tuple[str, AnyArray]]:
    """Numbers of one array, or of the fields of one structure."""
    parts = list(_elements(content, order))
    if len(parts) < _FEWEST_PARTS:
        return  # empty, or of a class without numbers
    flags = _integers(parts[0][1], order, 1)[0]
    dims = [int(one) for one in np.frombuffer(parts[1][1], f"{order}i4")]
    name = path + (given or parts[2][1].decode("latin-1").strip("\0"))
    kind = flags & 0xFF
    if kind in _NUMERIC and not flags & _COMPLEX:
        yield name, _read_numbers(parts[3], dims, order)
    elif kind == _STRUCTURE and dims == [1, 1] and depth < _DEEPEST:
        width = _integers(parts[3][1], order, 1)[0]
        names = parts[4][1] if len(parts) > _FEWEST_PARTS else b""
        if width < 1 or len(names) // width != len(parts) - 5:
            raise ValueError(f"the fields of {name} are damaged")
        for number, (inner, data) in enumerate(parts[5:]):
            field = names[number * width : (number + 1) * width].split(b"\0")[0].decode("latin-1")
            if inner == _MATRIX and field:
                yield from _read_array(data, order, f"{name}/", depth + 1, field)


def _read_numbers(part: _Element, dims: list[int], order: str) -> AnyArray:
    kind, data = part
    if kind not in _NUMBERS or not dims or min(dims) < 0:
        raise ValueError("an array has no numbers where they are expected")
    item = np.dtype(order + _NUMBERS[kind])
    expected = 1
    for dim in dims:
        expected *= dim
    if len(data) != expected * item.itemsize:
        raise ValueError("an array has another number of values than its size")
    return np.frombuffer(data, item).reshape(dims, order="F")
