"""A comparison in words."""

from __future__ import annotations

import numpy as np
import xarray as xr

_NAMES = {"film_min": "minimum film", "film_mean": "mean film"}

# Probability below which tails decide that nobody has measured.
NO_CHANCE = 1e-12

_SIDES = 1.96  # standard deviations of a difference that is found in half of the cases


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
    probability = "p below 1e-12" if chance < NO_CHANCE else f"p = {chance:.2g}"
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
    # a pair is named once, with all statistics that differ
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
