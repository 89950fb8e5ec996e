"""Values written into a settings file, with all else as it stands there: a drawn region."""

from __future__ import annotations

import difflib
import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from erlif.core.errors import ConfigError, reason_of
from erlif.io.files import replacing
from erlif.show.view.measures import Rectangle

_LARGEST = 2**20  # bytes of a run.toml
_DIGITS = 3  # decimals of a position in mm


@dataclass(frozen=True)
class RegionChange:
    """A change of run.toml that is not written yet.

    Attributes
    ----------
    path : Path
        The file.
    before : str
        SHA-256 of the file as it is.
    content : bytes
        The file as it would be.
    lines : str
        The lines that change, as a unified difference.
    """

    path: Path
    before: str
    content: bytes
    lines: str


def propose_region(run_dir: Path | None, region: Rectangle) -> RegionChange:
    """Work out how run.toml changes when a region becomes its [thickness] roi.

    Parameters
    ----------
    run_dir : Path or None
        Run directory.
    region : (float, float, float, float)
        Low and high x, low and high y, rounded to a micrometre. [mm]

    Returns
    -------
    RegionChange

    Raises
    ------
    ConfigError
        If there is no run.toml, if it cannot be read, or if the change would touch another line.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> before = "[thickness]  # maps\\nroi = { x = [1, 2], y = [3, 4] }\\n"
    >>> with TemporaryDirectory() as folder:
    ...     _ = Path(folder, "run.toml").write_text(before)
    ...     change = propose_region(Path(folder), (1.5, 9.0, 2.0, 8.25))
    >>> print(change.content.decode(), end="")
    [thickness]  # maps
    roi = { x = [1.5, 9.0], y = [2.0, 8.25] }
    """
    if run_dir is None or not (run_dir / "run.toml").is_file():
        raise ConfigError(
            "Expected a run.toml beside the film, to write the region to; there is none. Start "
            "erlif view with --run-dir."
        )
    path = run_dir / "run.toml"
    if path.stat().st_size > _LARGEST:
        raise ConfigError(
            f"Expected settings of at most {_LARGEST} bytes; {path} has more. Reduce it."
        )
    before = path.read_bytes()
    x0, x1, y0, y1 = (round(value, _DIGITS) for value in region)
    wanted = {"x": [x0, x1], "y": [y0, y1]}
    try:
        after = change_values(before.decode(), {("thickness", "roi"): wanted})
    except (ValueError, AttributeError, TypeError, ConfigError) as error:
        raise ConfigError(
            f"Expected {path} as a file of settings; it cannot be changed ({reason_of(error)}). "
            f"Write roi = {{ x = {wanted['x']}, y = {wanted['y']} }} into [thickness] by hand."
        ) from error
    names = "run.toml as it is", "run.toml with the region"
    lines = changed_lines(before.decode(), after, names)
    return RegionChange(path, hashlib.sha256(before).hexdigest(), after.encode(), lines)


def changed_lines(before: str, after: str, names: tuple[str, str]) -> str:
    """Lines of a file that change, as a unified difference of the two named texts.

    Returns
    -------
    str

    Examples
    --------
    >>> print(changed_lines("a\\nb\\n", "a\\nc\\n", ("one", "two")))
    --- one
    +++ two
    @@ -1,2 +1,2 @@
     a
    -b
    +c
    """
    texts = before.splitlines(), after.splitlines()
    return "\n".join(difflib.unified_diff(*texts, *names, lineterm="", n=1))


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
        If the text is no such file.
    ConfigError
        If more than these values would change.

    Examples
    --------
    >>> before = "[optics]  # of April\\n"
    >>> change_values(before, {("optics", "pixel_pitch"): "75 um"})
    '[optics]  # of April\\npixel_pitch = "75 um"\\n'
    """
    import tomlkit

    expected = tomllib.loads(text)
    document: Any = tomlkit.parse(text)
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
        names = ", ".join(".".join(place) for place in values)
        raise ConfigError(
            f"Expected that nothing but {names} changes in the settings; more would. Write it by "
            "hand."
        )
    return after


def write_region(change: RegionChange, *, before: str) -> None:
    """Write a change of run.toml that was confirmed.

    Parameters
    ----------
    change : RegionChange
        From `propose_region`.
    before : str
        SHA-256 of the file when the change was shown.

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
    ...     write_region(change, before=change.before)
    ...     print(file.read_text(), end="")
    # no region yet
    <BLANKLINE>
    [thickness]
    roi = {x = [1.0, 2.0], y = [3.0, 4.0]}
    """
    if change.before != before:
        raise ConfigError(
            f"Expected {change.path} as it was when the change was shown; it is another one now. "
            "Write the region again."
        )
    write_settings(change.path, change.content)


def write_settings(path: Path, content: bytes) -> None:
    """Write a settings file that exists, with the permissions that it has.

    Parameters
    ----------
    path : Path
    content : bytes

    Raises
    ------
    OutputError
        If it cannot be written; it is then as it was.
    """
    path = path.resolve()  # a link keeps its place: the file behind it changes
    mode = path.stat().st_mode
    with replacing(path) as scratch:
        scratch.write_bytes(content)
        scratch.chmod(mode)
