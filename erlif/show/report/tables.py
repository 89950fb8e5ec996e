"""The tables of the report: results, calibration, registration, flags and triggers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import Markup

from erlif.core.arrays import AnyArray, Array
from erlif.core.flags import FLAG_COLOURS, Flag, describe_share
from erlif.io.conversion import table_columns, table_csv
from erlif.io.files import applicable_theory, motion_of, settings_of
from erlif.show.plots.files import FigureSource
from erlif.show.report.layout import (
    TABLES,
    PageTable,
    decimals,
    download_link,
    file_name,
    print_units,
    render,
)
from erlif.show.report.summary import describe_film

_UNKNOWN = "not known"


def with_error(value: float, std: float) -> str:
    """Write a value and its standard deviation, both to the second digit of the latter."""
    if not math.isfinite(value):
        return _UNKNOWN
    if not (math.isfinite(std) and std > 0):
        return f"{value:.4g}"
    # two digits of the error, however large the value
    digits = decimals(std, 2)
    return f"{value:.{digits}f} ± {std:.{digits}f}".replace("-", "−")


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


# Rows of the summary that other parts of the page hold.
_ELSEWHERE = ("warnings", "notes", "flagged pixels")


def results_table(film: xr.Dataset, shares: Array) -> PageTable:
    """Make the table of the results; `shares` as `erlif.io.files.flag_shares` returns them."""
    # the same words as on the terminal, with the signs of print
    described = describe_film(film, shares)
    rows = [
        ("Triggers, frame pairs", f"{film.sizes['trigger']}, {int(film.frames_used.sum())}"),
        ("Image", f"{film.sizes['x']} × {film.sizes['y']} pixels"),
        *(
            (f"{title[:1].upper()}{title[1:]}", print_units(text.replace(" -", " −")))
            for title, text in described.items()
            if title not in _ELSEWHERE
        ),
    ]
    if "film_parameter" in film:
        rows.append(("Film parameter Λ", with_span(film.film_parameter.values)))
    if "rocker_speed" not in film and "sliding_speed" in film:
        rows.append(("Sliding speed", f"{with_span(1e3 * film.sliding_speed.values)} mm/s"))
    if "joint_load" in film:
        rows.append(("Load", f"{with_span(film['joint_load'].values)} N"))

    return PageTable(rows, caption="Results (± is one standard deviation, random and shared)")


def theory_limits(film: xr.Dataset) -> list[str]:
    """Limits of the theory: sentences, too long for a cell."""
    theory = applicable_theory(film)
    notes = "" if theory is None else str(theory.attrs.get("notes", ""))
    return [note for note in notes.split("\n") if note]


def calibration_table(source: FigureSource) -> PageTable:
    """Make the table of the calibration."""
    calibration = source.calibration
    low, high = calibration.thickness_range
    one, two = calibration.bands
    date = f", {calibration.date}" if calibration.date else ""
    rows = [
        ("Fixture", calibration.fixture + date),
        ("Ratio", f"{two:g} nm over {one:g} nm (camera 2 over camera 1)"),
        *(
            (print_units(title), with_error(float(value), float(std)))
            for title, value, std in zip(
                TABLES["summary"]["calibration"],
                calibration.parameters,
                calibration.standard_deviations,
                strict=False,
            )
        ),
        ("Calibrated range", f"{low:.2f} to {high:.2f} µm"),
    ]
    if math.isfinite(calibration.reduced_chi_square):
        rows.append(("Reduced χ²", f"{calibration.reduced_chi_square:.2f}"))
    return PageTable(rows, caption="Calibration")


def registration_table(registration: xr.Dataset, frames: xr.Dataset) -> PageTable:
    """Make the table of the registration from the groups of a film."""
    quality = float(registration.attrs["registration_quality"])
    std = float(np.nanmedian(registration.displacement_std.values))
    rows = [
        ("Correlation of the aligned textures", f"{quality:.3f}"),
        ("Model", str(registration.attrs["registration_model"])),
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
    return PageTable(rows, caption="Registration")


def flag_table(shares: Array) -> PageTable:
    """Make the table of the flags that occur; `shares` in the order of `Flag`."""
    swatch = Markup('<span class="swatch" style="background:{}"></span>{}')
    rows = []
    for flag, share in zip(Flag, shares, strict=True):
        if share > 0:
            name = swatch.format(FLAG_COLOURS[flag].lower(), flag.title)
            rows.append((name, TABLES["flags"][flag.name], describe_share(float(share))))
    caption = "Flagged pixels (one pixel may have several flags)"
    return PageTable(rows, ("Flag", "Reason", "Share"), caption, numbers=[2])


def _write_cells(film: xr.Dataset, name: str, column: dict[str, Any]) -> list[str]:
    """Cells of a variable of the triggers, in the form of its column."""
    values = film[name].values.tolist()
    match column.get("form"):
        case "stroke":
            return ["outward" if sign > 0 else "return" for sign in values]
        case "error":
            return list(map(with_error, values, film[f"{name}_std"].values.tolist()))
        case "place":
            places = zip(values, film.film_min_y.values, strict=True)
            return [f"{x:.0f}, {y:.0f}" if math.isfinite(x) else "–" for x, y in places]
        case "significant":
            return [with_digits(value, decimals(value, 3)) for value in values]
    return [with_digits(column.get("scale", 1.0) * value, column["digits"]) for value in values]


_ROWS = 500  # triggers of the table at most


def trigger_section(film: xr.Dataset, valid: Array, *, most: float = float("inf")) -> Markup:
    """Write the table of the triggers, with a link that saves their numbers as CSV.

    Parameters
    ----------
    film : xarray.Dataset
    valid : array, (trigger,)
        Share of valid pixels. [1]
    most : float
        Characters of the file; of a longer one, triggers are left out evenly.

    Returns
    -------
    Markup
        A long table has evenly chosen rows.
    """
    count = film.sizes["trigger"]
    every = -(-count // _ROWS)
    chosen = film.drop_dims(["y", "x"], errors="ignore").isel(trigger=slice(None, None, every))

    columns = {"Trigger": [f"{k}" for k in range(0, count, every)]}
    for name, column in TABLES["triggers"].items():
        if name in film:
            title = column.get(motion_of(film), column["title"])  # that of an angle by its motion
            columns[title] = _write_cells(chosen, name, column)
    columns["Valid pixels"] = [f"{100 * share:.1f} %" for share in valid[::every]]
    numbers = [n for n, title in enumerate(columns) if title != "Stroke"]

    text, held = trigger_csv(film, valid, np.arange(count)), 1
    if len(text) > most:
        held = int(-(-len(text) // most))
        text = trigger_csv(film, valid, np.arange(0, count, held))
    return render(
        "triggers.html",
        triggers=PageTable(
            list(zip(*columns.values(), strict=True)), tuple(columns), numbers=numbers
        ),
        link=download_link(text, name=file_name(settings_of(film).name, "triggers.csv")),
        every=every,
        held=held,
        count=count,
    )


def trigger_csv(film: xr.Dataset, valid: Array, triggers: AnyArray) -> str:
    """Write the numbers of triggers as CSV, one row for each; `valid` are shares of pixels.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> text = trigger_csv(example_film(), np.full(6, 0.5), np.arange(6))
    >>> text.splitlines()[0][:44]
    'trigger,frames_used [1],crank_angle [degree]'
    """
    # covariances and other numbers with further dims are left to erlif export
    columns = {
        each.heading: each.values
        for each in table_columns(film)
        if each.name in film.variables and each.values.dtype.kind in "iufb"
    }
    columns["valid share [1]"] = valid
    chosen = {name: values[triggers].astype(float).tolist() for name, values in columns.items()}
    return table_csv(chosen, digits=9, missing="NaN")
