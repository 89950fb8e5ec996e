"""The design of a joint in sentences and tables."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from erlif.core.tables import read_table
from erlif.core.units import count_of
from erlif.joint.sizing import DIMENSIONS, ROUNDING, BearingDesign, Material, Step
from erlif.show.report.layout import print_columns, render_text

# The numbers of a joint: the names of its dimensions, the titles of what it is designed for.
NUMBERS = read_table("erlif.joint.sizing", "quantities.toml")["joint"]

_ASSUMED = ": assumption"  # as the table of materials writes it
_SMALL = 0.01
_LARGE = 10.0  # margin beyond which its size has no meaning
_NOT_VALID = "not valid here"  # the state of a comparison outside of its validity


class Verdict(NamedTuple):
    """The sentences that sum up a design.

    Attributes
    ----------
    head : str
        Whether all limits hold, and the weakest.
    exceeded : list[str]
        Limits that do not hold, with what to change.
    sentences : list[str]
        What is outside of the validity of an equation or of what is recommended.
    """

    head: str
    exceeded: list[str]
    sentences: list[str]


def summarise_design(design: BearingDesign, *, brief: bool = False) -> str:
    """State a joint, its dimensions and the margin of each step.

    Parameters
    ----------
    design : BearingDesign
        From `erlif.joint.design`.
    brief : bool
        Leave out the columns of source and state, so that the table has 80 columns; a step that
        does not hold has a negative margin, a doubtful one a question mark.

    Returns
    -------
    str
        Verdict, dimensions, a table of the steps, and what could not be computed. Comparisons that
        are not valid for the joint stand below the table.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> print(summarise_design(example_design()).splitlines()[0])
    Joint: boom of a loader
    """
    shown = [step for step in design.assessment.steps if not step.missing]
    steps: list[tuple[str, ...]] = [("step", "source", "present", "allowed", "margin  ", "state")]
    apart: list[tuple[str, ...]] = []
    for step in shown:
        # a star marks a margin that is not that of the value beside it
        marks = ("*" if step.basis else "") + ("?" if "doubtful" in outcome(step) else "")
        marked = f"{margin(step.margin)}{marks:2}"
        source = step.equation.replace("section ", "")
        row = (step.title, source, present(step), within(step), marked, outcome(step))
        (apart if step.state == _NOT_VALID else steps).append(row)
    tables = [steps, apart]
    if brief:
        tables = [[(row[0], *row[2:5]) for row in rows] for rows in tables]
    steps_table, apart_table = (
        print_columns(rows, "<>>>" if brief else "<<>>><") for rows in tables
    )
    return render_text(
        "design.txt",
        "erlif.joint.report",
        design=design,
        verdict=verdict(design),
        dimension_title=dimension_title(design),
        dimensions=print_columns(dimensions(design), "<><"),
        materials=[f"{part} {name}" for part, name in name_materials(design).items()],
        steps=steps_table,
        apart=apart_table,
        shown=shown,
        doubtful=any("doubtful" in outcome(step) for step in shown),
        assumed=assumed_values(design),
    )


def verdict(design: BearingDesign) -> Verdict:
    """Sum up a design."""
    assessment, weakest = design.assessment, design.assessment.weakest
    if weakest is None:
        return Verdict("No limit is known: give the strength of the materials.", [], [])
    if exceeded := assessment.failed:
        verb = "is" if len(exceeded) == 1 else "are"
        head = f"{count_of(len(exceeded), 'limit')} {verb} exceeded; the worst"
    elif design.unchecked:
        unchecked = ", ".join(design.unchecked)
        head = f"All limits that are checked hold; not checked: {unchecked}. The weakest"
    else:
        head = "All limits hold; the weakest"
    governing = f"{weakest.title} ({weakest.equation}) with a margin of {margin(weakest.margin)}"
    sentences = []
    if assessment.doubtful:
        named = "; ".join(
            f"{step.title} ({step.equation}): {step.validity}" for step in assessment.doubtful
        )
        sentences.append(f"Outside of the validity of the equation: {named}.")
    if assessment.unusual:
        named = ", ".join(step.title for step in assessment.unusual)
        sentences.append(f"Outside of what is recommended: {named}.")
    if design.own:
        sentences.append(f"Your own values, not of the table: {', '.join(design.own)}.")
    # what to change follows the governing limit, one line for each limit
    alternatives = [f"{step.title}: {'; '.join(step.alternatives)}." for step in exceeded]
    return Verdict(f"{head} is: {governing}.", alternatives, sentences)


def name_materials(design: BearingDesign) -> dict[str, str]:
    """Materials of the parts; those that were not given are marked."""
    return {
        part: material.name + " (assumed)" * (part in design.assumed)
        for part, material in design.joint.parts.items()
    }


def plain(value: float) -> str:
    """Write a number with four digits, without an exponent where it is neither small nor large.

    Examples
    --------
    >>> plain(10000.0), plain(123456.0), plain(0.0003997), plain(2e-9)
    ('10000', '123500', '0.0003997', '2e-09')
    """
    if value and not 1e-4 <= abs(value) < 1e7:
        return f"{value:.4g}"
    return f"{float(f'{value:.4g}'):.10g}"


def present(step: Step) -> str:
    """Write the value of a step with its unit; no number where nothing is left for the load."""
    if math.isinf(step.present):
        return "no section left"
    return f"{plain(step.present)} {'' if step.unit == '1' else step.unit}".strip()


def outcome(step: Step) -> str:
    """Write the state of a step: doubtful where it is outside of the validity of its equation."""
    state, _, doubt = step.state.partition(", ")
    return f"{state} (doubtful)" if doubt else state


def margin(value: float) -> str:
    """Write a margin, allowed over present value less 1, in per cent.

    Examples
    --------
    >>> margin(0.125), margin(-0.5), margin(30.04), margin(float("inf"))
    ('+12 %', '-50 %', '> 1000 %', 'unlimited')
    """
    if math.isnan(value):
        return "-"
    if math.isinf(value):
        return "unlimited"
    if abs(value) < ROUNDING:
        return "0 %"
    if value > _LARGE:
        return f"> {100 * _LARGE:.0f} %"
    # the sign of a small margin is what matters
    return f"{100 * value:+.0f} %" if abs(value) >= _SMALL else f"{100 * value:+.2g} %"


def within(step: Step) -> str:
    """Write what is allowed, in the unit of the step; empty for a result without a limit."""
    low, high = step.allowed
    if math.isinf(low):
        return "" if math.isinf(high) else f"up to {high:.4g}"
    return f"from {low:.4g}" if math.isinf(high) else f"{low:.4g} to {high:.4g}"


def dimensions(design: BearingDesign) -> list[tuple[str, str, str]]:
    """Name of each dimension, its value with unit, and whether it was chosen or given."""
    rows = []
    for name in DIMENSIONS:
        value = float(getattr(design.joint, name))
        digits = 5 if value >= 1e-3 else 3
        text = f"{value * 1e6:.4g} um" if name == "play" else f"{value * 1e3:.{digits}g} mm"
        rows.append((NUMBERS[name]["name"], text, "chosen" if name in design.chosen else "given"))
    return rows


def dimension_title(design: BearingDesign) -> str:
    """Heading of the dimensions, with the way in which they were chosen, if any was."""
    how = "least that are enough" if design.series == "none" else f"rounded up to {design.series}"
    return f"Dimensions (chosen: {how})" if design.chosen else "Dimensions"


def assumed_values(design: BearingDesign) -> list[tuple[str, str]]:
    """Materials of the joint with those of their values for which no source was at hand."""
    materials = {material.name: material for material in design.joint.parts.values()}
    return [
        (name, clause.removesuffix(_ASSUMED))
        for name, material in materials.items()
        for clause in material.source.split("; ")
        if clause.endswith(_ASSUMED)
    ]


def list_materials(materials: Mapping[str, Material]) -> str:
    """Write a table of materials.

    Parameters
    ----------
    materials : mapping of str to Material

    Returns
    -------
    str
        One line for each, of at most 80 columns, and its source below.

    Examples
    --------
    >>> from erlif.joint.sizing import read_materials
    >>> list_materials(read_materials()).splitlines()[2].split()[0]
    '42CrMo4'
    """
    head = ("yield", "hardness", "E", "limit", "p", "pv")
    rows: list[tuple[str, ...]] = [("material", *head)]
    rows.append(("", "MPa", "HB", "GPa", "degC", "MPa", "W/mm2"))
    for one in materials.values():
        strength = scaled(one.yield_stress, 1e6), hardness_range(one) or "-"
        limits = (one.temperature, 1), (one.pressure, 1e6), (one.pv, 1e6)
        numbers = (scaled(value, unit) for value, unit in ((one.youngs_modulus, 1e9), *limits))
        rows.append((one.name, *strength, *numbers))
    first, units, *lines = print_columns(rows, "<>>>>>>").splitlines()
    sourced = (
        f"{line}\n    {one.use}; {one.source}"
        for line, one in zip(lines, materials.values(), strict=True)
    )
    return "\n".join([first, units, *sourced])


def hardness_range(material: Material) -> str:
    """Write the hardness of a surface, or its range, in Brinell; empty where it is not known."""
    low, high = material.hardness_low, material.hardness_high
    if low is None:
        return ""
    return f"{low:g}" if high in (None, low) else f"{low:g} to {high:g}"


def scaled(value: float | None, unit: float, missing: str = "-") -> str:
    """Write a property in a larger unit."""
    return missing if value is None else f"{value / unit:.4g}"
