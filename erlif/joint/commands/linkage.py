"""``erlif linkage``: links of a crank-rocker for a wanted motion."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Any

import click

from erlif.commands.lines import wrap
from erlif.commands.options import LENGTH, OVERWRITE, QuantityOption, expect_output, output_option
from erlif.core.speed.imports import large_imports

_ANGLE, _SPEED = QuantityOption("rad", "ANGLE"), QuantityOption("rad/s", "SPEED")


@click.command()
@click.option("--crank", type=LENGTH, help="Length from crank pivot to crank pin.")
@click.option("--coupler", type=LENGTH, help="Length from crank pin to rocker pin.")
@click.option("--rocker", type=LENGTH, help="Length from rocker pivot to rocker pin.")
@click.option("--ground", type=LENGTH, help="Distance of the pivots.")
@click.option("--swing", type=_ANGLE, help="Wanted swing of the rocker.")
@click.option("--ratio", type=float, help="Wanted greatest rocker speed over crank speed.")
@click.option("--time-ratio", type=float, help="Wanted slower stroke over quicker, in time.")
@click.option("--crank-speed", type=_SPEED, help="Speed of the crank.")
@click.option("--rocker-speed", type=_SPEED, help="Wanted greatest rocker speed.")
@click.option("--transmission", type=_ANGLE, default="0 deg", help="Least transmission angle.")
@click.option("--size", type=(LENGTH, LENGTH), help="Space along and across the ground link.")
@click.option("--width", type=LENGTH, default="0 mm", help="Width of the links, for the space.")
@click.option("--longest", type=LENGTH, help="Longest link; default: ten times the longest given.")
@output_option("Figure (.png, .pdf, .svg) or movie (.gif) of the best", "none")
@OVERWRITE
def linkage(
    ratio: float | None,
    transmission: float,
    size: tuple[float, float] | None,
    width: float,
    longest: float | None,
    output: Path | None,
    overwrite: bool,
    **wanted: Any,
) -> None:
    """Find crank-rockers for a wanted swing, speed and time ratio.

    Two links at least are given, or one with two targets. Prints every solution, or the nearest
    linkage. Names and angles are those of [mechanism] in run.toml. Quantities have units: "51 cm",
    "25 deg", "114 rpm".

    \b
    Example:
      erlif linkage --swing "25 deg" --rocker-speed "24 rpm" \\
        --coupler "44 cm" --rocker "26 cm" --ground "51 cm" -o linkage.png
    """
    with large_imports():
        from erlif.joint.models.linkage import synthesise_crank_rocker
        from erlif.joint.report import summarise_linkages

    # everything that can be refused is refused before the work starts
    if output is not None:
        expect_output(output, ".png", ".pdf", ".svg", ".gif", overwrite=overwrite)
    # implausible lengths are warnings of the model; here they are notes below the table
    with warnings.catch_warnings(record=True) as doubts:
        warnings.simplefilter("always")
        synthesis = synthesise_crank_rocker(
            speed_ratio=ratio,
            least_transmission_angle=transmission,
            largest_size=size or (math.inf, math.inf),
            link_width=width,
            longest_link=longest,
            **wanted,
        )
    for doubt in doubts:
        click.echo(f"note: {doubt.message}", err=True)
    click.echo(wrap(summarise_linkages(synthesis)))
    if output is None:
        return

    with large_imports():
        from erlif.joint.plots import write_linkage
    best = synthesis.designs[0] if synthesis.designs else synthesis.nearest
    assert best is not None  # without a design there is a nearest one
    click.echo(f"written: {write_linkage(best, output, overwrite=overwrite)}")
