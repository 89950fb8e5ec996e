"""run.toml, fixture.toml, plan.toml, checked: one message has all faults and gaps."""

from __future__ import annotations

import difflib
import os
import re
import tomllib
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from erlif.core.bounded import read_bounded
from erlif.core.errors import ConfigError
from erlif.core.units import count_of
from erlif.io.settings.bore import read_bore
from erlif.io.settings.keys import Key, keys_of, tables_in
from erlif.io.settings.tables import FixtureSettings, MechanismSettings, RunSettings
from erlif.io.settings.values import Settings

if TYPE_CHECKING:
    from erlif.io.settings.planning import PlanSettings

_Settings = TypeVar("_Settings", bound="Settings")

# Names of tables and of the key, from the top of the file.
_Location = tuple[str, ...]

# Size of a settings file that is read: 1 MB is a thousand times a usual one. [byte]
_LARGEST_FILE = 2**20

# What `erlif init` writes for a value it does not know: "??", or "?? um" with the unit.
_GAP = re.compile(r"\?\?( .*)?")

# Forms of [mechanism]; pydantic puts the kind into the location of a fault.
_KINDS: dict[str, type[Settings]] = {
    get_args(kind.model_fields["kind"].annotation)[0]: kind for kind in tables_in(MechanismSettings)
}


def read_run_settings(run_dir: Path, *, allow_outside: bool = False) -> RunSettings:
    """Read and check ``run.toml`` of a run directory.

    Parameters
    ----------
    run_dir : Path
        Directory of the run.
    allow_outside : bool
        Read the profile of the bore also where it lies outside of the directory.

    Returns
    -------
    RunSettings

    Raises
    ------
    ConfigError
        If the file is missing or is not TOML, if a gap is left in it, or if a key or value cannot
        be used. The message lists all gaps and faults.
    FrameError
        If the profile of the bore lies outside of the directory.

    Examples
    --------
    >>> read_run_settings(Path("no such run"))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected a directory with run.toml in it; no such run is not ...
    """
    return _read(run_dir, "run.toml", RunSettings, allow_outside=allow_outside)


def read_fixture_settings(fixture_dir: Path) -> FixtureSettings:
    """Read and check ``fixture.toml`` of a fixture directory.

    Errors as for `read_run_settings`; `fixture_dir` is the directory of the fixture.

    Returns
    -------
    FixtureSettings

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as empty:
    ...     read_fixture_settings(Path(empty))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected fixture.toml in ...; there is none. Make one from ...
    """
    return _read(fixture_dir, "fixture.toml", FixtureSettings)


def read_plan_settings(path: Path) -> PlanSettings:
    """Read and check a plan, the input of `erlif.plan`.

    Errors as for `read_run_settings`; `path` is the file, plan.toml.

    Returns
    -------
    PlanSettings

    Examples
    --------
    >>> read_plan_settings(Path("no plan.toml"))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected a plan in no plan.toml; there is no such file. Make ...
    """
    from erlif.io.settings.planning import PlanSettings

    hint = "Make one with: erlif plan --example > plan.toml"
    return read_named(path, PlanSettings, holds="a plan", hint=hint)


def settings_of(
    source: Path | str | _Settings, read: Callable[[Path], _Settings], folder: Path | None
) -> tuple[_Settings, Path]:
    """Return settings that were read, or those of a file, and the folder of what they name.

    Parameters
    ----------
    source : path or settings
    read : callable
        Reader of such a file.
    folder : Path or None
        Default: that of the file, or the working directory.

    Returns
    -------
    settings
    Path

    Raises
    ------
    ConfigError
        If `source` is neither, or as the reader.

    Examples
    --------
    >>> settings_of({}, read_plan_settings, None)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected the name of a file, or settings; got dict. ...
    """
    if isinstance(source, Settings):
        return source, folder or Path()
    if not isinstance(source, str | os.PathLike):
        raise ConfigError(
            f"Expected the name of a file, or settings; got {type(source).__name__}. Name the file."
        )
    path = Path(source)
    return read(path), folder or path.parent


def read_named(path: Path, kind: type[_Settings], *, holds: str, hint: str) -> _Settings:
    """Read and check a settings file that the user names.

    Parameters
    ----------
    path : Path
    kind : type of Settings
        Class of the file.
    holds : str
        What the file holds, for the message where there is none.
    hint : str
        How to make one.

    Returns
    -------
    settings
        Of the class `kind`.

    Raises
    ------
    ConfigError
        As for `read_run_settings`.

    Examples
    --------
    >>> read_named(Path("no.toml"), RunSettings, holds="a plan", hint="Give a file.")
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected a plan in no.toml; there is no such file. Give a file.
    """
    if not path.is_file():
        what = "it is a directory" if path.is_dir() else "there is no such file"
        raise ConfigError(f"Expected {holds} in {path}; {what}. {hint}")
    return _load(path, kind, allow_outside=True)  # the user names the file itself


def _load(path: Path, kind: type[_Settings], *, allow_outside: bool) -> _Settings:
    """The tables of a file as settings; ConfigError with all gaps and faults."""
    raw = read_toml(path)
    read_bore(raw, path.parent, allow_outside=allow_outside)
    gaps, faults = list(find_gaps(raw)), find_faults(raw, kind)
    if not gaps and not faults:
        return kind.model_validate(raw)

    lines = [f"  {fault.text}" for fault in faults]
    if not gaps:
        listed = "\n".join(lines)
        raise ConfigError(f"Expected settings as documented in {path}; correct these:\n{listed}")

    head = ["and correct these:"] if faults else []
    listed = "\n".join([*(f"  {_explain_gap(gap, kind)}" for gap in gaps), *head, *lines])
    raise ConfigError(
        f"Expected a value for every key of {path}; {count_gaps(gaps)}. Replace each ??:\n{listed}"
    )


class Fault(NamedTuple):
    """A key or value that cannot be used.

    Attributes
    ----------
    place : tuple[str, ...]
        Names of the tables around it, and of the key; of a contradiction, of the tables alone.
    text : str
        What was expected and what came, with the place.
    """

    place: tuple[str, ...]
    text: str


def find_faults(raw: dict[str, Any], kind: type[Settings]) -> list[Fault]:
    """Find the keys and values that cannot be used, gaps left out.

    Parameters
    ----------
    raw : dict
        From TOML.
    kind : type of Settings
        Class of the file.

    Returns
    -------
    list of Fault

    Examples
    --------
    >>> from erlif.io.settings import OpticsSettings
    >>> find_faults({"pixel_pitch": "75 V"}, OpticsSettings)[0].place
    ('pixel_pitch',)
    """
    gaps = list(find_gaps(raw))
    try:
        kind.model_validate(raw)
    except ValidationError as error:
        details: list[ErrorDetails] = error.errors()
        places = [(_location(fault), fault) for fault in details]
        return [Fault(place, _explain(fault, kind)) for place, fault in places if place not in gaps]
    return []


def _read(
    directory: Path, name: str, kind: type[_Settings], *, allow_outside: bool = False
) -> _Settings:
    """Settings of a recording; ConfigError also where its directory or its file is missing."""
    path = directory / name
    if not directory.is_dir():
        hint = " Name the directory of the recording."
        if directory.name == name:
            hint = f" Name the directory that holds it: {directory.parent}"
        elif directory.suffix in (".nc", ".zarr"):
            hint = f" Did you mean: erlif figures {directory}?"
        raise ConfigError(
            f"Expected a directory with {name} in it; {directory} is not a directory.{hint}"
        )
    if not path.exists():
        other = {"run.toml": "fixture.toml", "fixture.toml": "run.toml"}[name]
        option = " --fixture" if name == "fixture.toml" else ""
        hint = f"Make one from the files in it with: erlif init {directory}{option}"
        if (directory / other).is_file():
            hint = f"It holds {other}: use the command for that, or name another directory."
        raise ConfigError(f"Expected {name} in {directory}; there is none. {hint}")
    return _load(path, kind, allow_outside=allow_outside)


def read_toml(path: Path) -> dict[str, Any]:
    """The file as TOML has it; ConfigError where it is something else."""
    try:
        return tomllib.loads(read_bounded(path, largest=_LARGEST_FILE).decode("utf-8-sig"))
    except OSError as error:
        raise ConfigError(
            f"Expected settings in {path}; it cannot be read: {error.strerror}. Put a settings "
            "file there, or make one with erlif init."
        ) from error
    except (ValueError, RecursionError) as error:
        raise ConfigError(
            f"Expected valid TOML in {path}; got {error}. Correct that place; text and quantities "
            "stand in double quotes."
        ) from error


def find_gaps(table: dict[str, Any], path: _Location = ()) -> Iterator[_Location]:
    """Find the values that are still to be filled in.

    Parameters
    ----------
    table : dict
        From TOML.
    path : tuple of str
        Place of the table in the file.

    Yields
    ------
    tuple of str
        Names of the tables around a gap, and of its key.

    Examples
    --------
    >>> list(find_gaps({"run": {"name": "wear"}, "optics": {"pixel_pitch": "?? um"}}))
    [('optics', 'pixel_pitch')]
    """
    for name, value in table.items():
        if isinstance(value, dict):
            yield from find_gaps(value, (*path, name))
        elif isinstance(value, str) and _GAP.fullmatch(value.strip()):
            yield (*path, name)


def count_gaps(gaps: Collection[_Location]) -> str:
    """The number of gaps in words, such as "1 gap is left"."""
    return f"{count_of(len(gaps), 'gap')} {'is' if len(gaps) == 1 else 'are'} left"


def _location(fault: ErrorDetails) -> _Location:
    return tuple(str(part) for part in fault["loc"] if part not in _KINDS)


def _place(location: _Location) -> str:
    """Table and key as they stand in the file."""
    table, key = ".".join(location[:-1]), location[-1] if location else ""
    return f"[{table}] {key}" if table else key


def _explain_gap(gap: _Location, kind: type[Settings]) -> str:
    """One line about one gap: table, key, expected form with its unit, and the meaning."""
    key = _find_key(gap, kind)
    if key is None:
        return f"{_place(gap)}: unknown key"
    # what happens without the key is no help to whoever has to fill it in
    meaning = key.meaning.partition(" Default: ")[0]
    return f"{_place(gap)}: {key.expected}. {meaning}"


def _find_key(location: _Location, kind: type[Settings]) -> Key | None:
    tables = _tables_at(kind, location[:-1])
    keys = (key for table in tables for key in keys_of(table))
    return next((key for key in keys if key.name == location[-1]), None)


def _explain(fault: ErrorDetails, kind: type[Settings]) -> str:
    """One line about one fault: table, key, what was expected and what came."""
    location, where = _location(fault), _place(_location(fault))
    key, got = location[-1] if location else "", fault["input"]
    match fault["type"]:
        # keys and tables
        case "extra_forbidden":
            return f"{where}: unknown key; {_suggest(key, kind, fault['loc'][:-1])}"
        case "missing":
            is_table = _find_key(location, kind) is None
            if is_table and len(location) == 1:
                return f"[{key}]: missing table"
            return f"{where}: missing {'table' if is_table else 'key'}"
        case "model_type" | "model_attributes_type":
            return f"{where}: expected a table, got {got!r}"
        case "union_tag_not_found" | "union_tag_invalid":
            got = got.get("kind", "nothing") if isinstance(got, dict) else got
            kinds = ", ".join(f'"{name}"' for name in _KINDS)
            return f"[{key}] kind: expected one of {kinds}, got {got!r}"

        # values
        case "value_error":  # a check of ours, whose message is complete
            message = fault["msg"].removeprefix("Value error, ")
            return f"{where}: {message}" if where else message
        case "tuple_type" | "list_type" if (known := _find_key(location, kind)) is not None:
            return f"{where}: expected a {known.expected}, got {got!r}"
        case "string_too_short":
            return f"{where}: expected a file name, got ''"
        case "string_pattern_mismatch":
            return f"{where}: expected text without control characters, got {got!r}"
        case _:
            limit = fault["msg"].replace("Input should", "it should")
            if fault["type"] in _BOUNDS and (known := _find_key(location, kind)) and known.unit:
                limit += f" {known.unit.removeprefix('delta_')}"
            return f"{where}: {limit}; got {got!r}"


# Faults of a number, whose limit is in the unit in which the key is kept.
_BOUNDS = {"greater_than", "greater_than_equal", "less_than", "less_than_equal"}


def _suggest(key: str, kind: type[Settings], location: tuple[int | str, ...]) -> str:
    """The table that an unknown key belongs to, the known key nearest to it, or all of them."""
    homes = (n for n, each in kind.model_fields.items() if key in _keys_below(each.annotation))
    if elsewhere := " or ".join(f"[{name}]" for name in homes):
        return f"it belongs to {elsewhere}"
    known = [name for table in _tables_at(kind, location) for name in table.model_fields]
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
    return f"did you mean {near[0]!r}?" if near else f"known here: {', '.join(known)}"


def _keys_below(annotation: Any) -> set[str]:
    """The keys of the tables that a field may hold."""
    return {name for table in tables_in(annotation) for name in table.model_fields}


def _tables_at(kind: type[Settings], location: tuple[int | str, ...]) -> list[type[Settings]]:
    """Tables that may stand at `location`, found by walking the nested settings."""
    tables: list[type[Settings]] = [kind]
    for part in location:
        if part in _KINDS:
            tables = [_KINDS[str(part)]]
            continue
        fields = [table.model_fields.get(str(part)) for table in tables]
        tables = [
            found for field in fields if field is not None for found in tables_in(field.annotation)
        ]
    return tables
