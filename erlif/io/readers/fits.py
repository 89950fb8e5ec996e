"""FITS: the first image of a file; FITS standard 4.0, sections 3 to 5.

The order of the rows is that of the file. A header with ROWORDER = 'BOTTOM-UP', which programs of
cameras write, turns it over.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from erlif.core.errors import FrameError
from erlif.io.readers.base import Format, FrameFile, colour_camera
from erlif.io.readers.raw import FrameLayout, RawFrames
from erlif.io.readers.source import Source

# Sizes of the blocks of a file and of the entries of a header. [byte]
_BLOCK, _CARD = 2880, 80

# Blocks of a header, and headers of a file, that are read.
_MOST_BLOCKS = 1000

# Types by BITPIX.
_TYPES = {8: "|u1", 16: ">i2", 32: ">i4", 64: ">i8", -32: ">f4", -64: ">f8"}

# BZERO by which FITS stores unsigned numbers, by BITPIX; table 11 of the standard.
_UNSIGNED = {16: 2**15, 32: 2**31, 64: 2**63}


def open_fits(path: Path) -> FrameFile:
    """Open the first image of a FITS file.

    As `Format.open`: FrameError if it is damaged, compressed, or its values are scaled.
    """
    with Source(path) as source:
        place = 0
        for _ in range(_MOST_BLOCKS):
            cards, place = _read_header(source, place)
            shape = _shape(cards)
            if len(shape) >= 2 and cards.get("XTENSION", "IMAGE") == "IMAGE":
                break
            if cards.get("ZIMAGE") == "T":
                raise FrameError("its image is compressed. Expand the file with funpack.")
            # an extension follows where the blocks of these data end
            size = abs(_whole(cards, "BITPIX")) // 8 * _whole(cards, "GCOUNT", 1)
            size *= _whole(cards, "PCOUNT") + int(np.prod(shape, dtype=object)) if shape else 0
            place += -(-size // _BLOCK) * _BLOCK
            if size < 0 or place >= source.size:
                raise FrameError("the file holds no image")

    if cards.get("BAYERPAT") or cards.get("COLORTYP"):
        raise colour_camera("image")
    bits = _whole(cards, "BITPIX")
    frames = int(np.prod(shape[2:], dtype=object))
    if bits not in _TYPES:
        raise FrameError(f"the file is damaged: BITPIX is {bits}")
    upside_down = cards.get("ROWORDER", "").upper() == "BOTTOM-UP"
    layout = FrameLayout(
        (shape[1], shape[0]),
        _TYPES[bits],
        bottom_up=upside_down,
        unsigned=_is_unsigned(cards, bits),
    )
    return RawFrames(path, layout, layout.in_a_row(place, frames))


def _is_unsigned(cards: dict[str, str], bits: int) -> bool:
    """Whether the counts are unsigned: BZERO is half the range."""
    try:
        # an exponent may be written with the letter D
        zero, scale = (
            float(cards.get(keyword, default).upper().replace("D", "E"))
            for keyword, default in (("BZERO", "0"), ("BSCALE", "1"))
        )
    except ValueError:
        raise FrameError("the file is damaged: BZERO or BSCALE is no number") from None
    if scale == 1 and zero in (0, _UNSIGNED.get(bits)):
        return zero != 0
    raise FrameError(
        f"its values are scaled (BSCALE = {scale:g}, BZERO = {zero:g}) and no longer counts. Save "
        "the raw counts of the camera."
    )


def _read_header(source: Source, place: int) -> tuple[dict[str, str], int]:
    """Entries of a header by keyword, and where its data begin."""
    cards: dict[str, str] = {}
    for _ in range(_MOST_BLOCKS):
        block = source.read(place, _BLOCK).decode("latin-1")
        place += _BLOCK
        for n in range(0, _BLOCK, _CARD):
            card = block[n : n + _CARD]
            keyword = card[:8].rstrip()
            if keyword == "END":
                return cards, place
            if card[8:10] == "= ":
                cards.setdefault(keyword, _value(card[10:]))
    raise FrameError("the file is damaged: its header has no end")


def _value(text: str) -> str:
    """Value of an entry, without its comment."""
    text = text.strip()
    if text.startswith("'"):
        return text[1:].partition("'")[0].strip()
    return text.partition("/")[0].strip()


def _shape(cards: dict[str, str]) -> tuple[int, ...]:
    """Lengths of the axes, the fastest first."""
    axes = _whole(cards, "NAXIS")
    if not 0 <= axes <= 999:  # the most that the standard allows
        raise FrameError(f"the file is damaged: NAXIS is {axes}")
    shape = [_whole(cards, f"NAXIS{n}") for n in range(1, axes + 1)]
    if any(length < 0 for length in shape):
        raise FrameError("the file is damaged: an axis has a negative length")
    return tuple(shape)


def _whole(cards: dict[str, str], keyword: str, default: int = 0) -> int:
    try:
        return int(cards.get(keyword, str(default)))
    except ValueError:
        raise FrameError(f"the file is damaged: {keyword} is no whole number") from None


FITS = Format(
    "FITS",
    (".fits", ".fit", ".fts"),
    lambda path, head: head[:9] == b"SIMPLE  =",
    open_fits,
)
