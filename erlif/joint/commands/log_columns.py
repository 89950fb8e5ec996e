"""Options of the commands that read logs of test machines: columns and their units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from erlif.commands.options import Command, together

if TYPE_CHECKING:
    from erlif.joint.friction import LogColumns


def column_pairs(
    ctx: click.Context, option: click.Parameter, values: tuple[str, ...]
) -> dict[str, tuple[str, ...]]:
    """Read options of the form QUANTITY=NAME,NAME."""
    pairs: dict[str, tuple[str, ...]] = {}
    for value in values:
        name, equals, names = value.partition("=")
        if not (name and equals and names):
            raise click.BadParameter(f'expected QUANTITY=NAME, such as time="Zeit"; got {value!r}')
        pairs[name.strip()] = tuple(part.strip() for part in names.split(",") if part.strip())
    return pairs


def log_options(held: str) -> Callable[[Command], Command]:
    """Options of a command that reads logs: columns, their units, and how rows are read.

    Parameters
    ----------
    held : str
        What a column can hold, for the help.
    """
    pairs: dict[str, Any] = {"multiple": True, "callback": column_pairs}
    # a quantity may have several columns, so that each option may be repeated
    return together(
        click.option(
            "--column",
            "columns",
            metavar="QUANTITY=NAME",
            help=f"Column of {held}; names of several cells are separated by commas.",
            **pairs,
        ),
        click.option(
            "--unit",
            "units",
            metavar="QUANTITY=UNIT",
            help="Unit of a column whose header has none.",
            **pairs,
        ),
        click.option(
            "--skip-bad-rows",
            is_flag=True,
            help="Leave out rows in which a used column has no number; a note counts them.",
        ),
        click.option(
            "--compression-negative",
            is_flag=True,
            help="The load cells read compression as negative.",
        ),
    )


def describe_reading(log: Any) -> list[str]:
    """Describe the columns read from a log, the unused ones, and what was left out."""
    lines = [f"columns: {log.attrs['columns']}"]
    if log.attrs["unused"]:
        lines.append(f"columns not used: {log.attrs['unused']}")
    if log.attrs["left_out"]:
        lines.append(f"note: {log.attrs['left_out']}")
    return lines


def choose_columns(
    columns: dict[str, tuple[str, ...]],
    units: dict[str, tuple[str, ...]],
    named: LogColumns | None = None,
) -> LogColumns:
    """The columns as the reader takes them: those of the options, before those of settings."""
    from erlif.joint.friction import QUANTITIES, SEVERAL, LogColumns

    for option, given in (("--column", columns), ("--unit", units)):
        for name in given:
            if name not in QUANTITIES:
                raise click.BadParameter(
                    f"expected one of {', '.join(QUANTITIES)}; got {name!r}", param_hint=option
                )
    chosen: dict[str, Any] = {}
    for name, names in columns.items():
        if len(names) > 1 and name not in SEVERAL:
            raise click.BadParameter(
                f"expected one column for {name}; got {len(names)}", param_hint="--column"
            )
        chosen[name] = names if name in SEVERAL else names[0]
    named = named or LogColumns()
    of_units = {**named.units, **{name: unit[0] for name, unit in units.items()}}
    return replace(named, **chosen, units=of_units)
