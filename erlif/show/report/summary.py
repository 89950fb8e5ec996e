"""A film in a few lines for the terminal."""

from __future__ import annotations

import textwrap

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.flags import Flag, describe_share
from erlif.core.notes import Level, split_notes
from erlif.core.units import count_of
from erlif.io.files import flag_shares, shows_plateau, takes
from erlif.show.report.agreement import (
    describe_correlations,
    describe_delay,
    describe_factor,
    describe_following,
    describe_friction,
    describe_other_factors,
    describe_theory,
)
from erlif.show.report.layout import print_rows
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
