"""The tables of the report: results, calibration, registration, flags and triggers."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.flags import Flag, describe_share
from erlif.io.files import motion_of, settings_of
from erlif.show.plots.files import FigureSource
from erlif.show.plots.maps import flag_swatch, flag_title
from erlif.show.plots.style import FLAG_COLOURS
from erlif.show.report.download import download_link, file_name, trigger_csv
from erlif.show.report.prediction import carrying_sentences, compare_correlations

_REASONS = {
    Flag.SATURATED: "a camera read full scale",
    Flag.DIM: "too little light above the dark level for a ratio",
    Flag.BAD_PIXEL: "hot, dead or noisy pixel of a camera",
    Flag.OUTSIDE_OVERLAP: "seen by one camera only",
    Flag.BELOW_RANGE: "film too thin for the calibration, or for a single pixel in this light",
    Flag.ABOVE_RANGE: "film too thick for the calibration, or for a single pixel in this light",
    Flag.POOR_REGISTRATION: "registration of the cameras not accurate enough",
    Flag.NO_FILM: "bubble or bare wall: both bands are without fluorescence",
}
"""Meaning of each flag for the reader of the report."""

_UNKNOWN = "not known"


def with_error(value: float, std: float, unit: str = "") -> str:
    """Write a value and its standard deviation, both to the second digit of the latter."""
    if not math.isfinite(value):
        return _UNKNOWN
    if not (math.isfinite(std) and std > 0):
        return f"{value:.4g} {unit}".strip()
    # two digits of the error, however large the value
    digits = max(0, 1 - math.floor(math.log10(std)))
    return f"{value:.{digits}f} ± {std:.{digits}f} {unit}".strip().replace("-", "−")


def with_span(values: Array) -> str:
    """Write the range of the finite values."""
    known = values[np.isfinite(values)]
    if known.size == 0:
        return _UNKNOWN
    low, high = (f"{float(end):.4g}" for end in (known.min(), known.max()))
    return f"{low} to {high}" if low != high else low


def with_digits(value: float, digits: int) -> str:
    """Write a value with a fixed number of digits, and a minus of the width of a plus."""
    return f"{value:.{digits}f}".replace("-", "−") if math.isfinite(value) else _UNKNOWN


def print_text(text: str) -> str:
    """Write a text of the command line as HTML, with the units of print.

    Examples
    --------
    >>> print_text("a film < 2 um at 40 degC")
    'a film &lt; 2 µm at 40 °C'
    """
    return re.sub(r"\bum\b", "µm", re.sub(r"\bdegC\b", "°C", escape(text)))


def make_table(
    rows: Iterable[Sequence[str]],
    *,
    head: Sequence[str] = (),
    caption: str = "",
    numbers: Iterable[int] = (),
) -> str:
    """Make an HTML table of cells that are HTML already.

    Parameters
    ----------
    rows : iterable of sequence of str
        The cells; the first of each row is its heading.
    head : sequence of str
        Headings of the columns.
    caption : str
        Title of the table.
    numbers : iterable of int
        Columns that are aligned at the right.

    Returns
    -------
    str

    Examples
    --------
    >>> make_table([("Load", "222 N")])
    '<table><tbody><tr><th scope="row">Load</th><td>222 N</td></tr></tbody></table>'
    """
    right = set(numbers)

    def look(column: int) -> str:
        return ' class="n"' if column in right else ""

    parts = ["<table>", f"<caption>{caption}</caption>" if caption else ""]
    if head:
        cells = "".join(f'<th scope="col"{look(n)}>{cell}</th>' for n, cell in enumerate(head))
        parts.append(f"<thead><tr>{cells}</tr></thead>")

    parts.append("<tbody>")
    for row in rows:
        cells = f'<th scope="row"{look(0)}>{row[0]}</th>'
        cells += "".join(f"<td{look(n)}>{cell}</td>" for n, cell in enumerate(row[1:], 1))
        parts.append(f"<tr>{cells}</tr>")
    parts.append("</tbody></table>")
    return "".join(parts)


def results_table(film: xr.Dataset, valid: float) -> str:
    """Make the table of the results; `valid` is the mean share of valid pixels."""
    rows = [
        ("Triggers, frame pairs", f"{film.sizes['trigger']}, {int(film.frames_used.sum())}"),
        ("Image", f"{film.sizes['x']} × {film.sizes['y']} pixels"),
        ("Valid pixels", f"{100 * valid:.1f} %"),
        *_film_rows(film),
        *_exponent_rows(film),
        *_theory_rows(film),
    ]
    if "film_parameter" in film:
        rows.append(("Film parameter Λ", with_span(film.film_parameter.values)))
    if "rocker_speed" not in film and "sliding_speed" in film:
        rows.append(("Sliding speed", f"{with_span(1e3 * film.sliding_speed.values)} mm/s"))
    if "load" in film:
        rows.append(("Load", f"{with_span(film['load'].values)} N"))

    # limits of the theory are sentences, too long for a cell
    caption = "Results (± is one standard deviation, random and shared)"
    limits_of = film.film_theory.attrs if "film_theory" in film else {}
    notes = str(limits_of.get("notes", "")).split("\n")
    limits = "; ".join(print_text(note) for note in notes if note)
    below = f"<p class='quiet'>Limits of the theory: {limits}</p>" if limits else ""
    sentences = [str(film.attrs.get("physics", "")), *carrying_sentences(film)]
    carried = " ".join(print_text(sentence) for sentence in sentences if sentence)
    below += f"<p class='quiet'>What carries the film: {carried}</p>" if carried else ""
    return make_table(rows, caption=caption) + below


def _film_rows(film: xr.Dataset) -> list[tuple[str, str]]:
    """Range of minimum and mean film thickness over the cycle."""
    rows = []
    for name, title in (
        ("film_min", "Minimum film thickness"),
        ("film_mean", "Mean film thickness"),
    ):
        value, std = film[name].values, film[f"{name}_std"].values
        if np.isfinite(value).any():
            low, high = int(np.nanargmin(value)), int(np.nanargmax(value))
            ends = [with_error(float(value[k]), float(std[k])) for k in (low, high)]
            over = "over the cycle" if "crank_angle" in film else "over the run"
            span = f"{ends[0]} to {ends[1]}" if low != high else ends[0]
            rows.append((f"{title}, {over}", f"{span} µm"))
    return rows


def _exponent_rows(film: xr.Dataset) -> list[tuple[str, str]]:
    """Fitted powers of speed over load."""
    rows = []
    for name, title in (("speed_exponent", "minimum"), ("speed_exponent_mean", "mean")):
        if name not in film:
            continue
        if not math.isfinite(float(film[name])):
            reason = "not fitted: fewer than five triggers can be used, or it hardly varies"
            rows.append((f"Power of speed over load, {title} film thickness", reason))
            continue
        text = with_error(float(film[name]), float(film[f"{name}_std"]))
        used = film[name].attrs.get("triggers_used")
        count = f" ({int(used)} triggers)" if used is not None else ""
        rows.append((f"Power of speed over load, {title} film thickness", text + count))
    return rows


def _theory_rows(film: xr.Dataset) -> list[tuple[str, str]]:
    """Predicted films, and the measured minimum relative to them."""
    if "film_theory" not in film:
        return []
    theory = film.film_theory
    share = film.film_min.values / theory.values
    known = share[np.isfinite(share)]
    median = f"{float(np.median(known)):.2g} (median)" if known.size else _UNKNOWN
    span = f"{with_span(theory.values)} µm; measured minimum over theory: {median}"
    steady = []
    if "film_predicted_min" in film:
        regime = escape(str(film.film_regime_map.attrs.get("regime", "")))
        text = f"{with_span(film.film_regime_map.values)} µm, {regime}"
        steady = [*_correlation_rows(film), ("Regime map for steady motion", text)]
    return [
        ("Theory", escape(str(theory.attrs.get("long_name", "")))),
        ("Range of the theory", span),
        ("Reason for this theory", escape(str(theory.attrs.get("reason", "")))),
        *steady,
        ("2.65 line-contact formula", f"{with_span(film.film_hamrock_dowson.values)} µm"),
    ]


def _correlation_rows(film: xr.Dataset) -> list[tuple[str, str]]:
    """Correlation of the minimum film with the size of the speed, measured and predicted."""
    found = compare_correlations(film)
    if found is None:
        return []
    measured, predicted = (
        f"{value:+.2f}".replace("-", "−") if math.isfinite(value) else _UNKNOWN for value in found
    )
    return [("Correlation of film with |speed|", f"measured {measured}, predicted {predicted}")]


def calibration_table(source: FigureSource) -> str:
    """Make the table of the calibration."""
    calibration = source.calibration
    values, stds = calibration.parameters.tolist(), calibration.standard_deviations.tolist()
    low, high = calibration.thickness_range
    one, two = calibration.bands
    date = f", {escape(calibration.date)}" if calibration.date else ""
    rows = [
        ("Fixture", escape(calibration.fixture) + date),
        ("Ratio", f"{two:g} nm over {one:g} nm (camera 2 over camera 1)"),
        ("Ratio of a vanishing film, K", with_error(values[0], stds[0])),
        ("Attenuation of camera 1, p", with_error(values[1], stds[1], "µm⁻¹")),
        ("Attenuation of camera 2, q", with_error(values[2], stds[2], "µm⁻¹")),
        ("Calibrated range", f"{low:.2f} to {high:.2f} µm"),
    ]
    if math.isfinite(calibration.reduced_chi_square):
        rows.append(("Reduced χ²", f"{calibration.reduced_chi_square:.2f}"))
    return make_table(rows, caption="Calibration")


def registration_table(registration: xr.Dataset, frames: xr.Dataset) -> str:
    """Make the table of the registration from the groups of a film."""
    quality = float(registration.attrs["registration_quality"])
    std = float(np.nanmedian(registration.displacement_std.values))
    rows = [
        ("Correlation of the aligned textures", f"{quality:.3f}"),
        ("Model", escape(str(registration.attrs["registration_model"]))),
        ("Standard deviation of the map", f"{std:.3f} px (median)"),
    ]

    # drift is a length; frames without a common texture have none
    drift = np.hypot(frames.drift_x.values, frames.drift_y.values)
    if np.isfinite(drift).any():
        rms, most = math.sqrt(float(np.nanmean(drift**2))), float(np.nanmax(drift))
        rows.append(("Drift of camera 2", f"{rms:.2f} px rms, {most:.2f} px at most"))
    if "pulse_energy" in frames and np.isfinite(frames.pulse_energy.values).any():
        spread = 100 * float(np.nanstd(frames.pulse_energy.values))
        rows.append(("Spread of the pulse energy", f"{spread:.1f} %"))
    skipped = int(np.isnan(frames.drift_x.values).sum())
    if skipped:
        rows.append(("Frame pairs without drift, or left out", f"{skipped}"))
    return make_table(rows, caption="Registration")


def flag_table(shares: Array) -> str:
    """Make the table of the flags that occur; `shares` in the order of `Flag`."""
    rows = [
        (_swatch(flag) + flag_title(flag), _REASONS[flag], describe_share(float(share)))
        for flag, share in zip(Flag, shares, strict=True)
        if share > 0
    ]
    if not rows:
        return "<p>All pixels are valid.</p>"
    caption = "Flagged pixels (one pixel may have several flags)"
    return make_table(rows, head=("Flag", "Reason", "Share"), caption=caption, numbers=[2])


def flag_key() -> str:
    """Make the key of the colours of all flags, in the order in which a map shows them."""
    return "".join(f"<li>{_swatch(flag)}{flag_title(flag)}</li>" for flag in FLAG_COLOURS)


def _swatch(flag: Flag) -> str:
    return f'<span class="swatch" style="background:{flag_swatch(flag)}"></span>'


@dataclass(frozen=True)
class _Column:
    """A column of the table of the triggers: shown where the film has all its variables."""

    title: str
    needs: tuple[str, ...]
    write: Callable[[dict[str, float]], str]


def _number(name: str, digits: int, scale: float = 1.0) -> Callable[[dict[str, float]], str]:
    return lambda one: with_digits(scale * one[name], digits)


def _significant(name: str) -> Callable[[dict[str, float]], str]:
    """Three significant digits, without an exponent."""

    def write(one: dict[str, float]) -> str:
        size = abs(one[name])
        before = math.floor(math.log10(size)) if math.isfinite(size) and size > 0 else 0
        return with_digits(one[name], max(2 - before, 0))

    return write


def _film(name: str) -> Callable[[dict[str, float]], str]:
    return lambda one: with_error(one[name], one[f"{name}_std"])


def _place(one: dict[str, float]) -> str:
    x, y = one["film_min_x"], one["film_min_y"]
    return f"{x:.0f}, {y:.0f}" if math.isfinite(x) else "–"


_COLUMNS = (
    _Column("Stroke", ("stroke",), lambda one: "outward" if one["stroke"] > 0 else "return"),
    _Column("Time [s]", ("time",), _number("time", 3)),
    _Column("Encoder [°]", ("encoder_angle",), _number("encoder_angle", 2)),
    _Column("Crank [°]", ("crank_angle",), _number("crank_angle", 2)),
    _Column("Position [mm]", ("position",), _number("position", 3)),
    _Column("Speed [rad/s]", ("rocker_speed",), _number("rocker_speed", 3)),
    _Column("Sliding [mm/s]", ("sliding_speed",), _number("sliding_speed", 1, 1e3)),
    _Column("Load [N]", ("load",), _number("load", 1)),
    _Column("Oil [°C]", ("temperature",), _number("temperature", 2)),
    _Column("Frame pairs", ("frames_used",), lambda one: f"{int(one['frames_used'])}"),
    _Column("Mean film thickness [µm]", ("film_mean",), _film("film_mean")),
    _Column("Minimum film thickness [µm]", ("film_min",), _film("film_min")),
    _Column("at column, row [px]", ("film_min_x", "film_min_y"), _place),
    _Column("Theory [µm]", ("film_theory",), _significant("film_theory")),
    _Column("2.65 formula [µm]", ("film_hamrock_dowson",), _significant("film_hamrock_dowson")),
    _Column("Λ", ("film_parameter",), _number("film_parameter", 1)),
)


_ROWS = 500  # triggers of the table at most

_ANGLES = {"rotation": "Disc [°]", "sinusoidal": "Drive [°]"}
"""Title of the column of the crank angle by the kind of motion."""


def trigger_table(film: xr.Dataset, valid: Array, *, most: float = float("inf")) -> str:
    """Make the table of the triggers, with a link that saves their numbers as CSV.

    Parameters
    ----------
    film : xarray.Dataset
    valid : array, (trigger,)
        Share of valid pixels. [1]
    most : float
        Characters of the file; of a longer one, triggers are left out evenly.

    Returns
    -------
    str
        HTML. A long table has evenly chosen rows.
    """
    columns = [column for column in _COLUMNS if all(name in film for name in column.needs)]
    titles = [column.title for column in columns]
    if "Crank [°]" in titles:
        titles[titles.index("Crank [°]")] = _ANGLES.get(motion_of(film), "Crank [°]")

    # columns of text from the log are not part of the table
    shown = {
        str(name): film[name].values
        for name in film.variables
        if film[name].dims == ("trigger",) and film[name].dtype.kind in "fiu"
    }
    count = film.sizes["trigger"]
    rows = []
    every = -(-count // _ROWS)
    for k in range(0, count, every):
        one = {name: float(values[k]) for name, values in shown.items()}
        cells = [column.write(one) for column in columns]
        rows.append([f"{k}", *cells, f"{100 * valid[k]:.1f} %"])

    head = ["Trigger", *titles, "Valid pixels"]
    numbers = [n for n, title in enumerate(head) if title != "Stroke"]
    table = make_table(rows, head=head, numbers=numbers)
    look = 'class="wide dense" tabindex="0" role="region" aria-label="Table of the triggers"'
    return f"{_download(film, valid, every, most)}<div {look}>{table}</div>"


def _download(film: xr.Dataset, valid: Array, every: int, most: float) -> str:
    """The link, and what of the triggers table and file hold."""
    count = film.sizes["trigger"]
    text = trigger_csv(film, valid, np.arange(count))
    held = 1
    if len(text) > most:
        held = int(-(-len(text) // most))
        text = trigger_csv(film, valid, np.arange(0, count, held))
    link = download_link(
        text, name=file_name(settings_of(film).name, "triggers.csv"), label="Save as CSV"
    )
    notes = [f"The table holds one of {every} triggers."] if every > 1 else []
    if held > 1:
        notes.append(f"The CSV file holds one of {held}; <code>erlif export</code> writes all.")
    elif every > 1:
        notes.append(f"The CSV file holds all {count}.")
    return f"<p>{link}. {' '.join(notes)}</p>".replace(". </p>", "</p>")
