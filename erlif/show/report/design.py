"""The design of a joint in sentences and tables."""

from __future__ import annotations

import math
from collections.abc import Mapping

from erlif.core.units import count_of
from erlif.joint.sizing import ROUNDING, BearingDesign, Material, Step

_NAMES = {
    "pin_diameter": "pin diameter",
    "bushing_width": "bushing width",
    "wall": "bushing wall",
    "seat_width": "seat width",
    "housing_diameter": "housing diameter",
    "play": "play before pressing",
}
"""Dimensions as a reader names them."""


def summarise_design(design: BearingDesign) -> str:
    """State a joint, its dimensions and the margin of each step.

    Parameters
    ----------
    design : BearingDesign
        From `erlif.design`.

    Returns
    -------
    str
        Verdict, dimensions, a table of the steps, and what could not be computed.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> print(summarise_design(example_design()).splitlines()[0])
    Joint: boom of a loader
    """
    blocks = [
        [f"Joint: {design.name}", *verdict(design)],
        [f"Note: {note}" for note in design.notes],
        [*_dimension_lines(design), materials_line(design)],
        _step_lines(design),
        _missing_lines(design),
        _assumed_lines(design),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def verdict(design: BearingDesign) -> list[str]:
    """Return the sentences that sum up a design.

    Parameters
    ----------
    design : BearingDesign

    Returns
    -------
    list of str

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> verdict(example_design())[0].split(";")[0]
    'All limits hold'
    """
    assessment, weakest = design.assessment, design.assessment.weakest
    if weakest is None:
        return ["No limit is known: give the strength of the materials."]
    governing = f"{weakest.title} ({weakest.equation}) with a margin of {margin(weakest.margin)}"
    if assessment.sound:
        lines = [f"All limits hold; the weakest is: {governing}."]
    else:
        failed = count_of(len(assessment.failed), "limit")
        verb = "is" if len(assessment.failed) == 1 else "are"
        lines = [f"{failed} {verb} exceeded; the worst is: {governing}."]
        lines += [f"  {step.title}: {'; '.join(step.alternatives)}." for step in assessment.failed]
    if assessment.doubtful:
        named = "; ".join(
            f"{step.title} ({step.equation}): {step.validity}" for step in assessment.doubtful
        )
        lines.append(f"Outside of the validity of the equation: {named}.")
    if assessment.unusual:
        named = ", ".join(step.title for step in assessment.unusual)
        lines.append(f"Outside of what is recommended: {named}.")
    return lines


def materials_line(design: BearingDesign) -> str:
    """Return the materials of the parts in a line.

    Parameters
    ----------
    design : BearingDesign

    Returns
    -------
    str
        Those that were not given are marked.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> materials_line(example_design())
    'Materials: pin 42CrMo4 hardened, bushing CuAl10Ni5Fe4, seat S355, housing S355'
    """
    parts = []
    for part in ("pin", "bushing", "seat", "housing"):
        name = getattr(design.joint, part).name
        parts.append(f"{part} {name}" + " (assumed)" * (part in design.assumed))
    return f"Materials: {', '.join(parts)}"


def plain(value: float) -> str:
    """Write a number with four digits, without an exponent where it is neither small nor large.

    Parameters
    ----------
    value : float

    Returns
    -------
    str

    Examples
    --------
    >>> plain(10000.0), plain(123456.0), plain(0.0003997), plain(2e-9)
    ('10000', '123500', '0.0003997', '2e-09')
    """
    if value and not 1e-4 <= abs(value) < 1e7:
        return f"{value:.4g}"
    return f"{float(f'{value:.4g}'):.10g}"


def present(step: Step) -> str:
    """Write the value of a step with its unit.

    Parameters
    ----------
    step : Step

    Returns
    -------
    str
        Without a number where nothing is left that carries the load.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> present(example_design().assessment.step("friction"))
    '15 kN'
    """
    if math.isinf(step.present):
        return "no section left"
    return f"{plain(step.present)} {'' if step.unit == '1' else step.unit}".strip()


def outcome(step: Step) -> str:
    """Write the state of a step.

    Parameters
    ----------
    step : Step

    Returns
    -------
    str
        "doubtful" for a step outside of the validity of its equation.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> outcome(example_design().assessment.step("pin_shear"))
    'holds'
    """
    state, _, doubt = step.state.partition(", ")
    return f"{state} (doubtful)" if doubt else state


def margin(value: float) -> str:
    """Write a margin in per cent; large ones as a factor.

    Parameters
    ----------
    value : float
        Allowed over present value less 1.

    Returns
    -------
    str

    Examples
    --------
    >>> margin(0.125), margin(-0.5), margin(30.0), margin(float("inf"))
    ('+12 %', '-50 %', 'x 31', 'unlimited')
    """
    if math.isnan(value):
        return "-"
    if math.isinf(value):
        return "unlimited"
    if abs(value) < ROUNDING:
        return "0 %"
    if value > _FACTOR:
        return f"x {value + 1:.3g}" if value < _LARGE else f"x {value + 1:.0f}"
    # the sign of a small margin is what matters
    return f"{100 * value:+.0f} %" if abs(value) >= _SMALL else f"{100 * value:+.2g} %"


_SMALL = 0.01
_LARGE = 999.0  # three digits of a larger factor would need an exponent
_FACTOR = 10.0  # a margin above 1000 % is written as a factor


def within(step: Step) -> str:
    """Write what is allowed, in the unit of the step.

    Parameters
    ----------
    step : Step

    Returns
    -------
    str
        Empty for a result without a limit.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> within(example_design().assessment.step("width_ratio"))
    '0.5 to 1.5'
    """
    low, high = step.allowed
    if math.isinf(low) and math.isinf(high):
        return ""
    if math.isinf(low):
        return f"up to {high:.4g}"
    return f"from {low:.4g}" if math.isinf(high) else f"{low:.4g} to {high:.4g}"


def dimensions(design: BearingDesign) -> list[tuple[str, str, str]]:
    """Return the dimensions of a design.

    Parameters
    ----------
    design : BearingDesign

    Returns
    -------
    list of (str, str, str)
        Name, value with unit, and whether it was chosen or given.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> dimensions(example_design())[0][0]
    'pin diameter'
    """
    joint = design.joint
    rows = []
    for name, title in _NAMES.items():
        value = float(getattr(joint, name))
        digits = 5 if value >= 1e-3 else 3
        text = f"{value * 1e6:.4g} um" if name == "play" else f"{value * 1e3:.{digits}g} mm"
        rows.append((title, text, "chosen" if name in design.chosen else "given"))
    return rows


def dimension_title(design: BearingDesign) -> str:
    """Return the heading of the dimensions.

    Parameters
    ----------
    design : BearingDesign

    Returns
    -------
    str
        With the way in which dimensions were chosen, if any was.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> dimension_title(example_design())
    'Dimensions (chosen: rounded up to R20)'
    """
    how = "least that are enough" if design.series == "none" else f"rounded up to {design.series}"
    return f"Dimensions (chosen: {how})" if design.chosen else "Dimensions"


def _dimension_lines(design: BearingDesign) -> list[str]:
    rows = dimensions(design)
    lines = [f"{title:<22} {value:>11}  {source}" for title, value, source in rows]
    return [dimension_title(design), *lines]


def _step_lines(design: BearingDesign) -> list[str]:
    lines = [f"{'step':<34} {'source':<15} {'present':>19} {'allowed':>15} {'margin':>10}  state"]
    for step in design.assessment.steps:
        if step.missing:
            continue
        source = step.equation.replace("section ", "")
        lines.append(
            f"{step.title:<34} {source:<15} {present(step):>19} {within(step):>15} "
            f"{margin(step.margin):>10}{'*' if step.basis else ' '} {outcome(step)}"
        )
    return [*lines, *_basis_lines(design)]


def _basis_lines(design: BearingDesign) -> list[str]:
    """What margins refer to that are not those of the value beside them."""
    shown = [step for step in design.assessment.steps if not step.missing]
    lines = [f"* {step.title}: margin of the {step.basis}" for step in shown if step.basis]
    if any("doubtful" in outcome(step) for step in shown):
        lines.append("(doubtful): outside of the validity of the equation")
    return lines


def _missing_lines(design: BearingDesign) -> list[str]:
    missing = design.assessment.missing
    lines = [f"  {step.title} ({step.equation}): give {step.missing}" for step in missing]
    return ["Not computed:", *lines] if lines else []


def assumed_values(design: BearingDesign) -> list[tuple[str, str]]:
    """Return the values of the table of materials for which no source was at hand.

    Parameters
    ----------
    design : BearingDesign

    Returns
    -------
    list of (str, str)
        Name of a material of the joint, and its values that are assumptions.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> assumed_values(example_design())
    []
    """
    joint = design.joint
    parts = {part.name: part for part in (joint.pin, joint.bushing, joint.seat, joint.housing)}
    clauses = [(name, part.source.split("; ")) for name, part in parts.items()]
    return [
        (name, clause.removesuffix(_ASSUMED))
        for name, found in clauses
        for clause in found
        if clause.endswith(_ASSUMED)
    ]


_ASSUMED = ": assumption"  # as the table of materials writes it


def _assumed_lines(design: BearingDesign) -> list[str]:
    lines = [f"  {name}: {values}" for name, values in assumed_values(design)]
    head = "Values of the table without a source, to be checked against the delivery:"
    return [head, *lines] if lines else []


def list_materials(materials: Mapping[str, Material]) -> str:
    """Write a table of materials.

    Parameters
    ----------
    materials : mapping of str to Material

    Returns
    -------
    str
        One line for each, with hardness, strength, limits and source.

    Examples
    --------
    >>> from erlif.joint.sizing import read_materials
    >>> list_materials(read_materials()).splitlines()[1].split()[0]
    '42CrMo4'
    """
    width = max(26, *(len(name) for name in materials))
    head = (
        f"{'material':<{width}} {'use':<10} {'yield MPa':>9} {'hardness HB':>12} {'E GPa':>6} "
        f"{'degC':>5} {'p MPa':>6} {'pv W/mm2':>8}  source"
    )
    lines = [head]
    for one in materials.values():
        hardness = hardness_range(one) or "-"
        lines.append(
            f"{one.name:<{width}} {one.use:<10} {_cell(one.yield_stress, 1e6):>9} {hardness:>12} "
            f"{_cell(one.youngs_modulus, 1e9):>6} {_cell(one.temperature, 1):>5} "
            f"{_cell(one.pressure, 1e6):>6} {_cell(one.pv, 1e6):>8}  {one.source}"
        )
    return "\n".join(lines)


def hardness_range(material: Material) -> str:
    """Write the hardness of a surface, or its range.

    Parameters
    ----------
    material : Material

    Returns
    -------
    str
        In Brinell; empty where it is not known.

    Examples
    --------
    >>> from erlif.joint.sizing import read_materials
    >>> hardness_range(read_materials()["CuAl10Ni5Fe4"])
    '140 to 230'
    """
    low, high = material.hardness_low, material.hardness_high
    if low is None:
        return ""
    return f"{low:g}" if high in (None, low) else f"{low:g} to {high:g}"


def _cell(value: float | None, scale: float) -> str:
    return "-" if value is None else f"{value / scale:g}"
