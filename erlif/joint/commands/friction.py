"""``erlif friction``: torque logs of bushings whose motion reverses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from erlif.commands.lines import describe_written, wrap
from erlif.commands.options import LENGTH, OVERWRITE, PATH, QuantityOption, output_option
from erlif.core.speed.imports import large_imports
from erlif.joint.commands.log_columns import choose_columns, describe_reading, log_options

_SHARE = click.FloatRange(min=0, max=1)


@click.command()
@click.argument("log", type=PATH)
@click.option("--radius", type=LENGTH, help='Radius of the shaft, "5 mm".')
@click.option("--diameter", type=LENGTH, help='Or its diameter, "10 mm".')
@click.option(
    "--load", type=QuantityOption("N", "LOAD"), help='Constant load, "5 kN"; no cells are read.'
)
@click.option("--arm", type=LENGTH, help='Arm of the torque\'s load cell, "30 cm".')
@click.option("--vector", is_flag=True, help="The load is the vector sum of the cells.")
@click.option("--speed", type=QuantityOption("m/s", "SPEED"), help='Sliding speed, "10 mm/s".')
@click.option("--torque-std", type=_SHARE, default=0.0, help="Relative error of the torque.")
@click.option("--load-std", type=_SHARE, default=0.0, help="Relative error of the load.")
@click.option("--radius-std", type=_SHARE, default=0.0, help="Relative error of the radius.")
@click.option(
    "--torque-ratio",
    type=click.FloatRange(min=1),
    default=1.0,
    show_default=True,
    help="Torque ratio of the contact, 1.273 once it is worn in; gives the true coefficient.",
)
@log_options("time, cells, torque or arm_force")
@output_option("Directory", "friction/ beside the log")
@OVERWRITE
def friction(
    log: Path,
    radius: float | None,
    diameter: float | None,
    load: float | None,
    vector: bool,
    torque_ratio: float,
    columns: dict[str, tuple[str, ...]],
    units: dict[str, tuple[str, ...]],
    skip_bad_rows: bool,
    compression_negative: bool,
    output: Path | None,
    overwrite: bool,
    **measured: Any,
) -> None:
    """Compute the friction of a bushing from a torque log.

    Half the difference of both directions is free of an offset of the cell. Prints the coefficient
    with its standard deviation by cause, draws it over time or sliding distance, and writes a table
    of the pairs of stretches.

    \b
    Example:
      erlif friction bushing.csv --radius "5 mm" --vector --load-std 0.01
    """
    with large_imports():
        from erlif.io.files import make_folder, refuse_existing
        from erlif.joint.friction import (
            analyse_friction,
            describe_friction,
            read_torque_log,
            write_friction_table,
        )
        from erlif.joint.plots import write_reversal_figure

    if (radius is None) == (diameter is None):
        raise click.UsageError(
            'Expected either the radius or the diameter of the shaft. Give it: --radius "5 mm"'
        )
    radius = 0.5 * diameter if radius is None else radius  # type: ignore[operator]
    choice = choose_columns(columns, units)
    output = output or log.parent / "friction"
    table, picture = output / f"{log.stem}.csv", output / f"{log.stem}.png"
    # everything that can be refused is refused before the work starts
    for path in (table, picture):
        refuse_existing(path, overwrite=overwrite)

    read = read_torque_log(
        log,
        choice,
        load=load,
        vector=vector,
        skip_bad_rows=skip_bad_rows,
        compression_negative=compression_negative,
    )
    result = analyse_friction(read, shaft_radius=radius, vector=vector, **measured)
    click.echo(wrap("\n".join(describe_friction(result, torque_ratio=torque_ratio))))
    click.echo(wrap("\n".join(describe_reading(read))) + "\n")
    make_folder(output)
    written = [write_friction_table(result, table), write_reversal_figure(result, picture)]
    click.echo(describe_written(written))
