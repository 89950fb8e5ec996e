"""Hashes of the inputs of a result."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from erlif.ingest.images import match_files, natural_key
from erlif.ingest.recording import Fixture, Run


def hash_inputs(recording: Run | Fixture) -> dict[str, str]:
    """SHA-256 of every input of a run or a fixture.

    Parameters
    ----------
    recording : Run or Fixture

    Returns
    -------
    dict of str to str
        Hexadecimal hash by the name of the file in the directory; the files of one pattern share
        one hash.

    Examples
    --------
    >>> from erlif.ingest import open_fixture
    >>> hashes = hash_inputs(open_fixture(Path("calibration/wedge")))
    >>> "profile.csv" in hashes, len(hashes["profile.csv"])
    (True, 64)
    """
    if isinstance(recording, Run):
        names = ["run.toml", recording.settings.encoder.file]
    else:
        names = ["fixture.toml", recording.settings.fixture.profile]
    hashes = {name: _hash_files([recording.directory / name]) for name in names}

    # of the frames the pages that are paired count, of darks and flats what the pattern matches
    for camera, pages in zip(recording.cameras, recording.pairs.pages, strict=True):
        hashes[camera.files] = _hash_files(sorted({page.path for page in pages}, key=natural_key))
        for reference in (camera.dark, camera.flat):
            if reference is not None:
                hashes[reference] = _hash_files(match_files(recording.directory, reference))

    # names as they stand in the settings may climb out and back in: results keep the shortest
    return {
        os.path.relpath(recording.directory / name, recording.directory): value
        for name, value in hashes.items()
    }


def _hash_files(paths: Iterable[Path]) -> str:
    # the hash of the hashes: the names of the files do not enter, their order does
    total = hashlib.sha256()
    for path in paths:
        try:
            with path.open("rb") as file:
                total.update(hashlib.file_digest(file, "sha256").digest())
        except OSError:  # a frame that is left out; files that matter were read before
            total.update(b"unreadable")
    return total.hexdigest()
