"""Names by which several films are distinguished."""

from __future__ import annotations

from collections.abc import Sequence
from os.path import commonpath
from pathlib import Path

from erlif.core.errors import ErlifError


def label_films(names: Sequence[str], paths: Sequence[Path | None]) -> list[str]:
    """Name films by their runs; films of one name also by a folder.

    The folder is the nearest one in which all films of the name differ. Where there is none, it is
    the path below the folder that they share; films of one folder have the names of their files.
    What is still equal is numbered.

    Parameters
    ----------
    names : sequence of str
        Names of the runs.
    paths : sequence of Path or None
        Files of the films; None where a film is in memory only.

    Returns
    -------
    list of str
        In the order of the films; all differ.

    Examples
    --------
    >>> names = ["bushing", "bushing", "ring"]
    >>> label_films(names, [Path(f"{each}/run/film.nc") for each in ("load_50", "load_100", "a")])
    ['bushing (load_50)', 'bushing (load_100)', 'ring']
    """
    labels = list(names)
    for name in dict.fromkeys(names):
        chosen = [k for k, each in enumerate(names) if each == name]
        if len(chosen) > 1:
            places = _distinguish([paths[k] for k in chosen])
            for k, place in zip(chosen, places, strict=True):
                labels[k] = f"{name} ({place})"

    # the name of one run may be the label of another
    return labels if len(set(labels)) == len(labels) else _number(labels)


def refuse_repeated(paths: Sequence[str | Path]) -> None:
    """Refuse a file that is named twice, by one name or by two.

    Parameters
    ----------
    paths : sequence of path
        Files of films.

    Raises
    ------
    ErlifError
        With the name as it was given first.

    Examples
    --------
    >>> refuse_repeated(["a", "b", "a/../b"])
    Traceback (most recent call last):
    erlif.core.errors.ErlifError: Expected different films; b is named 2 times. Name each film once.
    """
    files = [Path(path).resolve() for path in paths]
    for path, file in zip(paths, files, strict=True):
        if files.count(file) > 1:
            raise ErlifError(
                f"Expected different films; {path} is named {files.count(file)} times. Name each "
                "film once."
            )


def _distinguish(paths: Sequence[Path | None]) -> list[str]:
    """Short texts that distinguish files; numbers where nothing else does."""
    numbers = [f"{k + 1}" for k in range(len(paths))]
    files = [path.resolve() for path in paths if path is not None]
    if len(files) < len(paths) or len(set(files)) < len(files):
        return numbers

    # the nearest folder first: it is the run directory in most cases
    folders = [file.parent.parts[1:] for file in files]
    for depth in range(1, min(len(each) for each in folders) + 1):
        parts = [each[-depth] for each in folders]
        if len(set(parts)) == len(parts):
            return parts

    shared = Path(commonpath([file.parent for file in files]))
    below = [file.parent.relative_to(shared).as_posix() for file in files]
    if len(set(below)) == len(below):
        return below
    return [file.relative_to(shared).as_posix() for file in files]


def _number(labels: Sequence[str]) -> list[str]:
    """Append a number to labels that are equal."""
    return [
        f"{label} ({labels[:k].count(label) + 1})" if labels.count(label) > 1 else label
        for k, label in enumerate(labels)
    ]
