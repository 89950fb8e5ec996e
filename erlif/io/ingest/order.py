"""Order and numbers of files by their names."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable
from functools import cache
from pathlib import Path

# Text and numbers in turns; numbers stand at the odd places.
NameParts = list[str | int]

# A suffix holds a letter: in "run.0001" there is none. OME files have two.
_SUFFIX = re.compile(r"(\.ome)?\.(?!\d+$)[^.]*$", re.IGNORECASE)

# A hyphen that may be a sign; behind a digit ("2026-11-22") only that of a long number.
_MAY_BE_SIGN = re.compile(r"(?:(?<!\d)-(?=\d)|-(?=\d{4}))")

_BEGINS_NUMBER = re.compile(r"(?=[+-]?\d)")
_NUMBER = re.compile(r"(\d+)")


def split_name(name: str, signed: Collection[str] = ()) -> NameParts:
    """Text and numbers of a name; as a sort key it puts frame_2 before frame_10.

    Parameters
    ----------
    name : str
    signed : collection of str
        Beginnings of names, behind which a number has a sign.

    Returns
    -------
    list of str and int

    Examples
    --------
    >>> split_name("frame_10")
    ['frame_', 10, '']
    >>> split_name("Img-0020", {"Img"})
    ['Img', -20, '']
    """
    for found in _BEGINS_NUMBER.finditer(name) if signed else ():
        start = found.start()
        if name[:start] in signed:
            sign, digits, rest = _NUMBER.split(name[start:], 1)
            number = -int(digits) if sign == "-" else int(digits)
            return [*split_name(name[:start]), number, *split_name(rest)]
    parts = _NUMBER.split(name)
    return [int(part) if n % 2 else part for n, part in enumerate(parts)]


def sort_files(paths: Iterable[Path]) -> list[Path]:
    """Files by folder, stem and number; a stem without a number comes first.

    A hyphen is the sign of a number where other files have the same stem without it.

    Parameters
    ----------
    paths : iterable of Path

    Returns
    -------
    list of Path

    Examples
    --------
    >>> [path.name for path in sort_files(map(Path, ("run (2).tif", "run.tif", "run (10).tif")))]
    ['run.tif', 'run (2).tif', 'run (10).tif']
    >>> [path.name for path in sort_files(map(Path, ("a1.tif", "a0.tif", "a-1.tif", "a-2.tif")))]
    ['a-2.tif', 'a-1.tif', 'a0.tif', 'a1.tif']
    """
    paths = list(paths)
    folder = cache(split_name)
    keys = [
        (folder(os.path.dirname(path)), parts, str(path))
        for path, parts in zip(paths, _split_stems(paths), strict=True)
    ]
    return [paths[k] for k in sorted(range(len(paths)), key=keys.__getitem__)]


def number_files(paths: Collection[Path]) -> list[int | None]:
    """Last number in the name of each file, with its sign; None without one.

    Examples
    --------
    >>> number_files([Path("2026-11-22_cam1_0007.tif"), Path("run.tif")])
    [7, None]
    >>> number_files([Path("Img-0001.tif"), Path("Img0000.tif")])
    [-1, 0]
    """
    return [
        next((part for part in reversed(parts) if isinstance(part, int)), None)
        for parts in _split_stems(paths)
    ]


def has_hyphen(path: Path) -> bool:
    """Whether the last number in the name of a file follows a hyphen.

    Examples
    --------
    >>> has_hyphen(Path("Img-0020.tif")), has_hyphen(Path("2026-11-22_cam1_0007.tif"))
    (True, False)
    """
    return re.search(r"-\d+\D*$", _stem(path)) is not None


def _split_stems(paths: Collection[Path]) -> list[NameParts]:
    """Text and numbers of the names without suffixes."""
    stems = [_stem(path) for path in paths]
    heads = {stem[: found.start()] for stem in stems for found in _MAY_BE_SIGN.finditer(stem)}
    signed = heads and {
        stem[: found.start()]
        for stem in stems
        for found in _BEGINS_NUMBER.finditer(stem)
        if stem[found.start()] != "-" and stem[: found.start()] in heads
    }
    return [split_name(stem, signed) for stem in stems]


def _stem(path: Path) -> str:
    return _SUFFIX.sub("", os.path.basename(path))
