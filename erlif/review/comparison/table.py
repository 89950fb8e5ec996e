"""A comparison in words."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.terms import SOURCES, TERMS

_NAMES = {"film_min": "minimum film", "film_mean": "mean film"}

# Probability below which tails decide that nobody has measured.
NO_CHANCE = 1e-12

_SIDES = 1.96  # standard deviations of a difference that is found in half of the cases


def describe_comparison(comparison: xr.Dataset) -> list[str]:
    """Write a comparison as lines of text, the conclusion last.

    Parameters
    ----------
    comparison : xarray.Dataset
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
    if "duty" in comparison:
        lines.append(f"power of {comparison.duty.attrs['long_name']}:")
        lines += [_describe_power(comparison, run) for run in (*comparison.run.values, None)]
    lines.append(f"differences, {comparison.attrs['method']}:")
    for k in range(comparison.sizes["pair"]):
        one = comparison.isel(pair=k)
        lines += [_describe_pair(one, name) for name in _NAMES]
        lines.append(_describe_rig(one, comparison))
    if "note" in comparison.attrs:
        lines.append(f"note: {comparison.attrs['note']}")
    lines += _describe_map(comparison)
    lines += _describe_chart(comparison)
    lines += _describe_settings(comparison)
    lines.append(f"conclusion: {_which_differ(comparison)}")
    return lines


def _describe_power(comparison: xr.Dataset, run: str | None) -> str:
    """Powers of one run, or of all together."""
    prefix = "" if run is not None else "joint_"
    words = []
    for name, label in _NAMES.items():
        one = comparison.sel(statistic=name)
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
    own, changed = float(of.difference_std_own), float(of.difference_std_changed)
    size = f"{value:+.3f} ± {own:.3f} ± {changed:.3f} um (random; may have changed), {probability}"
    if of.differs.item():
        return f"{runs} {size}, differs"
    text = f"{runs} {size}, no difference found (one of {_SIDES * std:.3f} um would be, in half)"
    if changed < own:
        return text
    hides = SOURCES[str(of.largest_term.item())]
    return f"{text}; most of the error: {hides.what}. {hides.cure}"


def _describe_rig(one: xr.Dataset, comparison: xr.Dataset) -> str:
    """What makes two runs those of one rig or of two, and what of it is not known."""
    runs = [one.second.item(), one["first"].item()]
    names = " and ".join(runs)
    if differs := one.rig_differs.item():
        return f"  {names}: two rigs by {differs}; the errors of both add"
    serials = comparison.serials.sel(run=runs[0]).item()
    cameras = f"cameras {serials}" if serials else "serial numbers of the cameras unknown"
    days = comparison.recorded.sel(run=runs).values.tolist()
    if days[0] == days[1]:
        return f"  {names}: one rig, {cameras}, {f'of {days[0]}' if days[0] else 'days unknown'}"
    least, drift = TERMS["ratio"].apart or 0.0, 100 * comparison.attrs["calibration_drift"]
    why = "by its calibrations" if drift > least else "assumed, calibrations of both days show it"
    return (
        f"  {names}: one rig, {cameras}, of {days[0] or 'an unknown day'} and "
        f"{days[1] or 'an unknown day'}; change of the ratio {max(least, drift):.2g} % ({why})"
    )


def _describe_map(comparison: xr.Dataset) -> list[str]:
    """The difference map in a line."""
    known = np.isfinite(comparison.map_difference.values)
    if not known.any():
        return ["difference map: no cell is valid in both runs"]
    share = float(comparison.map_differs.values[known].mean())
    attrs = comparison.attrs
    return [
        f"difference map, {attrs['map_second_run']} ({attrs['map_second']}) less "
        f"{attrs['map_first_run']} ({attrs['map_first']}): {share:.0%} of {known.sum()} cells "
        "differ, with 5 % of false discoveries"
    ]


def _describe_chart(comparison: xr.Dataset) -> list[str]:
    """Points beyond the limits of the control charts."""
    lines = []
    if "patch_ratio" in comparison:
        beyond = np.abs(comparison.patch_ratio - comparison.patch_centre) > comparison.patch_limit
        runs = ", ".join(str(name) for name in comparison.run.values[beyond.values])
        state = f"beyond the limits: {runs}" if runs else "all runs within the limits"
        lines.append(f"control chart of the reference patch: {state}")
    if "calibration_verdict" in comparison:
        for date, verdict in zip(
            comparison.calibration_date.values[1:],
            comparison.calibration_verdict.values[1:],
            strict=True,
        ):
            lines.append(f"calibration of {date or 'unknown date'}: {verdict}")
    return lines


def _describe_settings(comparison: xr.Dataset) -> list[str]:
    """The settings that differ, with the value of each run."""
    if "stated" not in comparison:
        return []
    lines = ["settings that differ:"]
    for setting, values in zip(comparison.setting.values, comparison.stated.values, strict=True):
        runs = zip(comparison.run.values, values, strict=True)
        lines.append(f"  {setting}: {', '.join(f'{run} {value}' for run, value in runs)}")
    return lines


def _which_differ(comparison: xr.Dataset) -> str:
    """State in one sentence which runs differ."""
    # a pair is named once, with all statistics that differ
    sentences = []
    for k in range(comparison.sizes["pair"]):
        one = comparison.isel(pair=k)
        differing = [label for name, label in _NAMES.items() if one.differs.sel(statistic=name)]
        if differing:
            what = " and ".join(differing)
            sentences.append(f"{one['first'].item()} and {one.second.item()} differ in {what}")
    tests = int(np.isfinite(comparison.probability.values).sum())
    if not tests:
        return "no runs could be compared: no common trigger has a film within the measurable range"
    if not sentences:
        return f"no two runs differ by more than chance, at 5 % for all {tests} tests together"
    return "; ".join(sentences)
