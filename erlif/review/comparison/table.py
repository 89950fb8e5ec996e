"""A comparison in words and tables."""

from __future__ import annotations

import csv
from html import escape
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.io.files import replacing

_NAMES = {"film_min": "minimum film", "film_mean": "mean film"}
_NO_CHANCE = 1e-12  # probabilities below it depend on tails that nobody has measured
_SIDES = 1.96  # standard deviations of a difference that is found in half of the cases

_COLUMNS = (
    "first",
    "second",
    "statistic",
    "difference [um]",
    "std [um]",
    "probability",
    "probability corrected",
    "differs",
    "same calibration",
)


def describe_comparison(found: xr.Dataset) -> list[str]:
    """Write a comparison as lines of text, the conclusion last.

    Parameters
    ----------
    found : xarray.Dataset
        As `erlif.compare` returns it.

    Returns
    -------
    list of str

    Examples
    --------
    >>> import erlif
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> thicker = film.assign(film_min=film.film_min + 0.5)
    >>> print(describe_comparison(erlif.compare([film, thicker]))[-1])
    conclusion: example (1) and example (2) differ in minimum film
    """
    lines = []
    if "duty" in found:
        lines.append(f"power of {found.duty.attrs['long_name']}:")
        lines += [_describe_power(found, run) for run in (*found.run.values, None)]
    lines.append(f"differences, {found.attrs['method']}:")
    for k in range(found.sizes["pair"]):
        lines += [_describe_pair(found.isel(pair=k), name) for name in _NAMES]
    if "note" in found.attrs:
        lines.append(f"note: {found.attrs['note']}")
    lines += _describe_map(found)
    lines += _describe_chart(found)
    lines.append(f"conclusion: {_conclude(found)}")
    return lines


def _describe_power(found: xr.Dataset, run: str | None) -> str:
    """Powers of one run, or of all together."""
    prefix = "" if run is not None else "joint_"
    words = []
    for name, label in _NAMES.items():
        one = found.sel(statistic=name)
        if run is not None:
            one = one.sel(run=run)
        value, std = float(one[f"{prefix}exponent"]), float(one[f"{prefix}exponent_std"])
        known = f"n = {value:.3f} ± {std:.3f}" if np.isfinite(value) else "not determined"
        words.append(f"{label} {known}")
    return f"  {run if run is not None else 'all runs together'}: {', '.join(words)}"


def _describe_pair(one: xr.Dataset, name: str) -> str:
    """One difference of one pair."""
    of = one.sel(statistic=name)
    runs = f"  {one.second.item()} less {one.first.item()}: {_NAMES[name]}"
    value, std = float(of.difference), float(of.difference_std)
    if not np.isfinite(value):
        return f"{runs} not comparable: no common trigger has one within the measurable range"
    chance = float(of.probability_corrected)
    probability = "p below 1e-12" if chance < _NO_CHANCE else f"p = {chance:.2g}"
    size = f"{value:+.3f} ± {std:.3f} um, {probability}"
    if of.differs.item():
        return f"{runs} {size}, differs"
    return f"{runs} {size}, no difference found (one of {_SIDES * std:.3f} um would be, in half)"


def _describe_map(found: xr.Dataset) -> list[str]:
    """The difference map in a line."""
    known = np.isfinite(found.map_difference.values)
    if not known.any():
        return ["difference map: no cell is valid in both runs"]
    share = float(found.map_differs.values[known].mean())
    attrs = found.attrs
    return [
        f"difference map, {attrs['map_second_run']} ({attrs['map_second']}) less "
        f"{attrs['map_first_run']} ({attrs['map_first']}): {share:.0%} of {known.sum()} cells "
        "differ, with 5 % of false discoveries"
    ]


def _describe_chart(found: xr.Dataset) -> list[str]:
    """Points beyond the limits of the control charts."""
    lines = []
    if "patch_ratio" in found:
        beyond = np.abs(found.patch_ratio - found.patch_centre) > found.patch_limit
        runs = ", ".join(str(name) for name in found.run.values[beyond.values])
        state = f"beyond the limits: {runs}" if runs else "all runs within the limits"
        lines.append(f"control chart of the reference patch: {state}")
    if "calibration_verdict" in found:
        for date, verdict in zip(
            found.calibration_date.values[1:], found.calibration_verdict.values[1:], strict=True
        ):
            lines.append(f"calibration of {date or 'unknown date'}: {verdict}")
    return lines


def _conclude(found: xr.Dataset) -> str:
    """Which runs differ, in one sentence."""
    sentences = []
    for k in range(found.sizes["pair"]):
        one = found.isel(pair=k)
        differing = [label for name, label in _NAMES.items() if one.differs.sel(statistic=name)]
        if differing:
            what = " and ".join(differing)
            sentences.append(f"{one['first'].item()} and {one.second.item()} differ in {what}")
    tests = int(np.isfinite(found.probability.values).sum())
    if not tests:
        return "no runs could be compared: no common trigger has a film within the measurable range"
    if not sentences:
        return f"no two runs differ by more than chance, at 5 % for all {tests} tests together"
    return "; ".join(sentences)


def pair_rows(found: xr.Dataset) -> list[list[str]]:
    """Rows of the table of pairs, as text in the order of its columns."""
    rows = []
    for k in range(found.sizes["pair"]):
        for name in _NAMES:
            one = found.isel(pair=k).sel(statistic=name)
            rows.append(
                [
                    str(one["first"].item()),
                    str(one.second.item()),
                    name,
                    f"{float(one.difference):.4f}",
                    f"{float(one.difference_std):.4f}",
                    f"{float(one.probability):.3g}",
                    f"{float(one.probability_corrected):.3g}",
                    str(int(one.differs)),
                    str(int(one.same_calibration)),
                ]
            )
    return rows


def write_pair_table(found: xr.Dataset, output: Path) -> None:
    """Write the table of pairs, as CSV or as HTML by the suffix.

    Parameters
    ----------
    found : xarray.Dataset
        As `erlif.compare` returns it.
    output : Path
        File in .csv or .html.

    Raises
    ------
    OutputError
        If it cannot be written.

    Examples
    --------
    >>> import erlif
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> found = erlif.compare([film, film.assign(film_min=film.film_min + 0.5)])
    >>> with TemporaryDirectory() as directory:
    ...     write_pair_table(found, Path(directory) / "compare.csv")
    ...     (Path(directory) / "compare.csv").read_text().splitlines()[1][:40]
    'example (1),example (2),film_min,0.5000,'
    """
    rows = pair_rows(found)
    with replacing(output) as scratch:
        if output.suffix == ".html":
            scratch.write_text(_html(rows), encoding="utf-8")
            return
        with scratch.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([_COLUMNS, *rows])


def _html(rows: list[list[str]]) -> str:
    """The table as a page; a probability below those that are known is stated as such."""
    chances = [_COLUMNS.index(name) for name in ("probability", "probability corrected")]
    for row in rows:
        for k in chances:
            row[k] = "below 1e-12" if float(row[k]) < _NO_CHANCE else row[k]
    head = "".join(f"<th>{escape(name)}</th>" for name in _COLUMNS)
    body = "\n".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    style = (
        ":root{color-scheme:light dark}body{font:15px sans-serif;margin:1rem}"
        "div{overflow-x:auto}td,th{padding:.2rem .6rem;text-align:right}"
        "table{border-collapse:collapse;font-variant-numeric:tabular-nums}"
        "tr{border-bottom:1px solid #8886}"
    )
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width">\n'
        '<meta name="generator" content="erlif">\n'
        f"<title>Runs compared</title><style>{style}</style></head>\n<body><h1>Runs compared</h1>"
        "\n<p>Differences are the second run less the first; std is one standard deviation.</p>"
        f"\n<div><table><tr>{head}</tr>\n{body}</table></div></body></html>\n"
    )
