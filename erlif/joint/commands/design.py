"""``erlif design``: a pin joint from load, motion, life and materials."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.lines import verbosity, wrap
from erlif.commands.options import OVERWRITE, PATH, expect_output, output_option
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("source", metavar="JOINT.TOML", type=PATH, required=False)
@click.option("--example", is_flag=True, help="Print a commented joint that works as it is.")
@click.option("--materials", is_flag=True, help="Print the table of materials with its sources.")
@output_option("Page with figures (.html), or the table of the steps (.csv)", "none")
@OVERWRITE
def design(
    source: Path | None, example: bool, materials: bool, output: Path | None, overwrite: bool
) -> None:
    """Size a pin joint and check it step by step.

    The steps are those of Strand (2005), chapter 2. Dimensions that are not given are chosen.
    Prints dimensions and the margin of each step. A joint that exceeds a limit is reported; the
    exit status is 0 all the same.

    \b
    Example:
      erlif design --example > joint.toml
      erlif design joint.toml -o joint.html
    """
    with large_imports():
        from erlif.joint.report import list_materials, summarise_design
        from erlif.joint.sizing.design import design as size
        from erlif.joint.sizing.design import example_joint_file

    if example:
        click.echo(example_joint_file(), nl=False)
        return
    if materials:
        from erlif.joint.sizing import read_materials

        click.echo(wrap(list_materials(read_materials())))
        return
    if source is None:
        raise click.UsageError(
            "Expected the name of a joint. Make one with: erlif design --example > joint.toml"
        )
    if output is not None:
        expect_output(output, ".html", ".csv", overwrite=overwrite)
    designed = size(source)
    click.echo(wrap(summarise_design(designed, brief=not verbosity())))
    if output is not None:
        from erlif.joint.report import write_design_page, write_design_table

        write = write_design_table if output.suffix == ".csv" else write_design_page
        click.echo(f"\nwritten: {write(designed, output, overwrite=overwrite)}")
