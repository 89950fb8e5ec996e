"""The page of ``erlif design``: verdict, dimensions, steps, figures, alternatives and materials."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

from erlif.core.tables import read_table
from erlif.core.version import __version__
from erlif.io.conversion import table_csv
from erlif.joint.plots.design import design_figure, design_margins_figure
from erlif.joint.report import design as words
from erlif.joint.sizing import BearingDesign, Step
from erlif.show.report import layout
from erlif.show.report.captions import Caption

_MOST_ROWS = 12  # numbers in the table of sensitivities

_PACKAGE = "erlif.joint.report"
_CAPTIONS = {name: Caption(**row) for name, row in read_table(_PACKAGE, "captions.toml").items()}


def write_design_page(
    design: BearingDesign, out_path: str | Path, *, overwrite: bool = False
) -> Path:
    """Write one self-contained HTML page about the design of a joint.

    Parameters
    ----------
    design : BearingDesign
        From `erlif.joint.design`.
    out_path, overwrite
        As for `erlif.show.report.write_report`, as what is returned and raised.

    Returns
    -------
    Path
        The page, which needs no other file.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.joint.sizing.design import example_design
    >>> with TemporaryDirectory() as directory:
    ...     page = write_design_page(example_design(), f"{directory}/joint.html").read_text("utf-8")
    >>> page[:15], "All limits that are checked hold" in page
    ('<!DOCTYPE html>', True)
    """
    return layout.write_page(lambda: make_design_page(design), out_path, overwrite=overwrite)


def write_design_table(
    design: BearingDesign, out_path: str | Path, *, overwrite: bool = False
) -> Path:
    """Write the steps of a design as CSV, as the page saves them.

    Arguments as in `write_design_page`.

    Returns
    -------
    Path
        The table, one row for each step.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.joint.sizing.design import example_design
    >>> with TemporaryDirectory() as directory:
    ...     table = write_design_table(example_design(), f"{directory}/joint.csv")
    ...     table.read_text("utf-8").split(",")[0]
    'step'
    """
    steps = design.assessment.steps
    return layout.write_page(lambda: _steps_csv(steps), out_path, overwrite=overwrite)


def make_design_page(design: BearingDesign) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    design : BearingDesign

    Returns
    -------
    str
        All of it; `write_design_page` writes it.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> make_design_page(example_design()).count("<h1>")
    1
    """
    # sections without content are left out
    sections = [
        ("result", "Result", _result(design)),
        ("steps", "Steps", _step_table(design)),
        ("figures", "Figures", layout.arrange_figures(_figures(design))),
        ("alternatives", "Reasons and alternatives", _reasons(design)),
        ("sensitivity", "Sensitivity of the weakest margin", _sensitivity(design)),
        ("bushings", "Other bushings", _substitutes(design)),
        ("materials", "Materials and their sources", _materials(design)),
        ("joint", "The joint as a file", _settings(design)),
    ]
    return layout.compose_page(
        [section for section in sections if section[2]],
        name=design.name,
        subject="design",
        subtitle=f"Design of a pin joint after Strand (2005), chapter 2; erlif {__version__}",
    )


def _result(design: BearingDesign) -> Markup:
    found, joint = words.verdict(design), design.joint
    given: list[tuple[str, str]] = [
        (one["title"], _signs(f"{words.plain(value * one.get('scale', 1))}{one.get('shown', '')}"))
        for name, one in words.NUMBERS.items()
        if "title" in one and (value := getattr(joint, name)) is not None
    ]
    if joint.bushing.wear is not None:
        own = ", your own" if "wear rate of the bushing" in design.own else ""
        given.append(("Wear rate", f"{joint.bushing.wear * 1e9:.3g} mm³/(N m){own}"))
    given += [(part.capitalize(), name) for part, name in words.name_materials(design).items()]

    # signs of print stand on the page; the terminal keeps plain ones
    sizes = [(title, _signs(value), source) for title, value, source in words.dimensions(design)]
    texts = {"exceeded": found.exceeded, "sentences": found.sentences, "notes": design.notes}
    return _render(
        "result",
        verdict=_signs(found.head),
        **{name: [_signs(line) for line in lines] for name, lines in texts.items()},
        sizes=layout.PageTable(sizes, caption=words.dimension_title(design), numbers=[1]),
        given=layout.PageTable(given, caption="Load, motion and materials"),
    )


def _step_table(design: BearingDesign) -> Markup:
    link = Markup('<a href="#step-{}">{}</a>')
    rows: list[tuple[str, ...]] = []
    for step in design.assessment.steps:
        if step.missing:
            need = f"give {step.missing}"
            rows.append((step.title, "", "not computed", "", "", step.equation, need))
            continue
        name, margin = link.format(step.key, step.title), _signs(words.margin(step.margin))
        values = _signs(words.present(step)), _signs(words.within(step))
        rows.append((name, margin, _state(step), *values, step.equation, step.quantity))
    # a narrow window shows the first columns, which matter most
    head = ("Step", "Margin", "State", "Present", "Allowed", "Source", "Quantity")
    file = _steps_csv(design.assessment.steps)
    return _render(
        "steps",
        steps=design.assessment.steps,
        link=layout.download_link(file, name=layout.file_name(design.name, "steps.csv")),
        rows=layout.PageTable(rows, head, numbers=(1, 3, 4)),
    )


def _signs(text: str) -> Markup:
    """A text with the signs of print for minus, times, micro and degrees."""
    printed = re.sub(r"^x (?=\d)", "× ", layout.print_units(text))
    return Markup(re.sub(r"(?<![\w.])-(?=\d)", "−", printed))


def _state(step: Step) -> str:
    """The outcome; what needs attention is bold."""
    text = words.outcome(step)
    usual = step.holds and (step.valid or step.kind != "limit")
    return text if usual else Markup("<strong>{}</strong>").format(text)


def _steps_csv(steps: Sequence[Step]) -> str:
    """The steps for other programs; a limit that is none is empty."""
    titles = (
        *("step", "title", "source", "kind", "quantity", "unit"),
        *("present", "least", "most", "margin"),
        *("valid", "state", "validity", "missing"),
    )
    rows = [
        (
            *(step.key, step.title, step.equation, step.kind, step.quantity, step.unit),
            *(
                number if math.isfinite(number) else None
                for number in (step.present, *step.allowed, step.margin)
            ),
            *(str(step.valid).lower(), step.state, step.validity, step.missing),
        )
        for step in steps
    ]
    return table_csv(dict(zip(titles, zip(*rows, strict=True), strict=True)), digits=9)


def _figures(design: BearingDesign) -> list[layout.PageFigure]:
    drawn = {"margins": design_margins_figure(design), "joint": design_figure(design)}
    return [layout.embed_figure(name, figure, _CAPTIONS[name]) for name, figure in drawn.items()]


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
        limit = "" if math.isnan(step.margin) else f"{words.margin(step.margin)}, "
        ending = _signs(limit + words.outcome(step))
        title = Markup("{} ({}): {}").format(step.title, step.equation, ending)
        steps.append((step, title, layout.PageTable(rows)))
    return _render("reasons", steps=steps)


def _number(name: str, value: float, unit: str) -> str:
    text = "unlimited" if math.isinf(value) else words.plain(value)
    return f"{name} {text}" if unit == "1" or math.isinf(value) else f"{name} {text} {unit}"


def _sensitivity(design: BearingDesign) -> Markup:
    weakest, sensitivities = design.assessment.weakest, design.sensitivities
    if weakest is None or not sensitivities:
        return Markup()
    shown = sensitivities[:_MOST_ROWS]
    rows = [(one.name, f"+{one.by}", _signs(f"{100 * one.change:+.2g} points")) for one in shown]
    return _render(
        "sensitivity",
        weakest=weakest,
        margin=_signs(words.margin(weakest.margin)),
        rows=layout.PageTable(rows, ("Number", "Change", "Margin, per cent"), numbers=(1, 2)),
    )


def _substitutes(design: BearingDesign) -> Markup:
    rows = []
    for one in design.substitutes:
        weakest = one.weakest
        governing = "" if weakest is None else f"{weakest.title} ({weakest.equation})"
        value = "" if weakest is None else words.margin(weakest.margin)
        difference = one.assessment.step("hardness_difference")
        hint = "" if difference.missing or difference.holds else "less than 100 HB below the pin"
        without = ", ".join(step.title for step in one.unknown)
        if without and weakest is not None and weakest.holds:
            value = f"{value} of those known"
        rows.append((one.material.name, _signs(value), governing, hint, without))
    if not rows:
        return Markup()
    head = ("Bushing", "Margin", "Weakest limit of the sliding surface", "Hardness", "Not known")
    return _render("bushings", rows=layout.PageTable(rows, head, numbers=[1]))


def _materials(design: BearingDesign) -> Markup:
    lock, titles = design.joint.lock, ("Pin", "Bushing", "Seats", "Housing")
    parts = dict(zip(titles, design.joint.parts.values(), strict=True))
    if lock is not None:
        parts["Lock plate"] = lock.plate
    rows = []
    for part, one in parts.items():
        strength = words.scaled(one.yield_stress, 1e6, ""), words.hardness_range(one)
        others = (one.youngs_modulus, 1e9), (one.conductivity, 1), (one.expansion, 1e-6)
        numbers = (words.scaled(value, unit, "") for value, unit in others)
        rows.append((part, one.name, *strength, *numbers))
    # one material may serve several parts
    sources = {one.name: one.source for one in parts.values()}
    elastic = ("Yield [MPa]", "Hardness [HB]", "E [GPa]", "λ [W/(m K)]", "α [10⁻⁶/K]")
    table = layout.PageTable(rows, ("Part", "Material", *elastic), numbers=range(2, 7))
    return _render("materials", rows=table, sources=sources.items())


def _settings(design: BearingDesign) -> Markup:
    """The joint with all its dimensions, to be saved and designed again."""
    name = layout.file_name(design.name, "joint.toml")
    media = "application/toml"
    link = layout.download_link(design.settings, name=name, label="Save as TOML", media=media)
    return _render("joint", link=link, settings=design.settings)


def _render(part: str, **content: Any) -> Markup:
    """Fill one section of the page."""
    return layout.render_part("design.html", part, _PACKAGE, **content)
