"""run.toml and fixture.toml in the making: what they ask for, and changes that can be undone."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from erlif.core.errors import ConfigError, ErlifError
from erlif.core.notes import Note, list_some
from erlif.io.settings import FixtureSettings, Key, RunSettings, Settings, keys_of, tables_of
from erlif.io.settings.bore import read_bore
from erlif.io.settings.reading import Fault, find_faults, find_gaps, read_toml
from erlif.io.settings.template import gap_text
from erlif.io.settings.toml import toml_value
from erlif.review.init import init
from erlif.show.view.run_settings import MARK, Change, propose_change, write_change

# Names of the tables around a key, and its own.
Place = tuple[str, ...]

# The two files, by what they describe.
KINDS: dict[str, type[Settings]] = {"run": RunSettings, "fixture": FixtureSettings}

# Forms of values that are typed as TOML has them; all others are text.
_LITERAL = re.compile(r"integer|number|true or false|pair|interval|list")
_SEVERAL = re.compile(r"pair|interval|list")

_HEADING, _VALUE = re.compile(r"\s*\[([^\[\]]+)\]"), re.compile(r"\s*([\w.]+)\s*=")


class Step(NamedTuple):
    """A change that was made and can be undone.

    Attributes
    ----------
    name : str
        "run" or "fixture".
    title : str
        The keys that were changed.
    change : Change
    made : Mapping[Path, bytes]
        Files that were written for the change, with their contents: they are removed with it,
        unless somebody else has changed them since.
    """

    name: str
    title: str
    change: Change
    made: Mapping[Path, bytes] = {}


class Draft:
    """The settings of a run and of its fixture, as they stand in their files.

    Each change is written at once, and can be undone as long as nobody else changes the file.

    Attributes
    ----------
    directories : dict[str, Path]
        Of "run" and "fixture", as far as they are open.
    changes : list[Step]
        The last one is undone first.
    notes : dict[str, list[Note]]
        What was found in the directories when their settings were drafted.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> draft = Draft()
    >>> with TemporaryDirectory() as folder:
    ...     _ = Path(folder, "run.toml").write_text('[optics]\\npixel_pitch = "?? um"\\n')
    ...     draft.open("run", Path(folder))
    ...     draft.change("run", {"optics.pixel_pitch": "75"})
    ...     print(draft.changes[0].change.lines)
    -pixel_pitch = "?? um"
    +pixel_pitch = "75 um"
    """

    def __init__(self) -> None:
        self.directories: dict[str, Path] = {}
        self.changes: list[Step] = []
        self.notes: dict[str, list[Note]] = {}
        self._asked: dict[str, set[Place]] = {}

    def path(self, name: str) -> Path:
        """The settings file of "run" or "fixture"; ConfigError where it is not open."""
        if name not in self.directories:
            raise ConfigError(f"Expected a folder of the {name}; none is open. Choose it first.")
        return self.directories[name] / f"{name}.toml"

    def values(self, name: str) -> dict[str, Any]:
        """What the file holds, gaps included; empty where it is not open."""
        return read_toml(self.path(name)) if name in self.directories else {}

    def faults(self, name: str, values: Mapping[str, Any]) -> list[Fault]:
        """What cannot be used of these values of the file."""
        whole = deepcopy(dict(values))
        try:
            read_bore(whole, self.directories[name])
        except ErlifError as error:
            return [Fault(("joint", "bore", "profile"), str(error))]
        return find_faults(whole, KINDS[name])

    # changes

    def open(
        self, name: str, directory: Path, *, kind: str = "crank-rocker", anew: bool = False
    ) -> None:
        """Open the settings of a directory; where there are none, draft them from its files.

        Parameters
        ----------
        name : str
            "run" or "fixture".
        directory : Path
        kind : str
            Tribometer, as for `erlif.init`.
        anew : bool
            Draft them also where there are some.

        Raises
        ------
        ErlifError
            As `erlif.init`, or if the file cannot be read.
        """
        if name not in KINDS:
            raise ConfigError(f"Expected {' or '.join(KINDS)}; got {name!a}. Reload the page.")
        path = directory / f"{name}.toml"
        before = _text_of(path)
        notes = self.notes.get(name, []) if self.directories.get(name) == directory else []
        if not before or anew:
            fixture = name == "fixture"
            notes = init(directory, fixture=fixture, kind=kind, overwrite=path.exists())
        values = read_toml(path)
        self.directories[name], self.notes[name] = directory, notes
        self._asked[name] = set(find_gaps(values))
        if not before or anew:
            change = Change(path, before, _text_of(path))
            self.changes.append(Step(name, "drafted from the files", change))

    def propose(self, name: str, typed: Mapping[str, Any]) -> tuple[Change, list[Fault]]:
        """Work out a change without writing it.

        Parameters
        ----------
        name : str
            "run" or "fixture".
        typed : mapping of str to value
            By the place of a key, "optics.pixel_pitch": text as it was typed, or a value. Empty
            text takes an optional key out, and makes a gap of a required one.

        Returns
        -------
        Change
        list of Fault
            What the changed file has that cannot be used, and the file did not have before.

        Raises
        ------
        ConfigError
            If there is no such key, or the file cannot be changed.
        """
        path, known = self.path(name), self._keys(name, self.values(name))
        tables = {table for place in known for table in _prefixes(place)}
        values = {}
        for text, value in typed.items():
            place = tuple(text.split("."))
            if place not in tables or (place not in known and isinstance(value, str)):
                raise ConfigError(f"Expected a key of {path.name}; got {text!a}. Reload the page.")
            values[place] = read_typed(known[place], value) if isinstance(value, str) else value

        change = propose_change(path, values)
        earlier = {fault.text for fault in self.faults(name, _values_of(change.before))}
        faults = self.faults(name, _values_of(change.after))
        return change, [fault for fault in faults if fault.text not in earlier]

    def change(self, name: str, typed: Mapping[str, Any], *, made: Sequence[Path] = ()) -> None:
        """Change values and write the file; further arguments and errors as in `propose`.

        Parameters
        ----------
        made : sequence of Path
            Files that were written for the change, to be removed when it is undone.

        Raises
        ------
        ConfigError
            If a value cannot be used in its place. A contradiction between keys is no reason: it
            may take several changes to resolve.
        """
        change, faults = self.propose(name, typed)
        given = {tuple(place.split(".")) for place in typed}
        own = [fault.text for fault in faults if _prefixes(fault.place) & given]
        if own:
            raise ConfigError(" ".join(own))
        if change.after != change.before:
            self._asked[name] |= set(find_gaps(_values_of(change.after)))
            write_change(change, before=change.digest)
            contents = {path: path.read_bytes() for path in made}
            self.changes.append(Step(name, list_some(typed, most=2), change, contents))

    def exchange(self, name: str) -> None:
        """Exchange the tables of both cameras, which were taken for each other."""
        values = self.values(name)
        tables = values.get("camera1", {}), values.get("camera2", {})
        keys = tables[0] | tables[1]
        exchanged = {
            f"camera{camera}.{key}": table.get(key)
            for camera, table in zip((2, 1), tables, strict=True)
            for key in keys
        }
        self.change(name, exchanged)

    def undo(self) -> None:
        """Take the last change back.

        Raises
        ------
        ConfigError
            If there is none, or somebody else has changed the file since.
        """
        if not self.changes:
            raise ConfigError("Expected a change to undo; there is none. Nothing is changed.")
        step = self.changes[-1]
        last = step.change
        if _text_of(last.path) != last.after:
            raise ConfigError(
                f"Expected {last.path} as this page has written it; it was changed elsewhere. Undo "
                "the change there by hand."
            )
        if last.before:
            back = Change(last.path, last.after, last.before)
            write_change(back, before=back.digest)
        else:
            last.path.unlink()
            last.path.with_suffix(".schema.json").unlink(missing_ok=True)
            if self.directories.get(step.name) == last.path.parent:  # and not another one since
                del self.directories[step.name]

        self.changes.pop()
        for path, content in step.made.items():
            if path.exists() and path.read_bytes() == content:
                path.unlink()

    def link(self) -> None:
        """Name the calibration of the open fixture in the run that names none."""
        both = {"run", "fixture"} <= self.directories.keys()
        if not both or self.values("run").get("calibration"):
            return
        run, fixture = (self.directories[name] for name in ("run", "fixture"))
        self.change(
            "run",
            {"calibration": Path(os.path.relpath(fixture, run)).as_posix() + "/calibration.nc"},
        )

    # what is asked for

    def fields(self, name: str) -> Iterator[dict[str, Any]]:
        """Describe the keys of the file: value, form, unit, meaning, and the fault or remark."""
        values = self.values(name)
        gaps = set(find_gaps(values))
        other = self.values("fixture" if name == "run" else "run")
        faults = {fault.place: fault.text for fault in self.faults(name, values)}
        remarks = find_remarks(self.path(name).read_text(encoding="utf-8-sig"))
        for place, key in self._keys(name, values).items():
            gap, value = place in gaps, _value_at(values, place)
            there = _value_at(other, place)
            yield {
                "place": ".".join(place),
                "value": "" if gap or value is None else _as_typed(value),
                "gap": gap,
                "asked": place in self._asked[name] | gaps,
                "required": key.required,
                "unit": _unit_of(key),
                "expected": key.expected,
                "choices": ["true", "false"] if key.form == "true or false" else key.choices,
                "meaning": key.meaning,
                "remark": remarks.get(place, ""),
                "fault": faults.get(place, ""),
                "other": _as_typed(there)
                if gap and isinstance(there, str) and "??" not in there
                else "",
            }

    def _keys(self, name: str, values: Mapping[str, Any]) -> dict[Place, Key]:
        """Keys of the file in its order; of [mechanism] those of its kind."""
        kind = _value_at(values, ("mechanism", "kind"))
        return {
            place: key
            for place, form, key in _all_keys(KINDS[name])
            if place[0] != "mechanism" or form == kind
        }


@cache
def _all_keys(kind: type[Settings]) -> tuple[tuple[Place, str, Key], ...]:
    """Places and keys of a file, with the form of the table where it has several."""
    found = []
    for table in tables_of(kind):
        keys = list(keys_of(table.kind))
        form = keys[0].choices[0] if keys and keys[0].name == "kind" else ""
        found += [((*table.path, key.name), form, key) for key in keys]
    return tuple(found)


def _unit_of(key: Key) -> str:
    """Unit in which a bare number is meant."""
    return gap_text(key).partition(" ")[2]


def read_typed(key: Key, text: str) -> Any:
    """Value of a key from the text in a field.

    Parameters
    ----------
    key : Key
    text : str
        As typed; a bare number has the unit that stands beside the field.

    Returns
    -------
    value
        For TOML; None where an optional key is taken out.

    Examples
    --------
    >>> from erlif.io.settings import CameraSettings
    >>> keys = {key.name: key for key in keys_of(CameraSettings)}
    >>> read_typed(keys["band"], "580"), read_typed(keys["bit_depth"], "12")
    ('580 nm', 12)

    A pair needs no brackets:

    >>> from erlif.io.settings import FixtureSettings
    >>> (origin,) = (key for key in keys_of(FixtureSettings.model_fields["fixture"].annotation)
    ...              if key.name == "origin")
    >>> read_typed(origin, "0, 48")
    [0, 48]
    """
    text = text.strip()
    if not text:
        return gap_text(key) if key.required else None
    if (unit := _unit_of(key)) and re.fullmatch(r"[-+.\deE]+", text):
        return f"{text} {unit}"
    if not _LITERAL.match(key.form) and text[0] not in '[{"':
        return text
    if _SEVERAL.match(key.form) and re.fullmatch(r"[-+.\deE]+(\s*,\s*[-+.\deE]+)+", text):
        text = f"[{text}]"  # numbers with commas between them
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text  # the check of the settings names what was expected


def _text_of(path: Path) -> str:
    """Text of a file to the byte; empty where there is none."""
    return path.read_bytes().decode(errors="surrogateescape") if path.exists() else ""


def _values_of(text: str) -> dict[str, Any]:
    """What the text of a file holds."""
    return tomllib.loads(text.removeprefix(MARK))


def _prefixes(place: Place) -> set[Place]:
    """A place and the tables around it."""
    return {place[:n] for n in range(1, len(place) + 1)}


def _as_typed(value: Any) -> str:
    return value if isinstance(value, str) else toml_value(value)


def _value_at(values: Mapping[str, Any], place: Place) -> Any:
    """Value at a place; None where there is none."""
    part: Any = values
    for name in place:
        part = part.get(name) if isinstance(part, Mapping) else None
    return part


def find_remarks(text: str) -> dict[Place, str]:
    """Remarks of `erlif init` on single keys: the comment behind an arrow above each.

    Parameters
    ----------
    text : str
        A settings file.

    Returns
    -------
    dict of tuple of str to str

    Examples
    --------
    >>> find_remarks('[camera1]\\n# Bits.\\n# -> Largest count\\n# 3100.\\nbit_depth = 12\\n')
    {('camera1', 'bit_depth'): 'Largest count 3100.'}
    """
    found, table, comment = {}, "", ""
    for line in text.splitlines():
        if line.lstrip().startswith("#"):
            comment += f" {line.lstrip(' #')}"
            continue
        if heading := _HEADING.match(line):
            table = heading[1]
        elif (value := _VALUE.match(line)) and "-> " in comment:
            place = tuple(f"{table}.{value[1]}".lstrip(".").split("."))
            found[place] = comment.partition("-> ")[2]
        comment = ""
    return found
