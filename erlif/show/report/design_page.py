"""The page of ``erlif design``: verdict, dimensions, steps, figures, alternatives and materials."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from markupsafe import Markup
from matplotlib.figure import Figure

from erlif.core.version import __version__
from erlif.io.files import refuse_existing, replacing
from erlif.joint.sizing import BearingDesign, Step
from erlif.show.plots.design import design_figure, design_margins_figure
from erlif.show.report.captions import Caption
from erlif.show.report.design import (
    dimension_title,
    dimensions,
    hardness_range,
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
    print_units,
    render_part,
)

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
        [section for section in sections if section[2]],
        name=design.name,
        subject="design",
        subtitle=f"Design of a pin joint after Strand (2005), chapter 2; erlif {__version__}",
    )


def _result(design: BearingDesign) -> Markup:
    first, *rest = verdict(design)
    joint = design.joint
    given = [("Largest load", f"{joint.force / 1e3:.4g} kN")]
    if joint.mean_force is not None:
        given.append(("Mean load in motion", f"{joint.mean_force / 1e3:.4g} kN"))
    given.append(("Safety factor", f"{joint.safety:g}"))
    if joint.half_swing is not None and joint.period is not None:
        swing = f"± {math.degrees(joint.half_swing):.3g}° every {joint.period:.4g} s"
        given.append(("Swing", swing))
    if joint.life is not None:
        given.append(("Life in motion", f"{plain(joint.life / 3600)} h"))
    for part in ("pin", "bushing", "seat", "housing"):
        name = getattr(joint, part).name + " (assumed)" * (part in design.assumed)
        given.append((part.capitalize(), name))

    sizes = [(title, _signs(value), source) for title, value, source in dimensions(design)]
    return render_part(
        "design.html",
        "result",
        verdict=_signs(first),
        exceeded=[_signs(line.strip()) for line in rest if line.startswith("  ")],
        sentences=[_signs(line) for line in rest if not line.startswith("  ")],
        notes=[_signs(note) for note in design.notes],
        sizes=Table(sizes, caption=dimension_title(design), numbers=[1]),
        given=Table(given, caption="Load, motion and materials"),
    )


def _step_table(design: BearingDesign) -> Markup:
    link = Markup('<a href="#step-{}">{}</a>')
    rows = [
        (step.title, "", "not computed", "", "", step.equation, f"give {step.missing}")
        if step.missing
        else (
            link.format(step.key, step.title),
            _signs(margin(step.margin)),
            _state(step),
            _signs(present(step)),
            _signs(within(step)),
            step.equation,
            step.quantity,
        )
        for step in design.assessment.steps
    ]
    # a narrow window shows the first columns, which matter most
    head = ("Step", "Margin", "State", "Present", "Allowed", "Source", "Quantity")
    file = _steps_csv(design.assessment.steps)
    return render_part(
        "design.html",
        "steps",
        bases=[(step.title, step.basis) for step in design.assessment.steps if step.basis],
        link=download_link(file, name=file_name(design.name, "steps.csv")),
        rows=Table(rows, head, numbers=(1, 3, 4)),
    )


def _signs(text: str) -> Markup:
    """A text with the signs of print for minus, times, micro and degrees."""
    printed = re.sub(r"^x (?=\d)", "× ", print_units(text))
    return Markup(re.sub(r"(?<![\w.])-(?=\d)", "−", printed))


def _state(step: Step) -> str:
    """The outcome; what needs attention is bold."""
    text = outcome(step)
    usual = step.holds and (step.valid or step.kind != "limit")
    return text if usual else Markup("<strong>{}</strong>").format(text)


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


def _reasons(design: BearingDesign) -> Markup:
    """Each step in words; those that fail are open."""
    steps = []
    for step in design.assessment.steps:
        if step.missing:
            continue
        rows = [("Valid for", _signs(step.validity))]
        if step.numbers:
            listed = "; ".join(_number(name, value, unit) for name, value, unit in step.numbers)
            rows.append(("Further results", _signs(listed)))
        if step.alternatives:
            rows.append(("Alternatives", _signs("; ".join(step.alternatives))))
        limited = not math.isnan(step.margin)
        ending = f"{margin(step.margin)}, {outcome(step)}" if limited else outcome(step)
        title = Markup("{} ({}): {}").format(step.title, step.equation, _signs(ending))
        steps.append((title, step.key, not step.holds, step.reason, Table(rows)))
    return render_part("design.html", "reasons", steps=steps)


def _number(name: str, value: float, unit: str) -> str:
    text = "unlimited" if math.isinf(value) else plain(value)
    return f"{name} {text}" if unit == "1" or math.isinf(value) else f"{name} {text} {unit}"


def _sensitivity(design: BearingDesign) -> Markup:
    weakest, found = design.assessment.weakest, design.sensitivities
    if weakest is None or not found:
        return Markup()
    rows = [
        (one.name, f"+{one.by}", _signs(f"{100 * one.change:+.2g} points"))
        for one in found[:_MOST_ROWS]
    ]
    return render_part(
        "design.html",
        "sensitivity",
        title=weakest.title,
        equation=weakest.equation,
        margin=_signs(margin(weakest.margin)),
        rows=Table(rows, ("Number", "Change", "Margin, per cent"), numbers=(1, 2)),
    )


def _substitutes(design: BearingDesign) -> Markup:
    rows = []
    for one in design.substitutes:
        weakest = one.weakest
        governing = "" if weakest is None else f"{weakest.title} ({weakest.equation})"
        value = "" if weakest is None else margin(weakest.margin)
        difference = one.assessment.step("hardness_difference")
        hint = "" if difference.missing or difference.holds else "less than 100 HB below the pin"
        without = ", ".join(step.title for step in one.unknown)
        if without and weakest is not None and weakest.holds:
            value = f"{value} of those known"
        rows.append((one.material.name, _signs(value), governing, hint, without))
    if not rows:
        return Markup()
    head = ("Bushing", "Margin", "Weakest limit of the sliding surface", "Hardness", "Not known")
    return render_part("design.html", "bushings", rows=Table(rows, head, numbers=[1]))


_MATERIAL_HEAD = (
    *("Part", "Material", "Yield [MPa]", "Hardness [HB]"),
    *("E [GPa]", "λ [W/(m K)]", "α [10⁻⁶/K]"),
)


def _materials(design: BearingDesign) -> Markup:
    joint = design.joint
    parts = {"Pin": joint.pin, "Bushing": joint.bushing, "Seats": joint.seat}
    parts["Housing"] = joint.housing
    if joint.lock is not None:
        parts["Lock plate"] = joint.lock.plate
    rows = [
        (
            part,
            one.name,
            _cell(one.yield_stress, 1e6),
            hardness_range(one),
            _cell(one.youngs_modulus, 1e9),
            _cell(one.conductivity, 1),
            _cell(one.expansion, 1e-6),
        )
        for part, one in parts.items()
    ]
    # one material may serve several parts
    sources = {one.name: one.source for one in parts.values()}
    table = Table(rows, _MATERIAL_HEAD, numbers=(2, 3, 4, 5, 6))
    return render_part("design.html", "materials", rows=table, sources=sources.items())


def _cell(value: float | None, scale: float) -> str:
    return "" if value is None else f"{value / scale:.4g}"


def _settings(design: BearingDesign) -> Markup:
    """The joint with all its dimensions, to be saved and designed again."""
    name = file_name(design.name, "joint.toml")
    media = "application/toml"
    link = download_link(design.settings, name=name, label="Save as TOML", media=media)
    return render_part("design.html", "joint", link=link, settings=design.settings)
