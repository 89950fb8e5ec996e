"""The tables of endurance.toml: columns, machine and designs of endurance tests."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import Field

from erlif.io.settings.reading import read_named
from erlif.io.settings.values import (
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

    time: ColumnName | None = Field(None, examples=["Time [s]"])
    """Column of the times."""
    cells: ColumnNames | None = None
    """Columns of the load cells, which are added."""
    torque: ColumnName | None = Field(None, examples=["Torque [N m]"])
    """Column of the torque."""
    arm_force: ColumnName | None = Field(None, examples=["Third cell [N]"])
    """Column of the force on the arm that holds the torque, in place of it."""
    temperature: ColumnNames | None = Field(None, examples=[["Pin temperature [degC]"]])
    """Columns of the temperature, which are averaged."""
    vibration: ColumnNames | None = Field(None, examples=[["Vibration [g]"]])
    """Columns of the level of vibration."""


class LogUnits(Settings):
    """Units of columns whose header has none; they take precedence over the header."""

    time: TimeUnit | None = None
    """Time."""
    cells: ForceUnit | None = None
    """Load cells."""
    torque: TorqueUnit | None = None
    """Torque."""
    arm_force: ForceUnit | None = None
    """Force on the arm."""
    temperature: TemperatureUnit | None = None
    """Temperature."""


class MachineSettings(Settings):
    """The test machine."""

    pin_radius: Length | None = None
    """Radius of the pin."""
    arm: Length | None = None
    """Arm of the load cell that holds the torque; needed for arm_force."""
    torque_ratio: float = Field(1.0, strict=True, gt=0)
    """T* of the pressure distribution; 1 gives the apparent coefficient."""
    tare: Tare = 0.0
    """Reading of the cells together without load."""
    load_error: float = Field(0.005, strict=True, ge=0, lt=1)
    """Relative standard deviation of the cells' calibration."""
    idle_load: Tare | None = None
    """Stretches up to this load are idle runs. Default: those below a load that was reached
    before."""


class GallingOptions(Settings):
    """What is called galling."""

    significance: float = Field(0.01, strict=True, gt=0, lt=1)
    """Largest probability of a false alarm in a test."""
    least_rise: float = Field(0.02, strict=True, ge=0)
    """Smallest rise of friction."""


class EnduranceSettings(Settings):
    """endurance.toml."""

    columns: LogColumnSettings = LogColumnSettings()
    units: LogUnits = LogUnits()
    machine: MachineSettings = MachineSettings()
    galling: GallingOptions = GallingOptions()
    designs: Patterns = Field({})
    """Logs by the name of their design; two designs are compared."""


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
