"""Files of MATLAB: version 5, and version 7.3 where a variable is too large for it.

Maps are (y, x, trigger) in MATLAB. Its arrays run along the first index first, so each map stands
in one piece, and maps are written one at a time.
"""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.hdf5 import with_locks
from erlif.core.progress import Progress
from erlif.core.version import __version__
from erlif.io.conversion.contents import (
    attributes_of,
    describe_units,
    maps_of_triggers,
    small_variables,
)
from erlif.io.files.headers import MAPS

# Largest variable of version 5, less room for its header. [byte]
LARGEST = 2**31 - 2**10

_HEADER_TEXT = 116  # bytes, of a header of 128

# MAT-File Format (The MathWorks), tables 1-1 and 1-3: kinds of data elements, classes of arrays
_INT8, _UINT16, _INT32, _UINT32, _SINGLE, _MATRIX, _COMPRESSED = 1, 4, 5, 6, 7, 14, 15
_CLASSES = {"float32": (7, _SINGLE, "single"), "uint16": (11, _UINT16, "uint16")}

_USER_BLOCK = 512  # bytes before the HDF5 part of version 7.3
_LONGEST_NAME = 63


_Arrays = Mapping[str, AnyArray]
_Structs = Mapping[str, Mapping[str, str]]
_Images = Callable[[str], Iterator[AnyArray]]


class _Maps(NamedTuple):
    """The maps of a variable that are written."""

    variable: xr.DataArray
    number: int

    @property
    def size(self) -> int:
        """[byte]"""
        _, rows, columns = self.variable.shape
        return int(self.variable.dtype.itemsize * rows * columns * self.number)


def write_matlab(
    film: xr.Dataset, output: Path, *, triggers: list[int], progress: Progress
) -> None:
    """Write the variables of a film, a struct ``units`` and a struct ``attributes``.

    Maps are read and written one at a time.

    Parameters
    ----------
    film : xarray.Dataset
    output : Path
        File to write.
    triggers : list of int
        Triggers to write.
    progress : Progress
        Called after each map.
    """
    values = small_variables(film, triggers)
    small = {_name(name): _for_matlab(each) for name, each in values.items()}
    structs = {"units": describe_units(film), "attributes": attributes_of(film)}
    texts = {
        name: {_name(key): text for key, text in entries.items()}
        for name, entries in structs.items()
    }
    maps = {name: _Maps(film[name], len(triggers)) for name in MAPS}
    images = partial(maps_of_triggers, film, triggers=triggers, progress=progress)
    write = _write_5 if max(one.size for one in maps.values()) <= LARGEST else _write_73
    write(output, small, texts, maps, images)


def _name(name: str) -> str:
    """A name that MATLAB allows; further columns of the encoder log may have any."""
    allowed = re.sub(r"[^A-Za-z0-9_]", "_", name)[:_LONGEST_NAME]
    return allowed if allowed[:1].isalpha() else f"x_{allowed}"[:_LONGEST_NAME]


def _for_matlab(values: AnyArray) -> AnyArray:
    """Numbers as double in columns, texts as a cell array."""
    if values.dtype.kind in "OUST":
        cells = np.empty((values.size, 1), object)
        cells[:, 0] = [str(each) for each in values.ravel()]
        return cells
    numbers = values.astype(float)
    if numbers.ndim > 1:  # the trigger stands last, as in the maps
        return np.moveaxis(numbers, 0, -1)
    return numbers.reshape(-1, 1)


def _write_5(
    output: Path, small: _Arrays, texts: _Structs, maps: dict[str, _Maps], images: _Images
) -> None:
    """Write a file of version 5: small variables by scipy, then the maps as further elements."""
    import scipy.io

    contents: dict[str, Any] = {**small, **texts}
    scipy.io.savemat(
        str(output), contents, appendmat=False, do_compression=True, long_field_names=True
    )
    with output.open("r+b") as file:
        file.seek(0, 2)
        for name, one in maps.items():
            _append_map(file, name, one, images(name))

        # scipy writes the time of day into the header
        file.seek(0)
        file.write(_header_text("5.0"))


def _append_map(file: BinaryIO, name: str, maps: _Maps, images: Iterator[AnyArray]) -> None:
    """Append one compressed element with the maps of a variable."""
    kind, stored, _ = _CLASSES[str(maps.variable.dtype)]
    rows, columns = maps.variable.shape[1:]
    letters = name.encode()
    inner = (
        struct.pack("<IIII", _UINT32, 8, kind, 0)
        + struct.pack("<IIiiii", _INT32, 12, rows, columns, maps.number, 0)
        + struct.pack("<II", _INT8, len(letters))
        + letters
        + bytes(-len(letters) % 8)
        + struct.pack("<II", stored, maps.size)
    )
    fill = -maps.size % 8
    packer = zlib.compressobj(level=1)

    # the length of the compressed element is known at its end
    start = file.tell()
    file.write(struct.pack("<II", _COMPRESSED, 0))
    file.write(packer.compress(struct.pack("<II", _MATRIX, len(inner) + maps.size + fill) + inner))
    for image in images:
        file.write(packer.compress(image.astype(image.dtype.newbyteorder("<")).tobytes("F")))
    file.write(packer.compress(bytes(fill)) + packer.flush())
    end = file.tell()
    file.seek(start)
    file.write(struct.pack("<II", _COMPRESSED, end - start - 8))
    file.seek(end)


def _header_text(version: str) -> bytes:
    text = f"MATLAB {version} MAT-file, written by erlif {__version__}"
    return text.encode().ljust(_HEADER_TEXT)


def _write_73(
    output: Path, small: _Arrays, texts: _Structs, maps: dict[str, _Maps], images: _Images
) -> None:
    """Version 7.3: HDF5 behind a header, dimensions in the reverse order."""
    import h5py

    with with_locks(h5py.File, output, "w", userblock_size=_USER_BLOCK) as file:
        for name, values in small.items():
            if values.dtype.kind == "O":  # cells are references, which Octave does not follow
                values = np.array("\n".join(values[:, 0]))
                _put_text(file, name, str(values))
            else:
                _mark(file.create_dataset(name, data=values.T), "double")
        for name, entries in texts.items():
            group = _mark(file.create_group(name), "struct")
            for key, text in entries.items():
                _put_text(group, key, text)
        for name, one in maps.items():
            rows, columns = one.variable.shape[1:]
            data = file.create_dataset(
                name,
                (one.number, columns, rows),
                one.variable.dtype,
                chunks=(1, columns, rows),
                compression="gzip",
                compression_opts=1,
                shuffle=True,
            )
            _mark(data, _CLASSES[str(one.variable.dtype)][2])
            for k, image in enumerate(images(name)):
                data[k] = image.T

    with output.open("r+b") as raw:
        raw.write(_header_text("7.3") + bytes(8) + b"\x00\x02IM")


def _put_text(group: Any, name: str, text: str) -> None:
    """A row of characters, which HDF5 holds as numbers of UTF-16."""
    import h5py

    characters = np.frombuffer(text.encode("utf-16-le"), np.uint16)
    if not characters.size:
        # an empty array is stored as its shape
        data = group.create_dataset(name, data=np.zeros(2, np.uint64))
        data.attrs["MATLAB_empty"] = np.uint8(1)
    else:
        data = group.create_dataset(name, data=characters[:, None])
    _mark(data, "char")
    data.attrs.create("MATLAB_int_decode", 2, dtype=h5py.h5t.NATIVE_INT32)


def _mark(place: Any, kind: str) -> Any:
    """State the class of MATLAB of a dataset or group."""
    place.attrs["MATLAB_class"] = np.bytes_(kind)
    return place
