"""The tables of endurance.toml: columns, machine and designs of endurance tests."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from erlif.io.settings.tables import (
    ColumnName,
    FileName,
    Form,
    Length,
    Settings,
    Text,
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

    time: ColumnName | None = Field(None, description="Column of the times.")
    cells: ColumnNames | None = Field(
        None, description="Columns of the load cells, which are added."
    )
    torque: ColumnName | None = Field(None, description="Column of the torque.")
    arm_force: ColumnName | None = Field(
        None, description="Column of the force on the arm that holds the torque, in place of it."
    )
    temperature: ColumnNames | None = Field(
        None, description="Columns of the temperature, which are averaged."
    )
    vibration: ColumnNames | None = Field(None, description="Columns of the level of vibration.")


class LogUnits(Settings):
    """Units of columns whose header has none; they take precedence over the header."""

    time: Literal["s", "ms", "us", "ns", "min", "h"] | None = Field(None, description="Time.")
    cells: Literal["N", "kN", "mN", "lbf", "kgf"] | None = Field(None, description="Load cells.")
    torque: Literal["N m", "kN m", "N mm", "lbf ft", "lbf in"] | None = Field(
        None, description="Torque."
    )
    arm_force: Literal["N", "kN", "mN", "lbf", "kgf"] | None = Field(
        None, description="Force on the arm."
    )
    temperature: Literal["degC", "K", "degF"] | None = Field(None, description="Temperature.")


class MachineSettings(Settings):
    """The test machine."""

    pin_radius: Length | None = Field(None, description="Radius of the pin.")
    arm: Length | None = Field(
        None, description="Arm of the load cell that holds the torque; needed for arm_force."
    )
    torque_ratio: float = Field(
        1.0,
        gt=0,
        description="T* of the pressure distribution; 1 gives the apparent coefficient.",
    )
    tare: Tare = Field(
        0.0, description="Reading of the cells together without load.", validate_default=False
    )
    load_error: float = Field(
        0.005, ge=0, lt=1, description="Relative standard deviation of the cells' calibration."
    )
    idle_load: Tare | None = Field(
        None,
        description="Stretches up to this load are idle runs. Default: those below a load that "
        "was reached before.",
    )


class GallingOptions(Settings):
    """What is called galling."""

    significance: float = Field(
        0.01, gt=0, lt=1, description="Largest probability of a false alarm in a test."
    )
    least_rise: float = Field(0.02, ge=0, description="Smallest rise of friction.")


class EnduranceSettings(Settings):
    """endurance.toml."""

    columns: LogColumnSettings = LogColumnSettings()
    units: LogUnits = LogUnits()
    machine: MachineSettings = MachineSettings()
    galling: GallingOptions = GallingOptions()
    designs: Patterns = Field(
        {}, description="Logs by the name of their design; two designs are compared."
    )
