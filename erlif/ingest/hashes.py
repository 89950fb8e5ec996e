"""Hashes of the inputs of a result."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from erlif.ingest.images import _match_files, natural_key
from erlif.ingest.recording import Recording
from erlif.settings import RunSettings


def hash_inputs(recording: Recording) -> dict[str, str]:
    """SHA-256 of every input by its name in the directory; the files of one pattern share one hash."""
    settings = recording.settings
    names: list[str] = []
    if isinstance(settings, RunSettings):
        names += ["run.toml", settings.encoder.file]
    else:
        names += ["fixture.toml", settings.fixture.profile]
    hashes = {name: _hash_files([recording.directory / name]) for name in names}
    for camera, pages in zip(recording.cameras, recording.pages, strict=True):
        hashes[camera.files] = _hash_files(sorted({page.path for page in pages}, key=natural_key))
        for reference in (camera.dark, camera.flat):
            if reference is not None:
                hashes[reference] = _hash_files(_match_files(recording.directory, reference))
    return {
        os.path.relpath(recording.directory / name, recording.directory): value
        for name, value in hashes.items()
    }


def _hash_files(paths: Iterable[Path]) -> str:
    total = hashlib.sha256()
    for path in paths:
        try:
            with path.open("rb") as file:
                total.update(hashlib.file_digest(file, "sha256").digest())
        except OSError:  # a frame that is left out; what must be readable was read before
            total.update(b"unreadable")
    return total.hexdigest()
