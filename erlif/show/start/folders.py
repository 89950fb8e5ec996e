"""Folders below the start directory: which there are, and which look like a run or a fixture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from erlif.core.errors import ErlifError, reason_of
from erlif.io.ingest.naming import FIXTURE


def inside(root: Path, name: str) -> Path:
    """A folder by its name below the start directory.

    Parameters
    ----------
    root : Path
        The start directory, without links.
    name : str
        Names with slashes between them; empty for the start directory itself.

    Returns
    -------
    Path

    Raises
    ------
    ErlifError
        If it leads out of the start directory, or is no folder.

    Examples
    --------
    >>> inside(Path("calibration").resolve(), "wedge").name
    'wedge'
    """
    try:
        folder = (root / name).resolve()
        allowed = folder.is_relative_to(root) and folder.is_dir()
    except (OSError, ValueError, RuntimeError) as error:  # the last one: links in a circle
        raise ErlifError(
            f"Expected a folder below {root}; {name!a} cannot be opened ({reason_of(error)}). "
            "Choose another one."
        ) from error
    if not allowed:
        raise ErlifError(
            f"Expected a folder below {root}; {name!a} is none. Choose another one, or start "
            "erlif start with the folder that holds it."
        )
    return folder


def list_folder(root: Path, name: str) -> dict[str, Any]:
    """List the folders in a folder.

    Parameters
    ----------
    root : Path
    name : str
        As for `inside`.

    Returns
    -------
    dict
        "name"; "folders", their names; "files", the number of others; "settings", which of run.toml
        and fixture.toml it holds. Hidden folders and links that lead out are left out.

    Raises
    ------
    ErlifError
        As `inside`, or if the folder may not be read.

    Examples
    --------
    >>> list_folder(Path("calibration").resolve(), "")["folders"]
    ['wedge', 'wedge_after']
    """
    folder = inside(root, name)
    folders, files = [], []
    try:
        for entry in sorted(folder.iterdir(), key=lambda path: path.name.lower()):
            if entry.name.startswith("."):
                continue
            if not entry.is_dir():
                files.append(entry.name)
            elif entry.resolve().is_relative_to(root):
                folders.append(entry.name)
    except OSError as error:
        raise ErlifError(
            f"Expected a folder that may be read; {name or folder} may not ({error.strerror}). "
            "Change its permissions, or choose another one."
        ) from error
    settings = [file for file in ("run.toml", "fixture.toml") if file in files]
    return {"name": name, "folders": folders, "files": len(files), "settings": settings}


def suggest(root: Path) -> dict[str, str]:
    """Folders of the run and of the fixture, by their settings and names.

    A start directory without either is the fixture itself where its name, or a profile in it, shows
    one; else it is the run.

    Parameters
    ----------
    root : Path

    Returns
    -------
    dict of str to str
        Names below the start directory of "run" and "fixture", where there is a guess.

    Examples
    --------
    >>> suggest(Path("calibration").resolve())
    {'fixture': 'wedge'}
    """
    listed = list_folder(root, "")
    names = ["", *listed["folders"]]

    def holds(name: str, file: str) -> bool:
        return (root / name / file).is_file()

    fixtures = [name for name in names if holds(name, "fixture.toml")]
    fixtures += [name for name in listed["folders"] if FIXTURE.search(name.lower())]
    runs = [name for name in names if holds(name, "run.toml")]
    runs += [name for name in listed["folders"] if name.lower().startswith("run")]
    if not runs and not fixtures:
        own = [root.name, *(path.name for path in root.iterdir() if path.is_file())]
        shown = any(FIXTURE.search(name.lower()) or "profile" in name.lower() for name in own)
        (fixtures if shown else runs).append("")
    found = {"run": runs[:1], "fixture": fixtures[:1]}
    return {kind: names[0] for kind, names in found.items() if names}
