"""The page of ``erlif design``: verdict, dimensions, steps, figures, alternatives and materials."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import Path

from markupsafe import Markup
from matplotlib.figure import Figure

from erlif.core.version import __version__
from erlif.io.files import refuse_existing, replacing
from erlif.joint.sizing import BearingDesign, Material, Step
from erlif.show.plots.design import design_figure, design_margins_figure
from erlif.show.report.captions import Caption
from erlif.show.report.design import (
    dimension_title,
    dimensions,
    margin,
    outcome,
    plain,
    present,
    verdict,
    within,
)
from erlif.show.report.layout import (
    PageFigure,
    Table,
    arrange_figures,
    compose_page,
    download_link,
    embed_figure,
    file_name,
    render,
)
from erlif.show.report.layout import print_units as print_text

_FIGURE = Caption(
    "Pressure, pv, temperature and wear",
    "(a) Pressure over the arc after eq. 9 with the assembled play, beside the simpler equations; "
    "Hertz where its arc is below 60 degrees; the hardness over the safety factor where it is "
    "near. (b) The joint at its largest and its mean load, by which pv is judged, with the limits "
    "that are known. "
    "(c) Surface temperature against friction at the mean load; shaded: friction that the guide "
    "expects. (d) Worn depth over the time in motion.",
)

_MARGINS = Caption(
    "Margins",
    "Part of each limit that is used, in the order of the guide. A bar beyond 1.3 is cut off.",
)

_MOST_ROWS = 12  # numbers in the table of sensitivities


def write_design_page(
    design: BearingDesign, out_path: str | Path, *, overwrite: bool = False
) -> Path:
    """Write one self-contained HTML page about the design of a joint.

    Parameters
    ----------
    design : BearingDesign
        From `erlif.design`.
    out_path : path
        The page.
    overwrite : bool
        Replace an existing page.

    Returns
    -------
    Path
        `out_path`.

    Raises
    ------
    OutputError
        If the page exists or cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.joint.sizing.design import example_design
    >>> with TemporaryDirectory() as directory:
    ...     page = write_design_page(example_design(), f"{directory}/joint.html").read_text("utf-8")
    >>> page[:15], "All limits hold" in page
    ('<!DOCTYPE html>', True)
    """
    out_path = Path(out_path)
    refuse_existing(out_path, overwrite=overwrite)
    text = make_design_page(design)
    with replacing(out_path) as scratch:
        scratch.write_text(text, encoding="utf-8")
    return out_path


def make_design_page(design: BearingDesign) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    design : BearingDesign

    Returns
    -------
    str

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> make_design_page(example_design()).count("<h1>")
    1
    """
    sections = [
        ("result", "Result", _result(design)),
        ("steps", "Steps", _step_table(design)),
        ("figures", "Figures", arrange_figures(_figures(design))),
        ("alternatives", "Reasons and alternatives", _reasons(design)),
        ("sensitivity", "Sensitivity of the weakest margin", _sensitivity(design)),
        ("bushings", "Other bushings", _substitutes(design)),
        ("materials", "Materials and their sources", _materials(design)),
        ("joint", "The joint as a file", _settings(design)),
    ]
    return compose_page(
        [(key, title, Markup(text)) for key, title, text in sections if text],
        name=design.name,
        subject="design",
        subtitle=f"Design of a pin joint after Strand (2005), chapter 2; erlif {__version__}",
    )


def make_table(
    rows: Iterable[Sequence[str]],
    *,
    head: Sequence[str] = (),
    caption: str = "",
    numbers: Sequence[int] = (),
) -> Markup:
    """Make a table of cells that are HTML already."""
    cells = [[Markup(cell) for cell in row] for row in rows]
    return render("table.html", one=Table(cells, head, caption, numbers))


def _result(design: BearingDesign) -> str:
    first, *rest = verdict(design)
    lines = [f"<p><strong>{_signs(first)}</strong></p>"]
    failed = [line.strip() for line in rest if line.startswith("  ")]
    if failed:
        lines.append(f"<ul>{''.join(f'<li>{_signs(line)}</li>' for line in failed)}</ul>")
    lines += [f"<p>{_signs(line)}</p>" for line in rest if not line.startswith("  ")]
    lines += [f"<p>Note: {_signs(escape(note))}</p>" for note in design.notes]

    joint = design.joint
    load = [("Largest load", f"{joint.force / 1e3:.4g} kN")]
    if joint.mean_force is not None:
        load.append(("Mean load in motion", f"{joint.mean_force / 1e3:.4g} kN"))
    load.append(("Safety factor", f"{joint.safety:g}"))
    if joint.half_swing is not None and joint.period is not None:
        swing = f"± {math.degrees(joint.half_swing):.3g}° every {joint.period:.4g} s"
        load.append(("Swing", swing))
    if joint.life is not None:
        load.append(("Life in motion", f"{plain(joint.life / 3600)} h"))
    load += [
        (
            part.capitalize(),
            escape(getattr(joint, part).name) + " (assumed)" * (part in design.assumed),
        )
        for part in ("pin", "bushing", "seat", "housing")
    ]
    rows = [(escape(title), _signs(value), source) for title, value, source in dimensions(design)]
    sizes = make_table(rows, caption=dimension_title(design), numbers=[1])
    given = make_table(load, caption="Load, motion and materials")
    return "\n".join([*lines, f'<div class="columns"><div>{sizes}</div><div>{given}</div></div>'])


def _step_table(design: BearingDesign) -> str:
    rows = []
    for step in design.walk.steps:
        if step.missing:
            cells = [escape(step.title), "", "not computed", "", "", step.equation]
            cells.append(escape(f"give {step.missing}"))
        else:
            cells = [
                f'<a href="#step-{step.key}">{escape(step.title)}</a>',
                _signs(margin(step.margin)),
                _state(step),
                _signs(present(step)),
                _signs(within(step)),
                step.equation,
                escape(step.quantity),
            ]
        rows.append(cells)
    # a narrow window shows the first columns, which matter most
    head = ("Step", "Margin", "State", "Present", "Allowed", "Source", "Quantity")
    table = make_table(rows, head=head, numbers=(1, 3, 4))
    link = download_link(_steps_csv(design.walk.steps), name=file_name(design.name, "steps.csv"))
    note = (
        "Margin: allowed over present value less 1; 0 at the limit, negative where it is exceeded. "
        "Strengths are divided by the safety factor. Doubtful: outside of the validity of the "
        "equation. "
        + "".join(
            f"The margin of the {escape(step.title)} is that of the {escape(step.basis)}. "
            for step in design.walk.steps
            if step.basis
        )
    )
    look = 'class="wide" tabindex="0" role="region" aria-label="Table of the steps"'
    return f"<p>{note} {link}.</p><div {look}>{table}</div>"


def _signs(text: str) -> str:
    """A text with the signs of print for minus, times, micro and degrees."""
    plain = print_text(text)
    return re.sub(r"(?<![\w.])-(?=\d)", "−", re.sub(r"^x (?=\d)", "× ", plain))


def _state(step: Step) -> str:
    """The outcome; what needs attention is bold."""
    text = escape(outcome(step))
    return (
        text if step.holds and (step.valid or step.kind != "limit") else f"<strong>{text}</strong>"
    )


_CSV_HEAD = (
    "step title source kind quantity unit present least most margin valid state validity missing"
)


def _steps_csv(steps: Iterable[Step]) -> str:
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerow(_CSV_HEAD.split())
    for step in steps:
        texts = (step.key, step.title, step.equation, step.kind, step.quantity, step.unit)
        numbers = [_digits(value) for value in (step.present, *step.allowed, step.margin)]
        valid = str(step.valid).lower()
        writer.writerow([*texts, *numbers, valid, step.state, step.validity, step.missing])
    return file.getvalue()


def _digits(value: float) -> str:
    return "" if math.isnan(value) or math.isinf(value) else f"{value:.9g}"


def _figures(design: BearingDesign) -> Iterator[PageFigure]:
    drawn: tuple[tuple[str, Figure, Caption], ...] = (
        ("margins", design_margins_figure(design), _MARGINS),
        ("joint", design_figure(design), _FIGURE),
    )
    for name, figure, caption in drawn:
        yield embed_figure(name, figure, caption, caption.text)


def _reasons(design: BearingDesign) -> str:
    """Each step in words; those that fail are open."""
    parts = []
    for step in design.walk.steps:
        if step.missing:
            continue
        lines = [f"<p>{escape(step.reason)}</p>"]
        rows = [("Valid for", _signs(step.validity))]
        if step.numbers:
            listed = "; ".join(_number(name, value, unit) for name, value, unit in step.numbers)
            rows.append(("Further results", _signs(listed)))
        if step.alternatives:
            rows.append(("Alternatives", _signs("; ".join(step.alternatives))))
        lines.append(make_table(rows))
        limited = not math.isnan(step.margin)
        ending = f"{margin(step.margin)}, {outcome(step)}" if limited else outcome(step)
        shown = " open" if not step.holds else ""
        title = f"{escape(step.title)} ({step.equation}): {_signs(ending)}"
        parts.append(
            f'<details id="step-{step.key}"{shown}><summary>{title}</summary>'
            f"{''.join(lines)}</details>"
        )
    return "\n".join(parts)


def _number(name: str, value: float, unit: str) -> str:
    text = "unlimited" if math.isinf(value) else plain(value)
    return f"{name} {text}" if unit == "1" or math.isinf(value) else f"{name} {text} {unit}"


def _sensitivity(design: BearingDesign) -> str:
    weakest, found = design.walk.weakest, design.sensitivities
    if weakest is None or not found:
        return ""
    rows = [
        (escape(one.name), f"+{one.by}", _signs(f"{100 * one.change:+.2g} points"))
        for one in found[:_MOST_ROWS]
    ]
    table = make_table(rows, head=("Number", "Change", "Margin, per cent"), numbers=(1, 2))
    return (
        f"<p>Change of the margin of {escape(weakest.title)} ({weakest.equation}), now "
        f"{_signs(margin(weakest.margin))}, to first order.</p>{table}"
    )


def _substitutes(design: BearingDesign) -> str:
    rows = []
    for one in design.substitutes:
        weakest = one.weakest
        governing = "" if weakest is None else f"{weakest.title} ({weakest.equation})"
        value = "" if weakest is None else margin(weakest.margin)
        difference = one.walk.step("hardness_difference")
        hint = "" if difference.missing or difference.holds else "less than 100 HB below the pin"
        without = ", ".join(step.title for step in one.unknown)
        if without and value and one.weakest is not None and one.weakest.holds:
            value = f"{value} of those known"
        rows.append(
            (escape(one.material.name), _signs(value), escape(governing), hint, escape(without))
        )
    if not rows:
        return ""
    head = ("Bushing", "Margin", "Weakest limit of the sliding surface", "Hardness", "Not known")
    table = make_table(rows, head=head, numbers=[1])
    note = (
        "Other bushings of the table at the same dimensions: those whose known limits hold first, "
        "of them those of which most limits are known. A material may fail at a limit that is not "
        "known. A wear rate belongs to a tested pair."
    )
    return f'<p>{note}</p><div class="wide">{table}</div>'


def _materials(design: BearingDesign) -> str:
    joint = design.joint
    parts: list[tuple[str, Material]] = [
        ("Pin", joint.pin),
        ("Bushing", joint.bushing),
        ("Seats", joint.seat),
        ("Housing", joint.housing),
    ]
    if joint.lock is not None:
        parts.append(("Lock plate", joint.lock.plate))
    rows = []
    for part, one in parts:
        low, high = one.hardness_low, one.hardness_high
        hardness = "" if low is None else f"{low:g}" if low == high else f"{low:g} to {high:g}"
        rows.append(
            (
                part,
                escape(one.name),
                _cell(one.yield_stress, 1e6),
                hardness,
                _cell(one.youngs_modulus, 1e9),
                _cell(one.conductivity, 1),
                _cell(one.expansion, 1e-6),
            )
        )
    head = (
        "Part",
        "Material",
        "Yield [MPa]",
        "Hardness [HB]",
        "E [GPa]",
        "λ [W/(m K)]",
        "α [10⁻⁶/K]",
    )
    table = make_table(rows, head=head, numbers=(2, 3, 4, 5, 6))
    # one material may serve several parts
    sources = {one.name: one.source for _, one in parts}
    listed = "".join(
        f"<li><strong>{escape(name)}</strong>: {escape(source)}.</li>"
        for name, source in sources.items()
    )
    return f'<div class="wide">{table}</div><ul>{listed}</ul>'


def _cell(value: float | None, scale: float) -> str:
    return "" if value is None else f"{value / scale:.4g}"


def _settings(design: BearingDesign) -> str:
    """The joint with all its dimensions, to be saved and designed again."""
    link = download_link(
        design.settings,
        name=file_name(design.name, "joint.toml"),
        label="Save as TOML",
        media="application/toml",
    )
    return (
        f"<p>All dimensions, chosen and given. {link}.</p>"
        f"<details><summary>Show</summary><pre>{escape(design.settings)}</pre></details>"
    )
