"""What a rig keeps from an earlier run or fixture, and what each of them states anew."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from erlif.io.settings import (
    FixtureSettings,
    RunSettings,
    keys_of,
    read_fixture_settings,
    read_run_settings,
    tables_of,
)

# Keys that each run states anew; beside the gap stands the value of the earlier run.
_OF_RUN = {
    *("mechanism.crank_speed", "mechanism.speed", "mechanism.frequency", "mechanism.load"),
    *("oil.viscosity", "contact.load", "temperature.camera1", "temperature.camera2"),
    *("fixture.origin", "fixture.temperature"),
}

# Keys that follow from the files of a run, where they are needed.
_OF_FILES = {
    *("run.name", "fixture.name", "camera1.offset", "camera2.offset", "joint.load"),
    *("encoder.triggers_per_cycle", "encoder.bins", "encoder.start", "prediction.start_film"),
}


@dataclass(frozen=True)
class EarlierSettings:
    """Values of earlier settings by their places, as "optics.pixel_pitch".

    Attributes
    ----------
    tables : Collection[str]
        Tables that the earlier settings have.
    kept : Mapping[str, Any]
        What the rig keeps, as the file has it.
    of_run : Mapping[str, Any]
        What each run or fixture states anew.
    """

    tables: Collection[str]
    kept: Mapping[str, Any] = field(default_factory=dict)
    of_run: Mapping[str, Any] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        """Tribometer; a static film has no mechanism."""
        return str(self.kept.get("mechanism.kind", "static"))


def read_earlier(directory: Path, *, fixture: bool) -> EarlierSettings:
    """Read what the settings of an earlier run, or fixture, hold for the next one.

    Names of files and values that follow from files are left out.

    Parameters
    ----------
    directory : Path
        Of the earlier run or fixture.
    fixture : bool
        Whether it is a fixture.

    Returns
    -------
    EarlierSettings

    Raises
    ------
    ConfigError
        If the settings cannot be read or have gaps.

    Examples
    --------
    >>> earlier = read_earlier(Path("data_samples/straight_bushing"), fixture=False)
    >>> earlier.kind, earlier.kept["optics.pixel_pitch"], "run.name" in earlier.kept
    ('crank-rocker', '75 um', False)
    """
    (read_fixture_settings if fixture else read_run_settings)(directory)  # refuses faults
    settings = FixtureSettings if fixture else RunSettings
    path = directory / ("fixture.toml" if fixture else "run.toml")
    stated = tomllib.loads(path.read_text(encoding="utf-8-sig"))

    # an optional table inside of another one is a value of it
    tables = [one for one in tables_of(settings) if one.required or len(one.path) == 1]
    left_out = _OF_FILES | {table.title for table in tables}
    kept, of_run = {}, {}
    for table in tables:
        part: Any = stated
        for name in table.path:
            part = part.get(name, {})
        files = {key.name for key in keys_of(table.kind) if "file name" in key.form}
        for name in part.keys() - files:
            place = f"{table.title}.{name}".lstrip(".")
            if place in _OF_RUN:
                of_run[place] = part[name]
            elif place not in left_out:
                kept[place] = part[name]
    return EarlierSettings(stated, kept, of_run)
