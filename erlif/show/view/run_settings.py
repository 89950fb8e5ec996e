"""A drawn region written into run.toml, with all else as it stands there."""

from __future__ import annotations

import difflib
import hashlib
import tomllib
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
    after = _set_region(path, before, [round(value, _DIGITS) for value in region])
    texts = before.decode().splitlines(), after.decode().splitlines()
    names = "run.toml as it is", "run.toml with the region"
    lines = difflib.unified_diff(*texts, *names, lineterm="", n=1)
    return RegionChange(path, hashlib.sha256(before).hexdigest(), after, "\n".join(lines))


def _set_region(path: Path, before: bytes, region: list[float]) -> bytes:
    """The file with another region."""
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    # tomlkit keeps comments, order and spaces; the file is compared as a whole below
    wanted = {"x": region[:2], "y": region[2:]}
    try:
        text = before.decode()
        document: Any = tomlkit.parse(text)
        expected = tomllib.loads(text)
        if "thickness" not in document:
            document = tomlkit.parse(f"{text.rstrip()}\n\n[thickness]\n".lstrip())
        table = document["thickness"]
        if "roi" not in table:
            table["roi"] = tomlkit.inline_table()
        table["roi"].update(wanted)
        after = tomlkit.dumps(document).encode()
        settings = tomllib.loads(after.decode())
    except (TOMLKitError, ValueError, AttributeError, TypeError) as error:
        raise ConfigError(
            f"Expected {path} as a file of settings; it cannot be changed ({reason_of(error)}). "
            "Write roi into [thickness] by hand."
        ) from error

    expected.setdefault("thickness", {})["roi"] = wanted
    if settings != expected:
        raise ConfigError(
            f"Expected that roi alone changes in {path}; more would. Write roi = {{ x = "
            f"{wanted['x']}, y = {wanted['y']} }} into [thickness] by hand."
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
    # a link keeps its place: the file behind it changes
    path = change.path.resolve()
    mode = path.stat().st_mode
    with replacing(path) as scratch:
        scratch.write_bytes(change.content)
        scratch.chmod(mode)
