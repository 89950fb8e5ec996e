"""A film or a calibration in a few lines for the terminal."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.flags import Flag, describe_share
from erlif.core.notes import rank_notes
from erlif.core.units import count_of
from erlif.io.files import flag_shares, takes
from erlif.show.report.prediction import correlation_lines, difference_lines

_TITLE = 28  # columns of the titles of a film
_CALIBRATION_TITLE = 34  # columns of the titles of a calibration
_NOTABLE = 0.01  # share of the region beyond the range from which a mean is that of a part
_AT = (0.1, 0.5)  # places in the calibrated range whose uncertainty is printed


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
        Several lines.

    Examples
    --------
    The minimum film thickness of this film follows the speed to the power of 0.6:

    >>> from erlif.show.plots import example_film
    >>> lines = summarise(example_film()).splitlines()
    >>> lines[0]
    'example: 6 triggers from 6 frame pairs of 64 x 24 pixels'
    >>> print(*[line for line in lines if "n =" in line], sep="\\n")
      power of speed over load    minimum: n = 0.600 ± 0.010, mean: n = 0.600 ± 0.010; 6 triggers
    """
    name = str(film.attrs["title"]).removeprefix("oil-film thickness, ")
    lines = [
        f"{name}: {count_of(film.sizes['trigger'], 'trigger')} from "
        f"{count_of(int(film.frames_used.sum()), 'frame pair')} of {film.sizes['x']} x "
        f"{film.sizes['y']} pixels",
        _film_line(film, "film_min", "minimum film thickness"),
        _film_line(film, "film_mean", "mean film thickness"),
        *_pin_lines(film),
        *_flag_lines(film),
        *_trend_lines(film),
        *_theory_lines(film),
        *difference_lines(film),
        *correlation_lines(film),
    ]
    if "physics" in film.attrs:
        lines.append(_line("what carries the film", str(film.attrs["physics"])))
    notes = [note for note in str(film.attrs.get("notes", "")).split("\n") if note]
    lines += [_line("notes" if n == 0 else "", note) for n, note in enumerate(notes)]
    return "\n".join(lines)


def summarise_in_a_line(film: xr.Dataset) -> str:
    """Describe a film in one line, for a list of many.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it; its maps are not read.

    Returns
    -------
    str
        Range of the minimum film thickness over the cycle, speed exponent where the film has a
        speed and a load, triggers, frame pairs.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> summarise_in_a_line(example_film())
    'minimum film thickness 2.51 to 3.49 um, n = 0.600 ± 0.010, 6 triggers from 6 frame pairs'
    """
    minimum = film.film_min.values
    thickness = "no film"
    if np.isfinite(minimum).any():
        thickness = f"{np.nanmin(minimum):.2f} to {np.nanmax(minimum):.2f} um"
    trend = ""
    if "speed_exponent" in film:
        fitted = np.isfinite(float(film.speed_exponent))
        trend = f"{_power(film, 'speed_exponent') if fitted else 'n = not fitted'}, "
    return (
        f"minimum film thickness {thickness}, {trend}{film.sizes['trigger']} triggers "
        f"from {int(film.frames_used.sum())} frame pairs"
    )


def _line(title: str, text: str, width: int = _TITLE) -> str:
    return f"  {title:{width}s}{text}"


def _pin_lines(film: xr.Dataset) -> list[str]:
    """Range of the displacement of the pin, with the largest standard deviation of each."""
    if "pin_displacement" not in film or not np.isfinite(film.pin_displacement.values).any():
        return []
    std = np.sqrt(np.diagonal(film.pin_position_cov.values, axis1=1, axis2=2))
    texts = [
        f"{np.nanmin(place):.2f} to {np.nanmax(place):.2f} ± {np.nanmax(error):.2f} um {where}"
        for place, error, where in zip(
            film.pin_displacement.values.T,
            std[:, :2].T,
            ("towards the load", "sideways"),
            strict=True,
        )
    ]
    return [_line("displacement of the pin", ", ".join(texts))]


def _film_line(film: xr.Dataset, variable: str, title: str) -> str:
    """Range of a statistic over the cycle, with the triggers of its ends."""
    values, std = film[variable].values, film[f"{variable}_std"].values
    if not np.isfinite(values).any():
        none = "none: no trigger has enough valid pixels in the region of interest"
        return _line(title, none)
    ends = [
        f"{values[k]:.2f} ± {std[k]:.2f} um (trigger {k}{_describe_part(film, variable, k)})"
        for k in (int(np.nanargmin(values)), int(np.nanargmax(values)))
    ]
    return _line(title, " to ".join(dict.fromkeys(ends)))  # one end of a single trigger


def _describe_part(film: xr.Dataset, variable: str, trigger: int) -> str:
    """Part of the region that a mean was taken over, where the rest is beyond the range."""
    if variable != "film_mean" or "share_beyond_range" not in film:
        return ""
    share = float(film.share_beyond_range.values[trigger])
    if not share > _NOTABLE:
        return ""
    return f", over the {1 - share:.0%} of the region within the calibrated range"


def _flag_lines(film: xr.Dataset) -> list[str]:
    """Share of valid pixels, and of each flag that occurs."""
    valid, *flagged = flag_shares(film).mean(axis=0)
    shares = [
        f"{str(flag.name).lower()} {describe_share(float(share), '%')}"
        for flag, share in zip(Flag, flagged, strict=True)
        if share
    ]
    return [
        _line("valid pixels", f"{valid:.1%}"),
        _line("flagged pixels", ", ".join(shares) or "none"),
    ]


def _trend_lines(film: xr.Dataset) -> list[str]:
    """Fitted powers of speed over load."""
    if "speed_exponent" not in film:
        return []
    title, exponent = "power of speed over load", film.speed_exponent
    if not np.isfinite(float(exponent)):
        used, all_of = int(exponent.attrs.get("triggers_used", 0)), film.sizes["trigger"]
        reason = (
            f"not fitted: it takes five triggers of differing speed over load; {used} of {all_of} "
            "can be used"
        )
        return [_line(title, reason)]
    minimum, mean = _power(film, "speed_exponent"), _power(film, "speed_exponent_mean")
    used = exponent.attrs["triggers_used"]
    return [_line(title, f"minimum: {minimum}, mean: {mean}; {used} triggers")]


def _power(film: xr.Dataset, name: str) -> str:
    """A fitted power with its standard deviation, in words where either is not known."""
    value, std = float(film[name]), float(film[f"{name}_std"])
    if not np.isfinite(value):
        return "not fitted"
    return f"n = {value:.3f} ± {std:.3f}" if np.isfinite(std) else f"n = {value:.3f}, error unknown"


def _theory_lines(film: xr.Dataset) -> list[str]:
    """Predicted film at the highest speed, and the reason for the regime."""
    if "film_theory" not in film:
        return []
    theory = film.film_theory
    # hydrodynamic theory is closest to its assumptions where the speed is highest
    top = int(np.argmax(film.sliding_speed.values))
    speed, load = float(film.sliding_speed[top]), float(film["load"][top])
    formula = float(film.film_hamrock_dowson[top])
    return [
        _line(
            "theory at the highest speed",
            f"{float(theory[top]):.3g} um, {theory.attrs['regime']} ({speed:.3f} m/s, "
            f"{load:.0f} N); 2.65 line-contact formula: {formula:.3g} um",
        ),
        _line("", str(theory.attrs["reason"])),
    ]


def describe_calibration(calibration: Calibration) -> str:
    """Describe a calibration: parameters with standard deviations, calibrated range and notes.

    Parameters
    ----------
    calibration : Calibration
        From `erlif.calibrate` or `erlif.open_calibration`.

    Returns
    -------
    str
        Several lines.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> print(*describe_calibration(example_calibration()).splitlines()[:3], sep="\\n")
    example wedge: ratio camera 2 / camera 1 against thickness, 20 points
      K, ratio of a vanishing film      0.66000 ± 0.00100
      p, attenuation camera 1 [1/um]    0.39000 ± 0.00200
    """
    points = calibration.curve.sizes["bin"]
    lines = [f"{calibration.fixture}: ratio camera 2 / camera 1 against thickness, {points} points"]

    def add(title: str, text: str) -> None:
        lines.append(_line(title, text, _CALIBRATION_TITLE))

    names = (
        "K, ratio of a vanishing film",
        "p, attenuation camera 1 [1/um]",
        "q, attenuation camera 2 [1/um]",
    )
    stds = calibration.standard_deviations
    for name, value, std in zip(names, calibration.parameters, stds, strict=True):
        add(name, f"{value:.5f} ± {std:.5f}")

    low, high = calibration.thickness_range
    add("calibrated range", f"{low:.2f} to {high:.2f} um")
    # the calibration shifts all pixels alike, which no average reduces
    places = np.array([low + share * (high - low) for share in _AT])
    errors = calibration.thickness_std(places)
    shares = [f"{100 * e / t:.2f} % at {t:.1f} um" for t, e in zip(places, errors, strict=True)]
    add("error shared by all pixels", ", ".join(shares))
    add("reduced chi-square", f"{calibration.reduced_chi_square:.2f}")

    if calibration.departure is not None:
        film = np.linspace(low, high, 501)
        share = 100 * np.expm1(calibration.departure.predict(film))
        text = f"{share.min():+.2f} to {share.max():+.2f} % of the ratio, followed by a spline"
        add("departure from the model", text)
    lines += [f"  {note.level.value}: {note}" for note in rank_notes(calibration.notes)]
    return "\n".join(lines)
