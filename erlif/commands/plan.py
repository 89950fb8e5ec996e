"""``erlif plan``: what a rig would measure, before it is built."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.lines import describe_written, wrap
from erlif.commands.options import OVERWRITE, PATH, output_option
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("source", metavar="PLAN.TOML", type=PATH, required=False)
@output_option("Directory", "NAME/ beside NAME.toml, NAME_plan/ beside NAME")
@click.option("--example", is_flag=True, help="Print a commented plan that works as it is.")
@OVERWRITE
def plan(source: Path | None, output: Path | None, example: bool, overwrite: bool) -> None:
    """Predict ratio, uncertainty and range of a rig from its parts.

    The parts are dyes, filters, light and cameras. Prints the films, the frames needed, the best
    concentrations and the effect of each tolerance, and writes figure, tables and the plan with the
    best concentrations. `erlif simulate --parts` photographs a plan with the virtual rig.

    \b
    Example:
      erlif plan --example > plan.toml
      erlif plan plan.toml
      erlif simulate rehearsal --parts plan/optimum.toml
    """
    with large_imports():
        from erlif.planning.plan import example_plan
        from erlif.planning.plan import plan as predict
        from erlif.show.report import summarise_plan

    if example:
        click.echo(example_plan(), nl=False)
        return
    if source is None:
        raise click.UsageError(
            "Expected the name of a plan. Make one with: erlif plan --example > plan.toml"
        )
    from erlif.show.report import check_plan_output, write_plan

    # a plan without a suffix has the name that its directory would have
    output = output or (
        source.with_suffix("") if source.suffix else source.with_name(f"{source.name}_plan")
    )
    check_plan_output(output, overwrite=overwrite, source=source)
    planned = predict(source)
    click.echo(wrap(summarise_plan(planned)))
    click.echo()
    written = write_plan(planned, output, folder=source.parent, overwrite=overwrite)
    click.echo(describe_written(written))
    click.echo(f"next: erlif simulate rehearsal --parts {output / 'optimum.toml'}")
