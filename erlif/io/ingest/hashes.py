"""Hashes of the inputs of a result, and a quick sign that they are the same as before."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.core.guarded import file_stamp
from erlif.io.ingest.images import match_files
from erlif.io.ingest.order import sort_files
from erlif.io.ingest.recording import Fixture, Run

# SHA-256 of files that are hashed already, hexadecimal.
Digests = Mapping[Path, str]


def hash_inputs(recording: Run | Fixture, known: Digests | None = None) -> dict[str, str]:
    """SHA-256 of every input of a run or a fixture.

    Parameters
    ----------
    recording : Run or Fixture
    known : mapping of Path to str, optional
        Hashes of files that were taken as they were read; the other files are read here.

    Returns
    -------
    dict of str to str
        Hexadecimal hash by the name of the file in the directory; the files of one pattern share
        one hash.

    Examples
    --------
    >>> from erlif.io.ingest import open_fixture
    >>> hashes = hash_inputs(open_fixture(Path("calibration/wedge")))
    >>> "profile.csv" in hashes, len(hashes["profile.csv"])
    (True, 64)
    """
    known = {} if known is None else known
    hashes = {
        name: _combine(paths, known) for name, paths in _files_beside_frames(recording).items()
    }
    for camera, paths in zip(recording.cameras, _files_of_frames(recording), strict=True):
        hashes[camera.files] = _combine(sort_files(paths), known)

    # names as they stand in the settings may climb out and back in: results keep the shortest
    return {
        os.path.relpath(recording.directory / name, recording.directory): value
        for name, value in hashes.items()
    }


def hash_files_beside_frames(recording: Run | Fixture) -> dict[Path, str]:
    """SHA-256 of settings, log or profile, darks and flats.

    Argument as in `hash_inputs`.

    Returns
    -------
    dict of Path to str
        Hexadecimal hash of each file; a file that cannot be read is left out.

    Examples
    --------
    >>> from erlif.io.ingest import open_run
    >>> run = open_run(Path("data_samples/straight_bushing"))
    >>> sorted(path.name for path in hash_files_beside_frames(run))[-2:]
    ['encoder.csv', 'run.toml']
    """
    files = {path for paths in _files_beside_frames(recording).values() for path in paths}
    hashes = {path: _hash_file(path) for path in sorted(files)}
    return {path: digest for path, digest in hashes.items() if digest is not None}


def sign_inputs(recording: Run | Fixture, known: Digests) -> str:
    """A sign by which unfinished work knows its inputs, without reading the frames.

    Parameters
    ----------
    recording : Run or Fixture
    known : mapping of Path to str
        Hashes that enter as they are, as `hash_files_beside_frames` gives them.

    Returns
    -------
    str
        Hexadecimal. It changes with the name, the size or the time of change of any frame, to the
        nanosecond, and with any of the hashes.

    Examples
    --------
    >>> from erlif.io.ingest import open_run
    >>> run = open_run(Path("data_samples/straight_bushing"))
    >>> sign_inputs(run, {}) == sign_inputs(run, {run.directory / "run.toml": "5a"})
    False
    """
    sign = hashlib.sha256()
    for paths in _files_beside_frames(recording).values():
        for path in paths:
            sign.update(f"{_name(path, recording)}\0{known.get(path)}\0".encode())
    for paths in _files_of_frames(recording):
        for path in paths:
            sign.update(f"{_name(path, recording)}\0{_stamp(path)}\0".encode())
        sign.update(b"next camera")
    return sign.hexdigest()


class InputChangedError(FrameError):
    """A file of a recording that was replaced or changed while the recording was in use."""


def stamp_inputs(recording: Run | Fixture) -> dict[Path, str]:
    """Size, time of change and place on the disk of every input.

    Argument as in `hash_inputs`.

    Returns
    -------
    dict of Path to str
        To be compared by `refuse_changed`.

    Examples
    --------
    >>> from erlif.io.ingest import open_run
    >>> run = open_run(Path("data_samples/straight_bushing"))
    >>> stamp_inputs(run) == stamp_inputs(run)
    True
    """
    beside = [path for paths in _files_beside_frames(recording).values() for path in paths]
    frames = [path for paths in _files_of_frames(recording) for path in paths]
    return {path: _stamp(path, place=True) for path in (*beside, *frames)}


def refuse_changed(recording: Run | Fixture, before: Mapping[Path, str]) -> None:
    """Refuse a recording of which a file has changed while it was read.

    A frame is read several times, for the camera map and for its film; a result must belong to one
    content of it, the one whose hash it holds.

    Parameters
    ----------
    recording : Run or Fixture
    before : mapping of Path to str
        From `stamp_inputs`, made before anything was read.

    Raises
    ------
    InputChangedError
        For the first file that differs.

    Examples
    --------
    >>> from erlif.io.ingest import open_run
    >>> run = open_run(Path("data_samples/straight_bushing"))
    >>> refuse_changed(run, stamp_inputs(run))
    """
    for path, stamp in before.items():
        if _stamp(path, place=True) != stamp:
            name = os.path.relpath(path, recording.directory)
            raise InputChangedError(
                f"Expected the files of {recording.directory} to stay as they are while they are "
                f"read; {name} was changed or replaced. Wait until the recording is complete, and "
                "start again."
            )


def _files_beside_frames(recording: Run | Fixture) -> dict[str, list[Path]]:
    """Inputs that are no frames, by their names or patterns in the settings."""
    own = "run.toml" if isinstance(recording, Run) else "fixture.toml"
    names = [own, *recording.settings.beside]
    files = {name: [recording.directory / name] for name in names}
    for camera in recording.cameras:
        for pattern in (camera.dark, camera.flat, camera.background):
            if pattern is not None:
                files[pattern] = match_files(recording.directory, pattern)
    return files


def _files_of_frames(recording: Run | Fixture) -> list[list[Path]]:
    """Files of each camera, each once."""
    pairs = recording.pairs
    return [
        list(dict.fromkeys([*(page.path for page in pages), *others]))
        for pages, others in zip(pairs.pages, pairs.companions, strict=True)
    ]


def _combine(paths: Iterable[Path], known: Digests) -> str:
    # the hash of the hashes: the names of the files do not enter, their order does
    total = hashlib.sha256()
    for path in paths:
        digest = known.get(path) or _hash_file(path)
        # a frame that is left out may be unreadable; files that matter were read before
        total.update(b"unreadable" if digest is None else bytes.fromhex(digest))
    return total.hexdigest()


def _hash_file(path: Path) -> str | None:
    """SHA-256 of a file; None where it cannot be read, as a pipe."""
    if not path.is_file():
        return None
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return None


def _name(path: Path, recording: Run | Fixture) -> str:
    return os.fsencode(os.path.relpath(path, recording.directory)).hex()


def _stamp(path: Path, *, place: bool = False) -> str:
    """Size and time of change; the same for all files that are not there.

    The place on the disk differs between two files that took the same name one after the other.
    """
    try:
        stamp = file_stamp(path)
    except OSError:
        return "unreadable"
    return " ".join(map(str, stamp if place else stamp[:2]))
