"""The numbers of one trigger as a line of text that shows damage."""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import AnyArray


@dataclass(frozen=True)
class Record:
    """Small arrays of a finished trigger, and numbers that identify the chunks of its maps.

    Attributes
    ----------
    trigger : int
        Number of the trigger, from 0.
    numbers : dict[str, AnyArray]
        Small arrays by name.
    chunks : dict[str, list[int]]
        For the chunk of each map: whole numbers by which a store finds and checks it.
    """

    trigger: int
    numbers: dict[str, AnyArray]
    chunks: dict[str, list[int]]


def write_record(
    trigger: int, numbers: Mapping[str, npt.ArrayLike], chunks: Mapping[str, list[int]]
) -> bytes:
    """Write the record of one trigger as one line.

    Parameters
    ----------
    trigger : int
        Number of the trigger, from 0.
    numbers : mapping of str to array
        Small arrays by name.
    chunks : mapping of str to list of int
        As in `Record`.

    Returns
    -------
    bytes
        A checksum, JSON and the end of the line; `read_record` reads it.

    Examples
    --------
    >>> line = write_record(3, {"mean": 4.5}, {"flags": [2048, 117]})
    >>> read_record(line).numbers["mean"]
    array(4.5)
    """
    arrays = {name: _write_array(np.asarray(values)) for name, values in numbers.items()}
    content = {"trigger": trigger, "chunks": dict(chunks), "numbers": arrays}
    text = json.dumps(content, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(text), text)


def read_record(line: bytes) -> Record | None:
    """Read a line of `write_record`.

    Parameters
    ----------
    line : bytes
        One whole line.

    Returns
    -------
    Record or None
        None where the line is cut off or damaged.

    Examples
    --------
    >>> line = write_record(3, {"mean": 4.5}, {})
    >>> read_record(line[:-5]) is None
    True
    """
    checksum, _, text = line.removesuffix(b"\n").partition(b" ")
    if not line.endswith(b"\n") or checksum != b"%08x" % zlib.crc32(text):
        return None
    content = json.loads(text)
    numbers = {name: _read_array(*stored) for name, stored in content["numbers"].items()}
    return Record(content["trigger"], numbers, content["chunks"])


def _write_array(values: AnyArray) -> list[Any]:
    """Type, shape and bytes: floats come back exactly, NaN included."""
    return [values.dtype.str, values.shape, base64.b64encode(values.tobytes()).decode("ascii")]


def _read_array(dtype: str, shape: list[int], text: str) -> AnyArray:
    return np.frombuffer(base64.b64decode(text), dtype).reshape(shape).copy()
