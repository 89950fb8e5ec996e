"""Frames that are stored as they left the camera: at known places, in rows of counts.

Most formats of high-speed cameras are such frames behind a header of their own. Their modules read
the header; what follows it is read here.

Counts of 10 and 12 bits may be packed without gaps; they are expanded to 16 bits.

Two pixels of 12 bits take three bytes, four pixels of 10 bits take five. Cameras order the bits in
three ways: the highest bit first (Photron, Phantom, CoaXPress), the lowest bit first (Mono12p and
Mono10p of the GenICam pixel format naming convention), or the high eight bits of each pixel in a
byte of its own and the low bits of two pixels in the byte between (Mono12Packed, Mono10Packed of
GigE Vision). The wrong order raises no error, it yields wrong counts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from pathlib import Path

import numpy as np

from erlif.core.arrays import AnyArray, Array, Counts, Mask
from erlif.core.errors import FrameError
from erlif.io.readers.base import MOST_FRAMES, TRUNCATED, FrameFile, FrameKind, check_claim
from erlif.io.readers.source import Source

# Frames in a header for each frame in the file above which the header is taken as damaged. A
# recording that was interrupted or copied in part has fewer.
_MOST_MISSING = 10

# Rates of cameras, from a frame in eleven days on, and frames left out between two. [1/s]
_SLOWEST, _FASTEST, _MOST_SKIPPED = 1e-6, 1e9, 10**9

# Decoded over stored size of 10-bit counts in 16 bits, the most of all packings.
_DENSEST = 1.6


@dataclass(frozen=True)
class FrameLayout:
    """Storage layout of the counts of a frame.

    Attributes
    ----------
    shape : tuple[int, int]
        (rows, columns). [px]
    dtype : str
        Type of a count in the file, in the notation of numpy: "<u2" is 16 bits, little-endian.
        "<u2" as well for packed counts, which are decoded to it.
    packing : Packing | None
        Order of the bits of packed counts; None where each count has its own bytes.
    row_bytes : int
        Bytes from one row to the next; 0 where there is no gap between rows.
    bottom_up : bool
        Whether the lowest row comes first.
    table : Counts | None
        Counts by packed value, for values that the camera compressed; None for plain counts.
    unsigned : bool
        Whether the counts are unsigned and stored less half their range.
    """

    shape: tuple[int, int]
    dtype: str
    packing: Packing | None = None
    row_bytes: int = 0
    bottom_up: bool = False
    table: Counts | None = None
    unsigned: bool = False

    @property
    def kind(self) -> FrameKind:
        """Kind of a decoded frame."""
        name = np.dtype(self.dtype).name
        return FrameKind(self.shape, f"u{name}" if self.unsigned else name)

    @property
    def size(self) -> int:
        """Bytes of a frame in the file."""
        rows, columns = self.shape
        if self.packing is not None:
            return self.packing.size(rows * columns)
        return rows * (self.row_bytes or columns * np.dtype(self.dtype).itemsize)

    def in_a_row(self, start: int, count: int, step: int | None = None) -> range:
        """Positions of consecutive frames, `step` apart; default: without a gap. [byte]"""
        if step is not None and step < self.size:
            raise FrameError(
                f"the header is damaged: frames of {self.size} bytes cannot lie {step} apart"
            )
        step = max(self.size if step is None else step, 1)
        return range(start, start + count * step, step)


class RawFrames(FrameFile):
    """Frames at known places of a file.

    Parameters
    ----------
    path : Path
        File that holds the counts.
    layout : FrameLayout
        Layout of every frame.
    offsets : sequence of int
        Where each frame begins. [byte]
    before : int
        Bytes of a header of the frame between that place and its counts, at least.
    interval : float or None
        Time between two frames, where the file states one. [s]
    find_times : callable
        Finds the time of each frame from the first one; None where the interval gives it. [s]
    described_by : str
        Name of the file beside the counts that holds their header; empty where there is none.
    bits, companions
        As in `FrameFile`.

    Raises
    ------
    FrameError
        With the bare reason, if the file holds none of the frames, or far fewer than the header
        claims; if it holds more than a header beside it describes.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "frames.raw")
    >>> _ = path.write_bytes(bytes(range(12)))
    >>> file = RawFrames(path, FrameLayout((2, 3), "|u1"), range(0, 12, 6))
    >>> file.read(1)
    array([[ 6,  7,  8],
           [ 9, 10, 11]], dtype=uint8)
    >>> file.close()
    """

    def __init__(
        self,
        path: Path,
        layout: FrameLayout,
        offsets: Sequence[int] | AnyArray,
        *,
        before: int = 0,
        bits: int | None = None,
        interval: float | None = None,
        find_times: Callable[[RawFrames], Array | None] = lambda file: None,
        companions: Sequence[Path] = (),
        described_by: str = "",
    ) -> None:
        self.layout, self.offsets = layout, offsets
        self.bits, self.companions = bits, companions
        self._interval, self._find_times = interval, find_times
        size = path.stat().st_size
        self.kinds = self._find_kinds(size, before)
        if described_by:
            self._check_rest(size, described_by)
        self._source = Source(path)

    # found when they are asked for: stamps lie between the frames, over the whole file
    @cached_property
    def times(self) -> Array | None:  # type: ignore[override]
        """As `FrameFile.times`."""
        times = self._find_times(self)
        if times is None and self._interval is not None:
            times = self._interval * np.arange(len(self.kinds), dtype=np.float64)
        return times

    def _find_kinds(self, size: int, before: int) -> Sequence[FrameKind]:
        """Kind of each frame; those behind the end of the file are truncated."""
        kind = self.layout.kind
        check_claim(1, kind, size, packing=_DENSEST)
        try:
            count = len(self.offsets)
        except OverflowError as error:  # a range longer than any list
            raise FrameError("the file is damaged: its header names endless frames") from error
        if not 0 < count <= MOST_FRAMES:
            raise FrameError(f"the file is damaged: its header names {count} frames")

        places = np.asarray(self.offsets, dtype=np.int64)
        whole = (places >= 0) & (places <= size - self.layout.size - before)
        held = int(whole.sum())
        if count > _MOST_MISSING * held:
            raise FrameError(
                f"the file is damaged: its header names {count} frames of {kind}, and its {size} "
                f"bytes hold {held} of them"
            )
        return [kind if inside else TRUNCATED for inside in whole.tolist()]

    def _check_rest(self, size: int, header: str) -> None:
        """Refuse counts behind the last frame.

        The header of another recording, or a wrong width, gives frames of shifted rows, which
        nothing else reveals.
        """
        end = int(self.offsets[-1]) + self.layout.size
        if size > end:
            count, each = len(self.offsets), self.layout.size
            raise FrameError(
                f"{header} describes {count} frames of {each} bytes, which end at byte {end}; the "
                f"file of counts has {size} bytes. Put the header of this recording beside it, or "
                "correct the header."
            )

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        if self.kinds[index] == TRUNCATED:
            raise FrameError("the file is truncated")
        return read_counts(self._source, self.layout, self.find_counts(index))

    def read_stamps(self, place: int, dtype: str | list[tuple[str, str]]) -> tuple[AnyArray, Mask]:
        """Read what lies behind the counts of each frame.

        Parameters
        ----------
        place : int
            From the start of a frame. [byte]
        dtype : str or list
            Type of the numbers, in the notation of numpy.

        Returns
        -------
        array, (frame,)
            Zero where the file ends before.
        array of bool, (frame,)
            Whether the file has them.
        """
        size, end = np.dtype(dtype).itemsize, self._source.size
        starts = [int(offset) + place for offset in self.offsets]
        held = [
            kind != TRUNCATED and start + size <= end
            for kind, start in zip(self.kinds, starts, strict=True)
        ]
        parts = [
            self._source.read(start, size) if whole else bytes(size)
            for start, whole in zip(starts, held, strict=True)
        ]
        return np.frombuffer(b"".join(parts), dtype), np.array(held)

    def find_counts(self, index: int) -> int:
        """Position of the counts of a frame; formats with a header per frame differ. [byte]"""
        return int(self.offsets[index])

    def close(self) -> None:
        """As `FrameFile.close`."""
        self._source.close()


def count_frames(size: int, *, start: int, step: int) -> int:
    """Number of frames in a file whose header has none, a last incomplete one included.

    Parameters
    ----------
    size : int
        Size of the file. [byte]
    start : int
        Where the first frame begins. [byte]
    step : int
        From one frame to the next. [byte]

    Returns
    -------
    int

    Examples
    --------
    The third frame was cut:

    >>> count_frames(18, start=0, step=8)
    3
    >>> count_frames(16, start=0, step=8)
    2
    """
    return max(0, -(-(size - start) // max(step, 1)))


def frame_interval(rate: float, *, step: int = 1) -> float | None:
    """Time between two frames.

    Parameters
    ----------
    rate : float
        Frames per second that the camera took, as a header has it. [1/s]
    step : int
        Every how many of them one was saved.

    Returns
    -------
    float or None
        None where the header has no rate, or one that no camera has. [s]

    Examples
    --------
    >>> frame_interval(50_000, step=2500)
    0.05
    >>> frame_interval(0) is None
    True
    """
    if not _SLOWEST <= rate <= _FASTEST or not 0 < step <= _MOST_SKIPPED:
        return None
    return step / rate


def read_counts(source: Source, layout: FrameLayout, offset: int) -> AnyArray:
    """Decode one frame.

    Parameters
    ----------
    source : Source
        File that holds the counts.
    layout : FrameLayout
        How they are stored.
    offset : int
        Where they begin. [byte]

    Returns
    -------
    array, (y, x)
        [DN]

    Raises
    ------
    FrameError
        With the bare reason, if the file ends within the frame.
    """
    rows, columns = layout.shape
    if layout.packing is not None:
        packed = np.empty(layout.size, np.uint8)
        source.fill(packed, offset)
        flat = unpack(packed, rows * columns, layout.packing, table=layout.table)
        counts: AnyArray = flat.reshape(rows, columns)
    else:
        padded = np.empty((rows, layout.size // rows), np.uint8)
        source.fill(padded, offset)
        width = columns * np.dtype(layout.dtype).itemsize
        counts = np.ascontiguousarray(padded[:, :width]).view(layout.dtype)

    if layout.bottom_up:
        counts = np.ascontiguousarray(counts[::-1])
    counts = counts.astype(counts.dtype.newbyteorder("="), copy=False)
    if layout.unsigned:  # adding half the range is turning over the highest bit
        counts = counts.view(layout.kind.dtype)
        counts ^= counts.dtype.type(1 << (8 * counts.itemsize - 1))
    return counts


class Packing(Enum):
    """Bits of packed pixels, and their order."""

    HIGH_12 = 12, "high"  #: the highest first
    LOW_12 = 12, "low"  #: the lowest first: Mono12p
    SPLIT_12 = 12, "split"  #: the low four of two pixels in a byte between: Mono12Packed
    HIGH_10 = 10, "high"  #: the highest first
    LOW_10 = 10, "low"  #: the lowest first: Mono10p
    SPLIT_10 = 10, "split"  #: the low two of two pixels in a byte between: Mono10Packed

    def __init__(self, bits: int, order: str) -> None:
        self.bits, self.order = bits, order

    @property
    def group(self) -> tuple[int, int]:
        """Bytes and pixels of the smallest part that can be decoded by itself."""
        return (3, 2) if self.bits == 12 or self.order == "split" else (5, 4)

    def size(self, pixels: int) -> int:
        """Bytes that a number of pixels takes."""
        size, count = self.group
        return -(-pixels * size // count)


def unpack(
    packed: AnyArray, pixels: int, packing: Packing, *, table: Counts | None = None
) -> Counts:
    """Expand packed counts to 16 bits.

    Parameters
    ----------
    packed : array of uint8, (byte,)
        `packing.size(pixels)` bytes or more. Those after them are ignored.
    pixels : int
        Number of counts.
    packing : Packing
        Order of the bits.
    table : array of uint16, (value,), optional
        Counts by packed value, for a camera that compressed them; one for each possible value.

    Returns
    -------
    array of uint16, (pixel,)
        [DN]

    Examples
    --------
    >>> three = np.array([0x12, 0x34, 0x56], np.uint8)
    >>> [hex(count) for count in unpack(three, 2, Packing.HIGH_12)]
    ['0x123', '0x456']
    >>> [hex(count) for count in unpack(three, 2, Packing.LOW_12)]
    ['0x412', '0x563']
    >>> [hex(count) for count in unpack(three, 2, Packing.SPLIT_12)]
    ['0x124', '0x563']
    """
    # whole groups are decoded; what the last of them holds beyond the pixels is cut off
    size, count = packing.group
    groups = -(-pixels // count)
    if packed.size < groups * size:
        packed = np.concatenate([packed, np.zeros(groups * size - packed.size, np.uint8)])
    stored = packed[: groups * size].reshape(groups, size).T.astype(np.uint16)

    bits = packing.bits
    counts = np.empty((groups, count), np.uint16)
    for pixel in range(count):
        byte, bit = divmod(pixel * bits, 8)
        if packing.order == "split":
            low = stored[1] >> (4 * pixel) & ((1 << bits - 8) - 1)
            counts[:, pixel] = stored[2 * pixel] << (bits - 8) | low
        elif packing.order == "high":
            word = stored[byte] << 8 | stored[byte + 1]
            counts[:, pixel] = word >> (16 - bit - bits) & ((1 << bits) - 1)
        else:
            word = stored[byte] | stored[byte + 1] << 8
            counts[:, pixel] = word >> bit & ((1 << bits) - 1)
    image = counts.reshape(-1)[:pixels]
    return image if table is None else table[image]
