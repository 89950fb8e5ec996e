"""Crank-rockers in sentences and a table."""

from __future__ import annotations

import math

from erlif.models.linkage import LinkageDesign, Synthesis, link_sensitivity

_HEAD = (
    *("crank", "coupler", "rocker", "ground", "crank speed", "swing", "ratio", "time ratio"),
    *("slower", "transmission", "space"),
)
_UNITS = ("mm", "mm", "mm", "mm", "rpm", "deg", "", "", "stroke", "deg", "mm")


def summarise_linkages(found: Synthesis) -> str:
    """State the crank-rockers that a synthesis has found.

    Parameters
    ----------
    found : Synthesis
        From `erlif.models.linkage.synthesise_crank_rocker`.

    Returns
    -------
    str
        A sentence, a table of the linkages, the limits that they break, and the change of the swing
        of the first by its links.

    Examples
    --------
    >>> from erlif.models.linkage import synthesise_crank_rocker
    >>> links = {"coupler": 0.44, "rocker": 0.26, "ground": 0.51}
    >>> print(summarise_linkages(synthesise_crank_rocker(swing=0.45, **links)).splitlines()[0])
    1 crank-rocker meets the targets.
    """
    # without a solution the nearest linkage stands in the table
    designs = found.designs or (() if found.nearest is None else (found.nearest,))
    rows = [_HEAD, _UNITS, *(_cells(design) for design in designs)]
    # columns are as wide as their widest cell
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    table = [
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        for row in rows
    ]
    blocks = [[found.statement], table, _broken(found.designs), _tolerances(designs[0])]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _cells(design: LinkageDesign) -> tuple[str, ...]:
    """One row of the table."""
    low, high = (math.degrees(angle) for angle in design.transmission)
    speed = design.crank_speed
    ratio = f"{design.time_ratio:.4f}"
    return (
        *(f"{1e3 * length:.3f}" for length in vars(design.linkage).values()),
        "-" if math.isnan(speed) else f"{speed * 30 / math.pi:.2f}",
        f"{math.degrees(design.swing):.3f}",
        f"{design.speed_ratio:.5f}",
        ratio,
        # a family's optimum is found to 1e-5: no stroke is slower by less than is printed
        "neither" if float(ratio) == 1 else design.slower_stroke,
        f"{low:.1f} to {high:.1f}",
        " x ".join(f"{1e3 * side:.0f}" for side in design.space),
    )


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
