"""``erlif endurance``: endurance tests of bearings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from erlif.commands.lines import describe_written, verbosity, wrap
from erlif.commands.options import LENGTH, OVERWRITE, PATH, QuantityOption, output_option
from erlif.core.speed.imports import large_imports
from erlif.joint.commands.log_columns import (
    choose_columns,
    column_pairs,
    describe_reading,
    log_options,
)

if TYPE_CHECKING:
    from erlif.joint.endurance import EnduranceResult

_FEWEST_RUNS = 2


@click.command()
@click.argument("logs", metavar="LOG...", type=PATH, nargs=-1, required=True)
@click.option("--settings", type=PATH, help="endurance.toml; options take precedence over it.")
@click.option("--radius", "pin_radius", type=LENGTH, help='Radius of the pin, "33.36 mm".')
@click.option("--arm", type=LENGTH, help='Arm of the torque\'s load cell, "30 cm".')
@click.option(
    "--idle-load", type=QuantityOption("N", "LOAD"), help='Load up to which a run is idle, "2 kN".'
)
@click.option(
    "--least-rise",
    type=click.FloatRange(min=0),
    help="Smallest rise of friction that is called galling.  [default: 0.02]",
)
@click.option(
    "--group",
    "designs",
    metavar="NAME=PATTERN",
    multiple=True,
    callback=column_pairs,
    help="Logs of a design by their file names, twice; default: [designs] of the settings.",
)
@click.option(
    "--model",
    type=click.Choice(["lognormal", "weibull"]),
    default="lognormal",
    show_default=True,
    help="Distribution of the load at failure for the comparison.",
)
@log_options("time, cells, torque, arm_force, temperature or vibration")
@output_option("Directory", "endurance/ beside the log")
@OVERWRITE
def endurance(
    logs: tuple[Path, ...],
    settings: Path | None,
    columns: dict[str, tuple[str, ...]],
    units: dict[str, tuple[str, ...]],
    designs: dict[str, tuple[str, ...]],
    model: Literal["lognormal", "weibull"],
    skip_bad_rows: bool,
    compression_negative: bool,
    output: Path | None,
    overwrite: bool,
    **stated: float | None,
) -> None:
    """Find the onset of galling and the failure load in endurance logs.

    Prints them with their uncertainties, draws load, torque, friction and temperature over time,
    and writes a table of the tests. Two designs are compared by their loads at failure.

    \b
    Example:
      erlif endurance run_1.csv --radius "33.36 mm" --arm "30 cm"
      erlif endurance *.csv --settings endurance.toml \\
          --group uncut=uncut_* --group new=new_*
    """
    with large_imports():
        from erlif.io.files import make_folder, refuse_existing
        from erlif.joint.endurance import (
            analyse_endurance,
            compare_designs,
            describe_designs,
            write_test_table,
        )
        from erlif.joint.friction import LogColumns, read_torque_log
        from erlif.joint.plots import name_overviews, write_designs_figure, write_endurance_figures
        from erlif.joint.settings import EnduranceSettings, read_endurance_settings

    # everything that can be refused is refused before anything is written
    given = read_endurance_settings(settings) if settings else EnduranceSettings()
    # an option that is not given leaves the value of the settings
    of_options = {name: value for name, value in stated.items() if value is not None}
    used: dict[str, Any] = {**dict(given.machine), **dict(given.galling), **of_options}
    if used["pin_radius"] is None:
        raise click.UsageError('Expected the radius of the pin. Give it: --radius "33.36 mm"')
    named = LogColumns(
        **given.columns.model_dump(exclude_none=True),
        units=given.units.model_dump(exclude_none=True),
    )
    choice = choose_columns(columns, units, named)

    # pictures and rows are named after the logs
    names = [log.stem for log in logs]
    overviews = name_overviews(names)
    if doubled := {name for name in names if names.count(name) > 1}:
        raise click.UsageError(
            f"Expected logs of different names; {', '.join(sorted(doubled))} comes twice. Rename "
            "one, or analyse them with different -o."
        )
    members = _divide(logs, designs or dict(given.designs))
    output = output or logs[0].parent / "endurance"
    table = output / "endurance.csv"
    refuse_existing(table, overwrite=overwrite)
    for picture in overviews.values():
        refuse_existing(output / picture, overwrite=overwrite)

    reading = {"skip_bad_rows": skip_bad_rows, "compression_negative": compression_negative}
    used["calibration"] = used.pop("load_error")
    results = [
        analyse_endurance(read_torque_log(log, choice, **reading), name=log.stem, **used)
        for log in logs
    ]
    click.echo(wrap("\n".join(_describe(results))) + "\n")

    # the tests of both designs are known only after all logs
    if members:
        (first, one), (second, other) = members.items()
        failures = {result.name: result.failure for result in results}
        old, new = ([failures[name] for name in design] for design in (one, other))
        compared = compare_designs(old, new, names=(first, second), model=model)
        click.echo(wrap("\n".join(describe_designs(compared))) + "\n")
    make_folder(output)
    written = [write_test_table(results, table)]
    for result in results:
        written += write_endurance_figures(result, output, overview=overviews[result.name])
    if members:
        written.append(write_designs_figure(compared, old, new, output))
    click.echo(describe_written(written))


def _describe(results: Sequence[EnduranceResult]) -> Iterator[str]:
    """A single test and its columns in full; of several a row each, with ``-v`` in full."""
    from erlif.joint.endurance import describe_test, describe_tests

    reading = {result.name: describe_reading(result.test) for result in results}
    if len(results) == 1 or verbosity():
        for result in results:
            yield from (*describe_test(result), *reading[result.name], "")
        return
    yield from describe_tests(results)
    # logs of one machine have the same columns
    for line in dict.fromkeys(line for lines in reading.values() for line in lines):
        named = [name for name, lines in reading.items() if line in lines]
        yield line if len(named) == len(reading) else f"{', '.join(named)}: {line}"
    yield "Stages, changes of temperature and vibration, and notes: -v"


def _divide(logs: tuple[Path, ...], designs: Mapping[str, Sequence[str]]) -> dict[str, list[str]]:
    """Names of the logs of both designs."""
    members: dict[str, list[str]] = {}
    for name, patterns in designs.items():
        members[name] = [
            log.stem
            for log in logs
            if any(fnmatch(text, one) for one in patterns for text in (log.name, log.stem))
        ]
        if len(members[name]) < _FEWEST_RUNS:
            raise click.UsageError(
                f"Expected at least two logs of design {name}; {', '.join(patterns)} fits "
                f"{len(members[name])} of them. Give more logs, or another pattern."
            )
    of_any = [log for found in members.values() for log in found]
    twice = next((log for log in of_any if of_any.count(log) > 1), "")
    if len(members) not in (0, 2) or twice:
        what = f"{twice} belongs to two" if twice else f"got {len(members)}"
        raise click.UsageError(
            f"Expected two designs, each log in one; {what}. Give --group NAME=PATTERN "
            "twice, with patterns that no log shares."
        )
    return members
