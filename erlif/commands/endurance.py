"""``erlif endurance``: endurance tests of bearings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from erlif.commands.loading import large_imports
from erlif.commands.options import OVERWRITE, PATH
from erlif.core.units import parse_quantity


def _quantity(unit: str) -> Callable[..., float | None]:
    """Read the value of an option that is written with its unit."""

    def read(ctx: click.Context, option: click.Parameter, value: str | None) -> float | None:
        if value is None:
            return None
        try:
            return parse_quantity(value, unit)
        except ValueError as error:
            raise click.BadParameter(str(error)) from error

    return read


def _pairs(
    ctx: click.Context, option: click.Parameter, values: tuple[str, ...]
) -> dict[str, tuple[str, ...]]:
    """Read options of the form QUANTITY=NAME,NAME."""
    found: dict[str, tuple[str, ...]] = {}
    for value in values:
        name, equals, names = value.partition("=")
        if not (name and equals and names):
            raise click.BadParameter(f'expected QUANTITY=NAME, such as time="Zeit"; got {value!r}')
        found[name.strip()] = tuple(part.strip() for part in names.split(",") if part.strip())
    return found


@click.command()
@click.argument("logs", metavar="LOG...", type=PATH, nargs=-1, required=True)
@click.option("--radius", callback=_quantity("m"), help='Radius of the pin, "33.36 mm".')
@click.option("--arm", callback=_quantity("m"), help='Arm of the torque\'s load cell, "30 cm".')
@click.option(
    "--column",
    "columns",
    metavar="QUANTITY=NAME",
    multiple=True,
    callback=_pairs,
    help="Column of time, cells, torque, arm_force, temperature or vibration; names of several "
    "cells are separated by commas.",
)
@click.option(
    "--unit",
    "units",
    metavar="QUANTITY=UNIT",
    multiple=True,
    callback=_pairs,
    help="Unit of a column whose header has none.",
)
@click.option("-o", "--output", type=PATH, help="Directory; default: endurance/ beside the log.")
@OVERWRITE
def endurance(
    logs: tuple[Path, ...],
    radius: float | None,
    arm: float | None,
    columns: dict[str, tuple[str, ...]],
    units: dict[str, tuple[str, ...]],
    output: Path | None,
    overwrite: bool,
) -> None:
    """Find stages, onset of galling and load at failure in the logs of endurance tests.

    Prints them with their uncertainties, draws load, torque, friction and temperature over time,
    and writes a table of the tests.

    \b
    Example:
      erlif endurance run_1.csv --radius "33.36 mm" --arm "30 cm"
      erlif endurance run_1.csv --radius "33.36 mm" --column torque="Moment [N m]"
    """
    with large_imports():
        from erlif.endurance import (
            analyse_endurance,
            describe_test,
            read_endurance_log,
            write_test_table,
        )
        from erlif.files import refuse_existing
        from erlif.plots import write_endurance_figures

    if radius is None:
        raise click.UsageError('Expected the radius of the pin. Give it: --radius "33.36 mm"')
    choice = _choose(columns, units)
    output = output or logs[0].parent / "endurance"
    table = output / "endurance.csv"
    refuse_existing(table, overwrite=overwrite)
    for log in logs:
        refuse_existing(output / f"{log.stem}.png", overwrite=overwrite)

    found = []
    for log in logs:
        read = read_endurance_log(log, choice)
        found.append(analyse_endurance(read, pin_radius=radius, arm=arm, name=log.stem))
        click.echo("\n".join(describe_test(found[-1])))
        click.echo(f"  columns: {read.attrs['columns']}\n")
    click.echo(f"written: {write_test_table(found, table)}")
    for one in found:
        for path in write_endurance_figures(one, output):
            click.echo(f"written: {path}")


def _choose(columns: dict[str, tuple[str, ...]], units: dict[str, tuple[str, ...]]) -> Any:
    """The columns as the reader takes them."""
    from erlif.endurance import LogColumns
    from erlif.endurance.log import QUANTITIES, SEVERAL

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
    return LogColumns(**chosen, units={name: unit[0] for name, unit in units.items()})
