"""Files of a recording lie in its directory.

A directory from somebody else may hold links, or names in its settings, that lead to any file of
this machine. They are followed only where the user asks for it.
"""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.io.ingest.images import match_files
from erlif.io.readers.registry import find_by_suffix
from erlif.io.settings import FixtureSettings, RunSettings


def named_files(settings: RunSettings | FixtureSettings) -> list[str]:
    """Names and patterns of the input files in the settings; a calibration is a result.

    Returns
    -------
    list of str

    Examples
    --------
    >>> from erlif.io.settings import read_fixture_settings
    >>> "profile.csv" in named_files(read_fixture_settings(Path("calibration/wedge")))
    True
    """
    cameras = settings.camera1, settings.camera2
    names = [
        name
        for camera in cameras
        for name in (camera.files, camera.dark, camera.flat, camera.background)
    ]
    return [name for name in (*names, *settings.beside) if name is not None]


def refuse_outside(directory: Path, names: Iterable[str]) -> None:
    """Refuse names and links that leave the directory of a recording.

    Parameters
    ----------
    directory : Path
        The run or fixture directory; it may itself be a link.
    names : iterable of str
        Names or patterns of files in it.

    Raises
    ------
    FrameError
        For the first one that leads out of the directory.

    Examples
    --------
    >>> refuse_outside(Path("calibration/wedge"), ["camera1/*.tif"])
    >>> refuse_outside(Path("calibration/wedge"), ["../../run/encoder.csv"])
    Traceback (most recent call last):
        ...
    erlif.core.errors.FrameError: Expected the files of calibration/wedge within it; \
../../run/encoder.csv leaves the directory. Copy them there, or use --allow-outside.
    """
    home = _real(directory)
    inside: dict[Path, bool] = {}
    for name in names:
        if not Path(os.path.normpath(home / name)).is_relative_to(home):
            raise _outside(directory, f"{name} leaves the directory")

        # a log or a profile is opened by its name, also where that reads as a pattern
        matched = dict.fromkeys([*match_files(directory, name), directory / name])
        for path in (file for found in matched for file in _with_companions(found)):
            # folders are resolved once, and a file only where it is a link itself
            if path.parent not in inside:
                inside[path.parent] = _real(path.parent).is_relative_to(home)
            if not inside[path.parent] or (
                path.is_symlink() and not _real(path).is_relative_to(home)
            ):
                what = f"{os.path.relpath(path, directory)} is a link to {_real(path)}"
                raise _outside(directory, what)


def _outside(directory: Path, what: str) -> FrameError:
    return FrameError(
        f"Expected the files of {directory} within it; {what}. Copy them there, or use "
        "--allow-outside."
    )


def _real(path: Path) -> Path:
    """A path without links; a link that leads to itself stays, and the reader refuses it."""
    return Path(os.path.realpath(path))


def _with_companions(path: Path) -> Iterator[Path]:
    """A file, and the header, the counts or the images beside it under its name."""
    yield path
    form = find_by_suffix(path.suffix)
    if form is not None and form.beside:
        yield from path.parent.glob(f"{glob.escape(path.stem)}.*")
        folder = path.with_suffix("")
        if folder.is_dir():
            yield from folder.iterdir()
