"""run.toml and fixture.toml read and checked; every fault named in one message."""

from __future__ import annotations

import difflib
import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from erlif.core.errors import ConfigError
from erlif.settings.tables import (
    CrankRockerSettings,
    FixtureSettings,
    RunSettings,
    Settings,
    SliderCrankSettings,
)

_Settings = TypeVar("_Settings", bound="Settings")


def read_run_settings(run_dir: Path) -> RunSettings:
    """Read and check ``run.toml`` of a run directory.

    Raises
    ------
    ConfigError
        If the file is missing, is no TOML, or holds a value or key that cannot be used; all faults in one message.
    """
    return _read(run_dir, "run.toml", RunSettings)


def read_fixture_settings(fixture_dir: Path) -> FixtureSettings:
    """Read and check ``fixture.toml`` of a fixture directory; errors as for `read_run_settings`."""
    return _read(fixture_dir, "fixture.toml", FixtureSettings)


def _read(directory: Path, name: str, kind: type[_Settings]) -> _Settings:
    path = directory / name
    if not directory.is_dir():
        hint = (
            f" Name the directory that holds it: {directory.parent}"
            if directory.name == name
            else ""
        )
        raise ConfigError(
            f"Expected a directory with {name} in it; {directory} is not a directory.{hint}"
        )
    if not path.is_file():
        other = {"run.toml": "fixture.toml", "fixture.toml": "run.toml"}[name]
        hint = (
            f" It holds {other}: is it meant for the other command?"
            if (directory / other).is_file()
            else ""
        )
        raise ConfigError(
            f"Expected {name} in {directory}; there is none.{hint or ' Write one, or name another directory.'}"
        )
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise ConfigError(
            f"Expected settings in {path}; it cannot be read: {error.strerror}."
        ) from error
    except (ValueError, RecursionError) as error:
        raise ConfigError(
            f"Expected valid TOML in {path}; got {error}. Correct that place; text and quantities stand in double quotes."
        ) from error
    try:
        return kind.model_validate(raw)
    except ValidationError as error:
        faults = "\n".join(f"  {_explain(fault, kind)}" for fault in error.errors())
        raise ConfigError(
            f"Expected settings as documented in {path}; correct these:\n{faults}"
        ) from error


def _explain(fault: Any, kind: type[Settings]) -> str:
    """One line about one fault that pydantic found: table, key, what was expected and what came."""
    location = [str(part) for part in fault["loc"] if part not in ("crank-rocker", "slider-crank")]
    table, key = ".".join(location[:-1]), location[-1] if location else ""
    where = f"[{table}] {key}" if table else key
    if fault["type"] == "extra_forbidden":
        known = _known_keys(kind, fault["loc"][:-1])
        near = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]!r}?" if near else f"known here: {', '.join(known)}"
        return f"{where}: unknown key; {hint}"
    if fault["type"] == "missing":
        what = "table" if _tables_in(_annotation(kind, fault["loc"])) else "key"
        return (
            f"[{key}]: missing table"
            if what == "table" and not table
            else f"{where}: missing {what}"
        )
    if fault["type"] in ("union_tag_not_found", "union_tag_invalid"):
        got = (
            fault["input"].get("kind", "nothing")
            if isinstance(fault["input"], dict)
            else fault["input"]
        )
        return f'[{key}] kind: expected "crank-rocker" or "slider-crank", got {got!r}'
    if fault["type"] == "value_error":
        message = fault["msg"].removeprefix("Value error, ")
        return f"{where}: {message}" if where else message
    if fault["type"] in ("model_type", "model_attributes_type"):
        return f"{where}: expected a table, got {fault['input']!r}"
    if fault["type"] == "string_too_short":
        return f"{where}: expected a file name, got ''"
    if fault["type"] == "string_pattern_mismatch":
        return f"{where}: expected text without control characters, got {fault['input']!r}"
    return f"{where}: {fault['msg'].replace('Input should', 'it should')}; got {fault['input']!r}"


def _annotation(kind: type[Settings], location: tuple[Any, ...]) -> Any:
    """Type of the key at `location`."""
    tables = _tables_at(kind, location[:-1])
    return next(
        (
            table.model_fields[key].annotation
            for table in tables
            if (key := location[-1]) in table.model_fields
        ),
        None,
    )


def _known_keys(kind: type[Settings], location: tuple[Any, ...]) -> list[str]:
    return [name for table in _tables_at(kind, location) for name in table.model_fields]


def _tables_at(kind: type[Settings], location: tuple[Any, ...]) -> list[type[Settings]]:
    """Tables that may stand at `location`, found by walking the nested settings."""
    tables: list[type[Settings]] = [kind]
    for part in location:
        if part == "crank-rocker":
            tables = [CrankRockerSettings]
        elif part == "slider-crank":
            tables = [SliderCrankSettings]
        else:
            annotations = [
                table.model_fields[part].annotation
                for table in tables
                if part in table.model_fields
            ]
            tables = [found for annotation in annotations for found in _tables_in(annotation)]
    return tables


def _tables_in(annotation: Any) -> list[type[Settings]]:
    if isinstance(annotation, type):
        return [annotation] if issubclass(annotation, Settings) else []
    return [
        found for argument in getattr(annotation, "__args__", ()) for found in _tables_in(argument)
    ]
