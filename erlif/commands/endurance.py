"""``erlif endurance``: endurance tests of bearings."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.loading import large_imports
from erlif.commands.log_columns import choose_columns, column_pairs, quantity
from erlif.commands.options import OVERWRITE, PATH


@click.command()
@click.argument("logs", metavar="LOG...", type=PATH, nargs=-1, required=True)
@click.option("--radius", callback=quantity("m"), help='Radius of the pin, "33.36 mm".')
@click.option("--arm", callback=quantity("m"), help='Arm of the torque\'s load cell, "30 cm".')
@click.option(
    "--column",
    "columns",
    metavar="QUANTITY=NAME",
    multiple=True,
    callback=column_pairs,
    help="Column of time, cells, torque, arm_force, temperature or vibration; names of several "
    "cells are separated by commas.",
)
@click.option(
    "--unit",
    "units",
    metavar="QUANTITY=UNIT",
    multiple=True,
    callback=column_pairs,
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
    choice = choose_columns(columns, units)
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
