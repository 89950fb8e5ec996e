"""The tables of endurance.toml: columns, machine and designs of endurance tests."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import Field

from erlif.io.settings.reading import read_named
from erlif.io.settings.tables import (
    ColumnName,
    FileName,
    ForceUnit,
    Form,
    Length,
    Settings,
    TemperatureUnit,
    Text,
    TimeUnit,
    TorqueUnit,
    quantity,
)

Tare = Annotated[float, *quantity("force", "0 N", "N")]
ColumnNames = Annotated[tuple[ColumnName, ...], Form("list of columns", ("Cell 1", "Cell 2"))]
Patterns = Annotated[
    dict[Text, tuple[FileName, ...]],
    Form("lists of file names or patterns", {"uncut": ["uncut_*.csv"]}),
]


class LogColumnSettings(Settings):
    """Columns of the logs; what is left out is found by its name."""

    time: ColumnName | None = None
    cells: ColumnNames | None = None
    torque: ColumnName | None = None
    arm_force: ColumnName | None = None
    temperature: ColumnNames | None = None
    vibration: ColumnNames | None = None


class LogUnits(Settings):
    """Units of columns whose header has none; they take precedence over the header."""

    time: TimeUnit | None = None
    cells: ForceUnit | None = None
    torque: TorqueUnit | None = None
    arm_force: ForceUnit | None = None
    temperature: TemperatureUnit | None = None


class MachineSettings(Settings):
    """The test machine."""

    pin_radius: Length | None = None
    arm: Length | None = None
    torque_ratio: float = Field(1.0, strict=True, gt=0)
    tare: Tare = 0.0
    load_error: float = Field(0.005, strict=True, ge=0, lt=1)
    idle_load: Tare | None = None


class GallingOptions(Settings):
    """What is called galling."""

    significance: float = Field(0.01, strict=True, gt=0, lt=1)
    least_rise: float = Field(0.02, strict=True, ge=0)


class EnduranceSettings(Settings):
    """endurance.toml."""

    columns: LogColumnSettings = LogColumnSettings()
    units: LogUnits = LogUnits()
    machine: MachineSettings = MachineSettings()
    galling: GallingOptions = GallingOptions()
    designs: Patterns = Field({})


def read_endurance_settings(path: Path) -> EnduranceSettings:
    """Read and check the settings of endurance tests.

    Errors as for `erlif.io.settings.read_run_settings`; `path` is the file, endurance.toml.

    Returns
    -------
    EnduranceSettings

    Examples
    --------
    >>> read_endurance_settings(Path("no.toml"))
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected settings in no.toml; there is no such file. Give a file.
    """
    return read_named(path, EnduranceSettings, holds="settings", hint="Give a file.")
