"""Zarr stores whose compressed chunks may be read: none holds more than its description states.

The decoders make room for what a chunk claims, or go on to its end: 45 kB may hold 1.5 GB. They
have no public function for the size that a chunk states (numcodecs 0.16), so headers are read here.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from zarr.storage import LocalStore

# Bytes that a codec after the values, a checksum, may add.
_ADDED = 16

# First bytes of zstd, and sizes of the fields of its header by two bits of the first of them;
# RFC 8878, section 3.1.1.
_ZSTD = b"\x28\xb5\x2f\xfd"
_DICTIONARY, _CONTENT = (0, 1, 2, 4), (0, 2, 4, 8)


class BoundedStore(LocalStore):
    """A zarr store for reading.

    Parameters
    ----------
    root : Path
        Its folder.
    held : mapping of str to (str, int)
        Compression of each array, and what one of its chunks may hold, as `check_zarr` returns
        them. [byte]
    """

    def __init__(self, root: Path, *, held: Mapping[str, tuple[str, int]]) -> None:
        super().__init__(root, read_only=True)
        self._held = held

    async def get(self, key: str, *args: Any, **options: Any) -> Any:
        """Content of a file of the store; ValueError for a chunk that holds too much."""
        found = await super().get(key, *args, **options)
        name = next((name for name in self._held if key.startswith(f"{name}/")), None)
        if found is not None and name is not None and not key.endswith("zarr.json"):
            compression, most = self._held[name]
            if not _holds_at_most(found.as_numpy_array(), compression, most + _ADDED):
                raise ValueError(
                    f"{key} holds more than the {most} bytes of a chunk, or states no size"
                )
        return found


def _holds_at_most(chunk: Any, compression: str, most: int) -> bool:
    """Whether a compressed chunk holds so many bytes at most, and states it."""
    head = chunk[:32].tobytes()
    if compression == "blosc":
        return int.from_bytes(head[4:8], "little") <= most
    if compression == "gzip":
        stream = zlib.decompressobj(16 + zlib.MAX_WBITS)
        return len(stream.decompress(chunk, most + 1)) <= most and not stream.unused_data
    if compression != "zstd":
        return True

    if not head.startswith(_ZSTD):
        return False
    flags = head[4]
    single = bool(flags & 0x20)  # the window is the content, and its size is not given
    start = 5 + (not single) + _DICTIONARY[flags & 3]
    length = _CONTENT[flags >> 6] or int(single)
    stated = int.from_bytes(head[start : start + length], "little") + 256 * (length == 2)
    return length > 0 and stated <= most
