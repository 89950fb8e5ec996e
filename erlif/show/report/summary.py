"""A film or a calibration in a few lines for the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping

import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.arrays import Array
from erlif.core.flags import Flag, describe_share
from erlif.core.notes import Level, rank_notes, split_notes
from erlif.core.units import count_of
from erlif.io.files import (
    applicable_theory,
    fastest_trigger,
    flag_shares,
    formula_label,
    takes,
)
from erlif.show.report.layout import TABLES, decimals, print_columns, print_rows
from erlif.show.report.prediction import describe_difference
from erlif.trend import LEAST_TRIGGERS

_CALIBRATION_TITLE = 34  # columns of the titles of a calibration
_TITLE = 10  # columns of the titles of a short summary
_COLUMNS = 80
_NOTABLE = 0.01  # share of the region beyond the range from which a mean is that of a part
_WHOLE = ("formula", "speed")  # rows of which a short summary has every sentence
_AT = (0.1, 0.5)  # places in the calibrated range whose uncertainty is printed

# Rank, logarithms, and the ends of their interval.
_CORRELATION = [f"speed_correlation{part}" for part in ("_rank", "", "_low", "_high")]

_OTHERS = {"film_over_theory": "regime map", "film_over_predicted": "transient film"}


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
    """Range of the minimum and of the mean over the cycle."""
    ranges = []
    for name in ("film_min", "film_mean"):
        ends = _ends(film, name)
        digits = 2 if ends and ends[-1][1] < 10 else 1  # four numbers fit a line
        texts = [f"{value:.{digits}f} ± {std:.{digits}f}" for _, value, std in ends]
        ranges.append(" to ".join(texts) or "none")
    if ranges == ["none", "none"]:
        return "none: no trigger has enough valid pixels in the region"
    return f"min {ranges[0]}, mean {ranges[1]} um"


def describe_film(film: xr.Dataset, shares: Array) -> dict[str, str]:
    """Describe a film row by row, for the terminal and for the report."""
    warned, noted = _split_notes(film)
    # the order is that of reading: what is wrong, films, what limits and moves them, remarks
    rows = {
        "warnings": warned,
        "minimum film thickness": _describe_statistic(film, "film_min"),
        "mean film thickness": _describe_statistic(film, "film_mean"),
        "largest error": str(film.attrs.get("largest_error", "")),
        "displacement of the pin": _describe_pin(film),
        "valid pixels": f"{shares[:, 0].mean():.1%}",
        "flagged pixels": ", ".join(_list_flags(shares)) or "none",
        "power of speed over load": _describe_trend(film),
        "theory at the top speed": _describe_theory(film),
        "measured less predicted": describe_difference(film),
        "film over Hamrock-Dowson": describe_factor(film),
        "film over other theory": describe_other_factors(film),
        "correlation with the speed": describe_correlations(film),
        "friction at the top speed": _describe_friction(film),
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
    return f"minimum {minimum}, mean {mean}"


def _power(film: xr.Dataset, name: str) -> str:
    """A fitted power with its standard deviation, in words where either is not known."""
    value, std = float(film[name]), float(film[f"{name}_std"])
    if not np.isfinite(value):
        return "not determined"
    return f"n = {value:.3f} ± {std:.3f}" if np.isfinite(std) else f"n = {value:.3f}, error unknown"


def _describe_theory(film: xr.Dataset) -> str:
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


def _describe_friction(film: xr.Dataset) -> str:
    """Friction torque and coefficient of the film of the whole joint, and of the logged torque."""
    if "friction_torque" not in film:
        return ""
    top = film.isel(trigger=fastest_trigger(film))
    torque, std = float(top.friction_torque), float(top.friction_torque_std)
    digits = decimals(std, 2)
    text = f"{torque:.{digits}f} ± {std:.{digits}f} N m, coefficient {top.friction_coefficient:.3g}"
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
        f"{formula_label(film)}; {low} to {high}{strokes}{_describe_viscosity(attrs)}"
    )


def _describe_viscosity(attrs: Mapping[str, float]) -> str:
    """Viscosity that makes a factor 1, beside that of [oil]; empty where it is not known."""
    viscosity, std = attrs.get("viscosity", np.nan), attrs.get("viscosity_std", np.nan)
    if not np.isfinite([viscosity, std]).all():
        return ""
    digits = decimals(std, 1)
    takes = f"{viscosity:.{digits}f} ± {std:.{digits}f}"
    return f"; takes {takes} of {attrs['viscosity_given']:.2g} Pa s"


def describe_other_factors(film: xr.Dataset) -> str:
    """Film over the regime map and over the transient film, each with its viscosity."""
    texts = []
    for name, title in _OTHERS.items():
        attrs = film[name].attrs if name in film else {}
        if np.isfinite(attrs.get("factor", np.nan)):
            std = np.hypot(attrs["factor_std_random"], attrs["factor_std_shared"])
            digits = decimals(std, 2)
            number = f"{attrs['factor']:.{digits}f} ± {std:.{digits}f}"
            span = f"{attrs['low']:.3g} to {attrs['high']:.3g}"
            texts.append(f"{title}: {number}, {span}{_describe_viscosity(attrs)}")
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
    side = "late" if delay > 0 else "early"
    return f"{abs(delay):.0f} ± {float(film.speed_delay_std):.0f}° {side}"


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


def describe_calibration(calibration: Calibration, *, brief: bool = False) -> str:
    """Describe a calibration: parameters with standard deviations, calibrated range and notes.

    Parameters
    ----------
    calibration : Calibration
        From `erlif.calibrate` or `erlif.open_calibration`.
    brief : bool
        Count the notes that are no warnings.

    Returns
    -------
    str
        Fixture and points; parameters, range and errors; the notes, each on its line.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> print(*describe_calibration(example_calibration()).splitlines()[:3], sep="\\n")
    example wedge: ratio camera 2 / camera 1 against thickness, 20 points
      K, ratio of a vanishing film      0.66000 ± 0.00100
      p, attenuation camera 1 [1/um]    0.39000 ± 0.00200
    """
    points = calibration.curve.sizes["bin"]
    names = TABLES["summary"]["calibration"]
    stds = calibration.standard_deviations
    rows = {
        name: f"{value:.5f} ± {std:.5f}"
        for name, value, std in zip(names, calibration.parameters, stds, strict=False)
    }

    low, high = calibration.thickness_range
    rows["calibrated range"] = f"{low:.2f} to {high:.2f} um"
    # the calibration shifts all pixels alike, which no average reduces
    places = np.array([low + share * (high - low) for share in _AT])
    errors = calibration.thickness_std(places)
    shares = [f"{100 * e / t:.2f} % at {t:.1f} um" for t, e in zip(places, errors, strict=True)]
    rows["error shared by all pixels"] = ", ".join(shares)
    rows["reduced chi-square"] = f"{calibration.reduced_chi_square:.2f}"

    if calibration.departure is not None:
        film = np.linspace(low, high, 501)
        share = 100 * np.expm1(calibration.departure.predict(film))
        text = f"{share.min():+.2f} to {share.max():+.2f} % of the ratio, followed by a spline"
        rows["departure from the model"] = text
    head = f"{calibration.fixture}: ratio camera 2 / camera 1 against thickness, {points} points"
    ranked = rank_notes(calibration.notes)
    shown = [note for note in ranked if not brief or note.level is not Level.NOTE]
    notes = [f"  {note.level.value}: {note}" for note in shown]
    if left := len(ranked) - len(shown):
        rows["more"] = f"{count_of(left, 'note')}: -v"
    return "\n".join([print_rows(head, rows, width=_CALIBRATION_TITLE), *notes])


def print_budget(budget: xr.Dataset) -> str:
    """Write a budget as a table for the terminal, in nanometres, by kinds of error.

    Parameters
    ----------
    budget : xarray.Dataset
        From `erlif.budget`: std (term, quantity) [um], kind (term), value (quantity) [um].

    Returns
    -------
    str
        One row a term; the sum of a kind stands below its terms.

    Examples
    --------
    >>> budget = xr.Dataset(
    ...     {
    ...         "std": (("term", "quantity"), [[0.0123], [0.0123]]),
    ...         "kind": ("term", ["random", "sum"]),
    ...         "value": ("quantity", [5.0]),
    ...     },
    ...     {"term": ["photons", "total"], "quantity": ["mean film"]},
    ...     {"run": "example", "trigger": 2, "frames": 1},
    ... )
    >>> print(print_budget(budget))
    Standard deviations in nm: example, trigger 2, 1 frame pair
    <BLANKLINE>
    term                 mean
    film thickness [um]  5.00
    random
      photons              12
    total                  12
    """
    attrs, titles = budget.attrs, [str(title) for title in budget.quantity.values]
    short = [title.removeprefix("pixel of ").removesuffix(" film") for title in titles]
    films = (f"{value:.2f}" for value in budget["value"].values)
    rows, last = [("term", *short), ("film thickness [um]", *films)], ""
    columns = budget.term.values, budget["std"].values, budget.kind.values
    for term, stds, kind in zip(*columns, strict=True):
        if kind not in (last, "sum"):
            rows.append((str(kind), *[""] * len(titles)))
        last = kind
        rows.append((f"{'' if kind == 'sum' else '  '}{term}", *map(_in_nanometres, stds)))
    below = ["", "Columns with a film in um: a single pixel of this film."]
    pixels = any(title.startswith("pixel of ") for title in titles)
    count = count_of(int(attrs["frames"]), "frame pair")
    head = f"Standard deviations in nm: {attrs['run']}, trigger {attrs['trigger']}, {count}"
    table = print_columns(rows, "<" + ">" * len(titles))
    return "\n".join([head, "", table, *(below if pixels else [])])


def _in_nanometres(value: float) -> str:
    """Write a value [um] in nm with two digits at least; a dash where the term does not enter."""
    if np.isnan(value):
        return "-"
    nanometres = 1000 * value
    return f"{nanometres:.1f}" if nanometres < 10 else f"{nanometres:.0f}"
