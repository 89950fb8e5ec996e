"""A film in a few lines for the terminal, and what it is beside theory and speed."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.flags import Flag, describe_share
from erlif.core.notes import Level, split_notes
from erlif.core.units import count_of
from erlif.io.files import (
    applicable_theory,
    fastest_trigger,
    flag_shares,
    formula_label,
    formula_scope,
    shows_plateau,
    takes,
)
from erlif.show.report.layout import decimals, print_rows
from erlif.show.report.prediction import describe_difference
from erlif.trend import LEAST_TRIGGERS

_TITLE = 10  # columns of the titles of a short summary
_COLUMNS = 80
_NOTABLE = 0.01  # share of the region beyond the range from which a mean is that of a part
_WHOLE = ("formula", "speed")  # rows of which a short summary has every sentence


@takes(film="film")
def summarise(film: xr.Dataset) -> str:
    """Describe a film: thickness over the cycle, valid pixels, trend, theory and notes.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.

    Returns
    -------
    str
        The size of the film, then one title a line with its text; long texts take several lines.

    Examples
    --------
    The minimum film thickness of this film follows the speed to the power of 0.6:

    >>> from erlif.show.plots import example_film
    >>> lines = summarise(example_film()).splitlines()
    >>> lines[0]
    'example: 6 triggers from 6 frame pairs of 64 x 24 pixels'
    >>> print(*[line for line in lines if "n =" in line], sep="\\n")
      power of speed over load    minimum n = 0.600 ± 0.010, mean n = 0.600 ± 0.010
    """
    return print_rows(_first_line(film), describe_film(film, flag_shares(film)))


def _first_line(film: xr.Dataset, *, columns: int = 0) -> str:
    """Name and size of a film; a long name is cut where columns are given."""
    name = str(film.attrs["title"]).removeprefix("oil-film thickness, ")
    size = f": {_describe_size(film)}"
    room = columns - len(size) - 3
    return f"{name[:room]}..." + size if 0 < room < len(name) - 3 else name + size


def _describe_size(film: xr.Dataset) -> str:
    """Triggers, frame pairs and pixels of a film."""
    pairs = count_of(int(film.frames_used.sum()), "frame pair")
    pixels = f"{film.sizes['x']} x {film.sizes['y']} pixels"
    return f"{count_of(film.sizes['trigger'], 'trigger')} from {pairs} of {pixels}"


@takes(film="film")
def summarise_briefly(film: xr.Dataset) -> str:
    """Describe a film in ten lines of 80 columns, and each warning; `summarise` has the rest.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.

    Returns
    -------
    str
        The warnings, film, valid pixels, film over Hamrock-Dowson, correlation, power and delay of
        film and speed, what carries the film, and the largest error.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> print(*summarise_briefly(example_film()).splitlines()[:2], sep="\\n")
    example: 6 triggers from 6 frame pairs of 64 x 24 pixels
      film      min 2.51 ± 0.03 to 3.49 ± 0.03, mean 3.27 ± 0.02 to 4.54 ± 0.02 um
    """
    lines = [_first_line(film, columns=_COLUMNS)]
    for shown, text in enumerate(_split_notes(film)[0].splitlines()):
        lines += _wrapped("" if shown else "warning", _first_clause(text))
    for title, text in describe_briefly(film, flag_shares(film)).items():
        lines += _wrapped(title, text if title in _WHOLE else _first_sentence(text))
    return "\n".join(lines)


def describe_briefly(film: xr.Dataset, shares: Array) -> dict[str, str]:
    """Describe a film in its few most important rows.

    Parameters
    ----------
    film : xarray.Dataset
    shares : array, (trigger, flag)
        As `erlif.io.files.flag_shares` returns them.

    Returns
    -------
    dict of str to str
        Text by title, of those that are known.
    """
    following = describe_following(film)
    powers = "; ".join(filter(None, [_describe_trend(film), describe_delay(film)]))
    lost = ", ".join(_list_flags(shares, largest=True)[:2])
    texts = {
        "film": _describe_films(film),
        "valid": f"{shares[:, 0].mean():.1%} of the pixels{lost and '; '}{lost}",
        "formula": describe_factor(film),
        "speed": "\n".join(filter(None, [following, powers])),
        "carrier": str(film.attrs.get("physics", "")),
        "error": str(film.attrs.get("largest_error", "")),
    }
    return {title: text for title, text in texts.items() if text}


def _wrapped(title: str, text: str) -> list[str]:
    """A title and the lines of a text, none beyond the columns."""
    width = _COLUMNS - _TITLE - 2
    lines = [line for part in text.split("\n") for line in textwrap.wrap(part, width)]
    return [f"  {title if k == 0 else '':{_TITLE}s}{line}" for k, line in enumerate(lines)]


def _first_clause(text: str) -> str:
    """The finding of a warning; the rest is why, and what to do."""
    return _first_sentence(text).partition("; ")[0]


def _first_sentence(text: str) -> str:
    return text.split("\n")[0].partition(". ")[0].rstrip(".")


def _list_flags(shares: Array, *, largest: bool = False) -> list[str]:
    """Flags that occur with their shares, in their order or the most frequent first."""
    flags = [
        (float(share), flag) for share, flag in zip(shares.mean(axis=0)[1:], Flag, strict=True)
    ]
    ordered = sorted(flags, key=lambda one: -one[0]) if largest else flags
    return [
        f"{str(flag.name).lower()} {describe_share(share, '%')}" for share, flag in ordered if share
    ]


def _ends(film: xr.Dataset, variable: str) -> list[tuple[int, float, float]]:
    """Trigger, value and error of the least and the largest value over the cycle; none of NaN."""
    values, std = film[variable].values, film[f"{variable}_std"].values
    if not np.isfinite(values).any():
        return []
    ends = dict.fromkeys((int(np.nanargmin(values)), int(np.nanargmax(values))))
    return [(k, float(values[k]), float(std[k])) for k in ends]  # one of a single trigger


def _describe_films(film: xr.Dataset) -> str:
    """Range of the minimum and of the mean over the cycle; of a plateau, of its centre."""
    ranges = []
    second = ("film_central", "h_c") if shows_plateau(film) else ("film_mean", "mean")
    for name in ("film_min", second[0]):
        ends = _ends(film, name)
        digits = 2 if ends and ends[-1][1] < 10 else 1  # four numbers fit a line
        texts = [f"{value:.{digits}f} ± {std:.{digits}f}" for _, value, std in ends]
        ranges.append(" to ".join(texts) or "none")
    if ranges == ["none", "none"]:
        return "none: no trigger has enough valid pixels in the region"
    return f"min {ranges[0]}, {second[1]} {ranges[1]} um"


def describe_film(film: xr.Dataset, shares: Array) -> dict[str, str]:
    """Describe a film row by row, for the terminal and for the report."""
    warned, noted = _split_notes(film)
    # the order is that of reading: what is wrong, films, what limits and moves them, remarks
    rows = {
        "warnings": warned,
        "minimum film thickness": _describe_statistic(film, "film_min"),
        "central film thickness": _describe_statistic(film, "film_central")
        if shows_plateau(film)
        else "",
        "mean film thickness": _describe_statistic(film, "film_mean"),
        "largest error": str(film.attrs.get("largest_error", "")),
        "displacement of the pin": _describe_pin(film),
        "valid pixels": f"{shares[:, 0].mean():.1%}",
        "flagged pixels": ", ".join(_list_flags(shares)) or "none",
        "power of speed over load": _describe_trend(film),
        "theory at the top speed": describe_theory(film),
        "measured less predicted": describe_difference(film),
        "film over Hamrock-Dowson": describe_factor(film),
        "film over other theory": describe_other_factors(film),
        "correlation with the speed": describe_correlations(film),
        "friction at the top speed": describe_friction(film),
        "what carries the film": str(film.attrs.get("physics", "")),
        "notes": noted,
    }
    return {title: text for title, text in rows.items() if text}


def _split_notes(film: xr.Dataset) -> tuple[str, str]:
    """Warnings and plain notes of a film, each on its line."""
    notes = split_notes(str(film.attrs.get("notes", "")))
    warned, noted = (
        "\n".join(text for level, text in notes if (level is Level.NOTE) is plain)
        for plain in (False, True)
    )
    return warned, noted


def summarise_in_a_line(film: xr.Dataset) -> str:
    """Describe a film in one line, for a list of many.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it; its maps are not read.

    Returns
    -------
    str
        Range of minimum and mean film thickness over the cycle, speed exponent where the film has a
        speed and a load, triggers, frame pairs, pixels.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> print(*summarise_in_a_line(example_film()).split(", "), sep="\\n")
    min 2.51 ± 0.03 to 3.49 ± 0.03
    mean 3.27 ± 0.02 to 4.54 ± 0.02 um
    power n = 0.600 ± 0.010
    6 triggers from 6 frame pairs of 64 x 24 pixels
    """
    power = f"power {_power(film, 'speed_exponent')}" if "speed_exponent" in film else ""
    return ", ".join(filter(None, [_describe_films(film), power, _describe_size(film)]))


_LOAD_LINES = {
    "given": ", as given",
    "fitted": ", fitted to the orbit",
    "swing": ", the middle of the swing",
    "middle": ", the middle of the image",
}


def _describe_pin(film: xr.Dataset) -> str:
    """Range of the displacement of the pin, with the largest standard deviation of each."""
    if "pin_displacement" not in film or not np.isfinite(film.pin_displacement.values).any():
        return ""
    std = np.sqrt(np.diagonal(film.pin_position_cov.values, axis1=1, axis2=2))
    texts = []
    for k, where in enumerate(("towards the load", "sideways")):
        place, error = film.pin_displacement.values[:, k], np.nanmax(std[:, k])
        low, high = np.nanmin(place), np.nanmax(place)
        texts.append(f"{low:.2f} to {high:.2f} ± {error:.2f} um {where}")
    attrs = film.pin_displacement.attrs
    if "load_line" in attrs:
        std = attrs.get("load_line_std")
        error = "" if std is None else f" ± {std:.2f}"
        source = _LOAD_LINES.get(str(attrs.get("load_line_source")), "")
        texts.append(f"about the load line at {attrs['load_line']:.2f}{error} mm{source}")
    return ", ".join(texts)


def _describe_statistic(film: xr.Dataset, variable: str) -> str:
    """Range of a statistic over the cycle, with the triggers of its ends."""
    ends = _ends(film, variable)
    if ends:
        return " to ".join(
            f"{value:.2f} ± {std:.2f} um (trigger {k}{_describe_part(film, variable, k)})"
            for k, value, std in ends
        )
    if variable == "film_min" and np.isfinite(film.film_mean.values).any():
        return "none: no smooth gap describes the maps, or too few of their pixels are valid"
    return "none: no trigger has enough valid pixels in the region of interest"


def _describe_part(film: xr.Dataset, variable: str, trigger: int) -> str:
    """Part of the region that a mean was taken over, where the rest is beyond the range."""
    if variable != "film_mean" or "share_beyond_range" not in film:
        return ""
    share = float(film.share_beyond_range.values[trigger])
    if not share > _NOTABLE:
        return ""
    return f", over the {1 - share:.0%} of the region within the calibrated range"


def _describe_trend(film: xr.Dataset) -> str:
    """Fitted powers of speed over load."""
    if "speed_exponent" not in film:
        return ""
    exponent = film.speed_exponent
    if not np.isfinite(float(exponent)):
        used, all_of = int(exponent.attrs.get("triggers_used", 0)), film.sizes["trigger"]
        if used >= LEAST_TRIGGERS:
            return "not determined: speed over load is constant"
        return f"not determined: {used} of {all_of} triggers usable, {LEAST_TRIGGERS} needed"
    minimum, mean = _power(film, "speed_exponent"), _power(film, "speed_exponent_mean")
    of_gap = float(film.get("speed_exponent_gap_mean", np.nan))
    if np.isfinite(of_gap) and not np.isfinite(float(film.speed_exponent_mean)):
        mean = f"of the gap {_power(film, 'speed_exponent_gap_mean')}"
    if shows_plateau(film) and "speed_exponent_central" in film:
        return f"minimum {minimum}, central {_power(film, 'speed_exponent_central')}"
    return f"minimum {minimum}, mean {mean}"


def _power(film: xr.Dataset, name: str) -> str:
    """A fitted power with its standard deviation, in words where either is not known."""
    value, std = float(film[name]), float(film[f"{name}_std"])
    if not np.isfinite(value):
        return "not determined"
    return f"n = {value:.3f} ± {std:.3f}" if np.isfinite(std) else f"n = {value:.3f}, error unknown"


# film against theory and speed

# Rank, logarithms, and the ends of their interval.
_CORRELATION = [f"speed_correlation{part}" for part in ("_rank", "", "_low", "_high")]

_OTHERS = {
    "film_over_theory": "regime map",
    "film_central_over_theory": "central film, regime map",
    "film_over_predicted": "transient film, start fitted",
    "film_gap_mean_over_predicted": "mean of the gap over that of the transient film",
}


def describe_theory(film: xr.Dataset) -> str:
    """Predicted film at the highest speed, and the reason for the regime."""
    theory = applicable_theory(film)
    if theory is None or "film_hamrock_dowson" not in film:
        return ""
    # hydrodynamic theory is closest to its assumptions where the speed is highest
    top = int(np.argmax(film.sliding_speed.values))
    speed, load = float(film.sliding_speed[top]), float(film["joint_load"][top])
    formula = float(film.film_hamrock_dowson[top])
    return (
        f"{float(theory[top]):.3g} um, {theory.attrs['regime']} ({speed:.3f} m/s, "
        f"{load:.0f} N); {formula_label(film)}: {formula:.3g} um\n"
        f"{theory.attrs['reason']}"
    )


def describe_friction(film: xr.Dataset) -> str:
    """Friction torque and coefficient of the film of the whole joint, and of the logged torque."""
    if "friction_torque" not in film:
        return ""
    top = film.isel(trigger=fastest_trigger(film))
    torque, std = float(top.friction_torque), float(top.friction_torque_std)
    digits = decimals(std, 2)
    text = (
        f"{torque:.{digits}f} ± {std:.{digits}f} N m at the viscosity of [oil], "
        f"coefficient {top.friction_coefficient:.3g}"
    )
    rest = top.get("torque_not_film")
    return text if rest is None else f"{text}; logged {float(torque + rest):.{digits}f} N m"


def describe_factor(film: xr.Dataset) -> str:
    """Film over Hamrock-Dowson: median, errors, range, strokes, and the viscosity it would take.

    Empty where the film has no such ratio.
    """
    attrs = film["film_over_hamrock_dowson"].attrs if "film_over_hamrock_dowson" in film else {}
    if not np.isfinite(attrs.get("factor", np.nan)):
        return ""
    value, random, shared = (attrs[f"factor{part}"] for part in ("", "_std_random", "_std_shared"))
    digits = decimals(np.hypot(random, shared), 2)
    low, high = (f"{attrs[key]:.3g}" for key in ("low", "high"))
    outward, back = (f"{attrs[key]:.3g}" for key in ("outward", "back"))
    strokes = "" if "nan" in (outward, back) else f", out {outward}, back {back}"
    return (
        f"{value:.{digits}f} ± {random:.{digits}f} ± {shared:.{digits}f} × "
        f"{formula_label(film)}{_describe_error(attrs)}; {low} to {high}{strokes}"
        f"{_describe_viscosity(attrs)}{_describe_map(film, attrs)}"
    )


def _describe_map(film: xr.Dataset, attrs: Mapping[str, float]) -> str:
    """Factor over the regime map where the formula does not hold, and that at the centre."""
    minimum, central = (
        film[name].attrs["factor"] if name in film else np.nan
        for name in ("film_over_theory", "film_central_over_theory")
    )
    parts = [f"{minimum:.3g}"] if formula_scope(attrs) and np.isfinite(minimum) else []
    if shows_plateau(film) and np.isfinite(central):
        parts.append(f"h_c {central:.3g}")
    return f"; {', '.join(parts)} × regime map" if parts else ""


def _describe_error(attrs: Mapping[str, Any]) -> str:
    """Error of a formula itself, or that it does not hold; empty where it is not known."""
    if scope := formula_scope(attrs):
        return f", {scope}"
    error = attrs.get("formula_error", np.nan)
    return f" ± {100 * error:.0f} %" if np.isfinite(error) else ""


def _describe_viscosity(attrs: Mapping[str, float]) -> str:
    """Viscosity that makes a factor 1, beside that of [oil]; empty where it is not known.

    Its error contains that of the formula; outside the regime of the formula there is none.
    """
    viscosity, std = attrs.get("viscosity", np.nan), attrs.get("viscosity_std", np.nan)
    std = np.hypot(std, attrs.get("viscosity_std_formula", 0.0))
    if not np.isfinite([viscosity, std]).all() or formula_scope(attrs):
        return ""
    given, digits = attrs["viscosity_given"], decimals(std, 1)
    oil = f"oil {given:.{max(digits, decimals(given, 2))}f}"
    return f"; takes {viscosity:.{digits}f} ± {std:.{digits}f}, {oil} Pa s"


def describe_other_factors(film: xr.Dataset) -> str:
    """Film over the regime map and over the transient film, each with its viscosity."""
    texts = []
    for name, title in _OTHERS.items():
        shown = name in film and (name != "film_central_over_theory" or shows_plateau(film))
        attrs = film[name].attrs if shown else {}
        if np.isfinite(attrs.get("factor", np.nan)):
            std = np.hypot(attrs["factor_std_random"], attrs["factor_std_shared"])
            digits = decimals(std, 2)
            number = f"{attrs['factor']:.{digits}f} ± {std:.{digits}f}"
            span = f"{attrs['low']:.3g} to {attrs['high']:.3g}"
            of = f"{title}{_describe_error(attrs)}"
            texts.append(f"{of}: {number}, {span}{_describe_viscosity(attrs)}")
    return "\n".join(texts)


def describe_following(film: xr.Dataset) -> str:
    """Correlation of the films with |speed|; empty where none is known."""
    if "speed_correlation" not in film:
        return ""
    rank, log, low, high = (float(film[name][0, 0]) for name in _CORRELATION)
    if not np.isfinite(log):
        return ""
    text = f"correlation {log:+.2f} ({low:+.2f} to {high:+.2f}), rank {rank:+.2f}"
    mean = float(film.speed_correlation[1, 0])
    return text + (f"; of the mean {mean:+.2f}" if np.isfinite(mean) else "")


def describe_delay(film: xr.Dataset) -> str:
    """Delay of the minimum behind the speed, in degrees of the drive; empty where not known."""
    delay = float(film.get("speed_delay", np.nan))
    if not np.isfinite(delay):
        return ""
    std, side = float(film.speed_delay_std), "late" if delay > 0 else "early"
    digits = decimals(std, 2)
    return f"{abs(delay):.{digits}f} ± {std:.{digits}f}° {side}"


def describe_correlations(film: xr.Dataset) -> str:
    """Correlations of the films with speed and with speed over load, a line each."""
    if "speed_correlation" not in film:
        return ""
    lines = []
    for j, against in enumerate(film.correlated_with.values):
        texts = []
        for k, name in enumerate(film.correlated_film.values):
            rank, log, low, high = (float(film[one][k, j]) for one in _CORRELATION)
            if np.isfinite(log):
                texts.append(f"{name} {log:+.2f} ({low:+.2f} to {high:+.2f}), rank {rank:+.2f}")
        lines += [f"{against}: " + "; ".join(texts)] if texts else []
    return "\n".join([*lines, *filter(None, [describe_delay(film)])])
