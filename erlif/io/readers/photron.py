"""Photron MRAW: counts in a `.mraw` file, described by a `.cihx` or `.cih` file beside it.

The header has the same content in two forms: lines "Key : value" (CIH, PFV 3) and XML behind a
few bytes of another kind (CIHX, PFV 4). A file of counts and its header share their name.

Counts of 8 bits, of 16 bits in little-endian order, and of 12 bits with the highest bit first are
read. The shutter speed of a header is its reciprocal in 1/s; only the rate is needed here.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.io.readers.base import LAYOUTS, Format, FrameFile, colour_camera
from erlif.io.readers.raw import FrameLayout, Packing, RawFrames, frame_interval
from erlif.io.readers.source import find_beside, read_text

# Endings of the headers, the newer form first.
_HEADERS = (".cihx", ".cih")


@dataclass(frozen=True)
class PhotronHeader:
    """Properties of the counts stated in a CIH or CIHX header.

    Attributes
    ----------
    shape : tuple[int, int]
        (rows, columns). [px]
    frames : int
        Number of frames.
    stored_bits : int
        Bits that a count takes in the file: 8, 12 or 16.
    bits : int | None
        Significant bits of a count; None where they are at the high end of 16 bits.
    interval : float | None
        Time between two saved frames; None where the header has no rate. [s]
    """

    shape: tuple[int, int]
    frames: int
    stored_bits: int
    bits: int | None
    interval: float | None


def read_photron_header(text: str) -> PhotronHeader:
    """Interpret the text of a CIH or CIHX file.

    Returns
    -------
    PhotronHeader

    Raises
    ------
    FrameError
        With the bare reason, if an entry is missing, is no number, or describes frames that are
        not read.

    Examples
    --------
    >>> header = read_photron_header('''#Camera Information Header
    ... Record Rate(fps) : 2000
    ... Total Frame : 12
    ... Image Width : 896
    ... Image Height : 368
    ... Color Bit : 16
    ... EffectiveBit Depth : 12
    ... EffectiveBit Side : Lower
    ... ''')
    >>> header.shape, header.frames, header.bits, header.interval
    ((368, 896), 12, 12, 0.0005)
    """
    entries = _find_entries(text)
    if entries.get("format", "mraw").lower() not in ("mraw", "raw", ""):
        raise FrameError(
            f"the Photron header describes {entries['format']} files. Save the recording as MRAW, "
            "or name the image files themselves."
        )
    if entries.get("colour", "mono").lower().startswith(("color", "colour", "bayer", "rgb")):
        raise colour_camera()

    stored = _whole(entries, "stored")
    if stored not in (8, 12, 16):
        raise FrameError(
            f"the Photron header names {stored} bits for each pixel; 8, 12 and 16 are read. Save "
            "the recording again with one of them."
        )
    depth = _whole(entries, "depth") if entries.get("depth") else stored
    if not 1 <= depth <= 16:
        raise FrameError(f"the Photron header is damaged: it names {depth} effective bits")

    # counts at the high end of 16 bits are multiples of 16, and the depth is judged from them
    high = entries.get("side", "lower").lower().startswith(("high", "upper")) and depth < stored
    rate = _number(entries, "rate") if entries.get("rate") else 0.0
    step = _whole(entries, "step") if entries.get("step") else 1
    return PhotronHeader(
        shape=(_whole(entries, "height"), _whole(entries, "width")),
        frames=_whole(entries, "frames"),
        stored_bits=stored,
        bits=None if high else min(depth, stored),
        interval=frame_interval(rate, step=max(step, 1)),
    )


def open_photron(path: Path) -> FrameFile:
    """Open a recording by its counts or by its header.

    `path` is the `.mraw`, `.cihx` or `.cih` file. As `Format.open`: FrameError if the
    other file is missing or the two do not fit.
    """
    if path.suffix.lower() in _HEADERS:
        header_path, counts_path = path, find_beside(path, (".mraw",))
        if counts_path is None:
            raise FrameError(
                f"the counts of this header are missing. Put {path.stem}.mraw beside it."
            )
    else:
        beside, counts_path = find_beside(path, _HEADERS), path
        if beside is None:
            raise FrameError(
                f"the header of these counts is missing. Put {path.stem}.cihx or {path.stem}.cih, "
                "which the camera's program saved with them, beside the file."
            )
        header_path = beside

    header = read_photron_header(read_text(header_path))
    layout = FrameLayout(header.shape, "|u1" if header.stored_bits == 8 else "<u2")
    if header.stored_bits == 12:
        layout = FrameLayout(header.shape, "<u2", packing=Packing.HIGH_12)

    return RawFrames(
        counts_path,
        layout,
        layout.in_a_row(0, header.frames),
        bits=header.bits,
        interval=header.interval,
        companions=(counts_path if path == header_path else header_path,),
        described_by=header_path.name,
    )


def _find_entries(text: str) -> dict[str, str]:
    """Values of the header by the names used here."""
    keys = LAYOUTS["photron"]
    start = text.find("<cih")
    if start < 0:
        # the first line counts: versions of programs and cameras follow under the same keys
        lines = [line.partition(":") for line in text.splitlines()]
        entries = {_plain(key): value.strip() for key, _, value in reversed(lines)}
        return {
            name: entries[_plain(key)] for name, (key, *_) in keys.items() if _plain(key) in entries
        }
    return {
        name: value
        for name, (_, *elements) in keys.items()
        if (value := _find_element(text, start, elements)) is not None
    }


def _find_element(text: str, start: int, elements: Sequence[str]) -> str | None:
    """Text of the first element of that path.

    The elements are looked up by their tags: an XML parser would refuse the comments in the code
    page of the camera's computer, and would follow entities.
    """
    low, high = start, len(text)
    for element in elements:
        opening = re.compile(rf"<{element}(?:\s[^<>]*)?>", re.IGNORECASE).search(text, low, high)
        if opening is None:
            return None
        closing = re.compile(rf"</{element}\s*>", re.IGNORECASE).search(text, opening.end(), high)
        if closing is None:
            return None
        low, high = opening.end(), closing.start()
    return text[low:high].strip()


def _plain(key: str) -> str:
    return re.sub(r"[^a-z0-9]", "", key.lower())


def _number(entries: dict[str, str], name: str) -> float:
    """A finite number of the header; FrameError where it is missing or none."""
    key = LAYOUTS["photron"][name][0]
    if name not in entries:
        raise FrameError(f"the Photron header has no entry for {key}; it was cut")
    try:
        value = float(entries[name])
    except ValueError:
        value = float("nan")
    if not abs(value) < 1e15:  # beyond any count of frames or pixels, and no whole float
        raise FrameError(f"the Photron header is damaged: {key} is {entries[name][:40]!r}")
    return value


def _whole(entries: dict[str, str], name: str) -> int:
    value, key = _number(entries, name), LAYOUTS["photron"][name][0]
    if value != int(value) or value < 0:
        raise FrameError(f"the Photron header is damaged: {key} is {entries[name]!r}")
    return int(value)


# Counts of Photron cameras with their header.
PHOTRON = Format(
    "Photron MRAW", (".mraw", *_HEADERS), None, open_photron, movie=True, beside=_HEADERS
)
