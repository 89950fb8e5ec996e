"""Crank-rockers in sentences and a table."""

from __future__ import annotations

import math

from erlif.joint.models.linkage import LinkageDesign, Synthesis, link_sensitivity
from erlif.show.report.layout import print_columns

# Titles and units of the columns: links and motion, then transmission and space.
_MOTION = (
    ("crank", "coupler", "rocker", "ground", "crank speed", "swing", "ratio", "time ratio"),
    ("mm", "mm", "mm", "mm", "rpm", "deg", "", ""),
)
_SPACE = (("slower", "transmission", "space"), ("stroke", "deg", "mm"))


def summarise_linkages(found: Synthesis) -> str:
    """State the crank-rockers that a synthesis has found.

    Parameters
    ----------
    found : Synthesis
        From `erlif.joint.models.linkage.synthesise_crank_rocker`.

    Returns
    -------
    str
        A sentence, a table of the links and motions, one of transmission and space, the limits that
        are broken, and the change of the swing of the first linkage by its links.

    Examples
    --------
    >>> from erlif.joint.models.linkage import synthesise_crank_rocker
    >>> links = {"coupler": 0.44, "rocker": 0.26, "ground": 0.51}
    >>> print(summarise_linkages(synthesise_crank_rocker(swing=0.45, **links)).splitlines()[0])
    1 crank-rocker meets the targets.
    """
    # without a solution the nearest linkage stands in the table
    designs = found.designs or (() if found.nearest is None else (found.nearest,))
    rows = [_cells(design) for design in designs]
    count = len(_MOTION[0])
    blocks = [
        [found.statement],
        [print_columns([*_MOTION, *(row[:count] for row in rows)], ">>>>>>>>")],
        [print_columns([*_SPACE, *(row[count:] for row in rows)], ">>>")],
        _broken(found.designs),
        _tolerances(designs[0]),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _cells(design: LinkageDesign) -> tuple[str, ...]:
    """One row of the table."""
    lengths = (f"{1e3 * length:.3f}" for length in vars(design.linkage).values())
    speed = design.crank_speed
    turns = "-" if math.isnan(speed) else f"{speed * 30 / math.pi:.2f}"
    swing, ratio = f"{math.degrees(design.swing):.3f}", f"{design.time_ratio:.4f}"
    # a family's optimum is found to 1e-5: no stroke is slower by less than is printed
    slower = "neither" if float(ratio) == 1 else design.slower_stroke
    transmission = " to ".join(f"{math.degrees(angle):.1f}" for angle in design.transmission)
    space = " x ".join(f"{1e3 * side:.0f}" for side in design.space)
    return *lengths, turns, swing, f"{design.speed_ratio:.5f}", ratio, slower, transmission, space


def _broken(designs: tuple[LinkageDesign, ...]) -> list[str]:
    """Limits that designs break, by their row."""
    return [
        f"Linkage {row}: {'; '.join(design.departures)}."
        for row, design in enumerate(designs, start=1)
        if design.departures
    ]


def _tolerances(design: LinkageDesign) -> list[str]:
    """Change of the swing of a design by each link; without bounds where it folds flat."""
    if design.folds_flat:
        return []
    slopes = link_sensitivity(design.linkage).swing
    parts = [
        f"{name} {math.degrees(slope) / 1e3:+.3f}"
        for name, slope in zip(vars(design.linkage), slopes, strict=True)
    ]
    return [
        f"Change of the swing of the first by 1 mm more of a link, in degrees: {', '.join(parts)}."
    ]
