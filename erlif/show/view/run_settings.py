"""Values written into a settings file, with all else as it stands there: a drawn region."""

from __future__ import annotations

import difflib
import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from erlif.core.bounded import read_bounded
from erlif.core.errors import ConfigError, reason_of
from erlif.io.files import replacing
from erlif.show.view.measures import Rectangle

_LARGEST = 2**20  # bytes of a run.toml
_DIGITS = 3  # decimals of a position in mm

MARK = "\ufeff"
"""Byte-order mark, with which some editors begin a file."""


@dataclass(frozen=True)
class Change:
    """A change of a settings file.

    Attributes
    ----------
    path : Path
        The file.
    before : str
        Its text to the byte, with a byte-order mark that it may have; empty where it is not there.
    after : str
        Its text after the change.
    """

    path: Path
    before: str
    after: str

    @property
    def lines(self) -> str:
        """The lines that change, as a unified difference without its head."""
        texts = self.before.splitlines(), self.after.splitlines()
        lines = [*difflib.unified_diff(*texts, lineterm="", n=0)][2:]
        return "\n".join(line for line in lines if not line.startswith("@@"))

    @property
    def digest(self) -> str:
        """SHA-256 of the file before the change."""
        return hashlib.sha256(self.before.encode()).hexdigest()


def propose_region(run_dir: Path | None, region: Rectangle) -> Change:
    """Work out how run.toml changes when a region becomes its [thickness] roi.

    Parameters
    ----------
    run_dir : Path or None
        Run directory.
    region : (float, float, float, float)
        Low and high x, low and high y, rounded to a micrometre. [mm]

    Returns
    -------
    Change

    Raises
    ------
    ConfigError
        If there is no run.toml, or as `propose_change`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> before = "[thickness]  # maps\\nroi = { x = [1, 2], y = [3, 4] }\\n"
    >>> with TemporaryDirectory() as folder:
    ...     _ = Path(folder, "run.toml").write_text(before)
    ...     change = propose_region(Path(folder), (1.5, 9.0, 2.0, 8.25))
    >>> print(change.lines)
    -roi = { x = [1, 2], y = [3, 4] }
    +roi = { x = [1.5, 9.0], y = [2.0, 8.25] }
    """
    if run_dir is None or not (run_dir / "run.toml").is_file():
        raise ConfigError(
            "Expected a run.toml beside the film, to write the region to; there is none. Start "
            "erlif view with --run-dir."
        )
    x0, x1, y0, y1 = (round(value, _DIGITS) for value in region)
    wanted = {"x": [x0, x1], "y": [y0, y1]}
    return propose_change(run_dir / "run.toml", {("thickness", "roi"): wanted})


def propose_change(path: Path, values: Mapping[tuple[str, ...], Any]) -> Change:
    """Work out how a settings file changes with values, as for `change_values`.

    Parameters
    ----------
    path : Path
    values : mapping of tuple of str to value

    Returns
    -------
    Change

    Raises
    ------
    ConfigError
        If the file cannot be read, or if the change would touch another line.
    """
    names = ", ".join(".".join(place) for place in values)
    try:
        before = read_bounded(path, largest=_LARGEST).decode()
        return Change(path, before, change_values(before, values))
    except (OSError, ValueError, AttributeError, TypeError) as error:
        raise ConfigError(
            f"Expected {path} as a file of settings; {names} cannot be changed in it "
            f"({reason_of(error)}). Change it by hand."
        ) from error


def change_values(text: str, values: Mapping[tuple[str, ...], Any]) -> str:
    """Change values of a settings file, and leave comments, order and spaces as they are.

    Parameters
    ----------
    text : str
        The file.
    values : mapping of tuple of str to value
        By the names of the tables around a key and its own; None takes the key out. Tables that
        are not there are made.

    Returns
    -------
    str
        The file with these values.

    Raises
    ------
    ValueError, TypeError, AttributeError
        If the text is no such file, or more than these values would change.

    Examples
    --------
    >>> before = "[optics]  # of April\\n"
    >>> change_values(before, {("optics", "pixel_pitch"): "75 um"})
    '[optics]  # of April\\npixel_pitch = "75 um"\\n'
    """
    import tomlkit

    bare = text.removeprefix(MARK)
    expected = tomllib.loads(bare)
    document: Any = tomlkit.parse(bare)
    for (*tables, key), value in values.items():
        if tables and tables[0] not in document:
            before = tomlkit.dumps(document)
            document = tomlkit.parse(f"{before.rstrip()}\n\n[{tables[0]}]\n".lstrip())
        part, wanted = document, expected
        for name in tables:
            if name not in part:
                part[name] = tomlkit.inline_table()
            part, wanted = part[name], wanted.setdefault(name, {})
        if isinstance(value, dict):
            part.setdefault(key, tomlkit.inline_table()).update(value)  # a comment behind it stays
        elif value is not None:
            part[key] = value
        elif key in part:
            del part[key]
        wanted[key] = value
        if value is None:
            del wanted[key]

    # the library keeps the rest of the file: the whole is compared all the same
    after = tomlkit.dumps(document)
    if tomllib.loads(after) != expected:
        raise ValueError("more would change")
    return f"{text[: len(text) - len(bare)]}{after}"


def write_change(change: Change, *, before: str) -> None:
    """Write a change of a settings file that was confirmed, and keep its permissions.

    Parameters
    ----------
    change : Change
    before : str
        Digest of the file when the change was shown.

    Raises
    ------
    ConfigError
        If the file has changed since then.
    OutputError
        If it cannot be written; it is then as it was.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "run.toml")
    ...     _ = file.write_text("# no region yet\\n")
    ...     change = propose_region(Path(folder), (1.0, 2.0, 3.0, 4.0))
    ...     write_change(change, before=change.digest)
    ...     print(file.read_text(), end="")
    # no region yet
    <BLANKLINE>
    [thickness]
    roi = {x = [1.0, 2.0], y = [3.0, 4.0]}
    """
    if change.digest != before:
        raise ConfigError(
            f"Expected {change.path} as it was when the change was shown; it is another one now. "
            "Make the change again."
        )
    # a link keeps its place: the file behind it changes
    path = change.path.resolve()
    mode = path.stat().st_mode
    with replacing(path) as scratch:
        scratch.write_bytes(change.after.encode(errors="surrogateescape"))
        scratch.chmod(mode)
