"""Film against speed and theory: ratios to the formulas, correlation and delay, as variables."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import scipy
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.variables import FILM
from erlif.io.settings import RunSettings
from erlif.pipeline.physics.exponents import speed_of_trend
from erlif.pipeline.physics.joint import describe_contact
from erlif.trend import (
    LARGEST_BEYOND,
    LubricatedContact,
    VogelLaw,
    correlate,
    fast_triggers,
    film_factor,
    find_delay,
    viscosity_at,
)

# Ratios, the film of each, and the theory that it is over.
_RATIOS = {
    "film_over_hamrock_dowson": ("film_min", "film_hamrock_dowson"),
    "film_over_theory": ("film_min", "film_theory"),
    "film_central_over_theory": ("film_central", "film_theory_central"),
    "film_over_predicted": ("film_min", "film_predicted_min"),
    "film_gap_mean_over_predicted": ("film_gap_mean", "film_predicted_mean"),
}
_WIDEST = 7.0  # largest logarithm of the viscosity that a film would take over that of [oil]
_STEP = 0.01  # of this logarithm, for a derivative


def describe_agreement(film: xr.Dataset, settings: RunSettings) -> dict[str, Any]:
    """Ratios of the minimum film to theory, and its correlation with the speed.

    Parameters
    ----------
    film : xarray.Dataset
        With films, theory, speed and load (trigger), as far as they are known.
    settings : RunSettings

    Returns
    -------
    dict of str to variable
        Empty without a speed.
    """
    name = speed_of_trend(film)
    if name not in film:
        return {}
    return _compare_with_theories(film, settings, name) | _follow_speed(film, name)


def _compare_with_theories(film: xr.Dataset, settings: RunSettings, speed: str) -> dict[str, Any]:
    """Ratios of the films to those of theory that there are."""
    fast = fast_triggers(film[speed].values)
    stroke = film.stroke.values if "stroke" in film else None
    contact = describe_contact(settings)
    ratios: dict[str, Any] = {}
    for name, (measured, theory) in _RATIOS.items():
        if theory not in film or measured not in film:
            continue
        expected = np.where(fast & (film[theory].values > 0), film[theory].values, np.nan)
        ratio, std, random = (
            film[one].values / expected
            for one in (measured, f"{measured}_std", f"{measured}_std_random")
        )
        factor = film_factor(ratio, random, std, stroke=stroke)
        attrs = {
            "factor": factor.value,
            "factor_std_random": factor.std_random,
            "factor_std_shared": factor.std_shared,
            **{key: getattr(factor, key) for key in ("low", "high", "outward", "back")},
        }
        if contact is not None and "predicted" not in theory:
            error = film[theory].attrs.get("formula_error", math.nan)
            attrs |= {"formula_error": error}
            if "formula_of" in film[theory].attrs:
                attrs |= {"formula_of": film[theory].attrs["formula_of"]}
            names = measured, theory, speed
            attrs |= _match_viscosity(film, contact, *names, factor.std, error)
        ratios[name] = FILM[name].fill(ratio, **attrs)
        ratios[f"{name}_std"] = FILM[f"{name}_std"].fill(std)
        ratios[f"{name}_std_random"] = FILM[f"{name}_std_random"].fill(random)
    return ratios


def _match_viscosity(
    film: xr.Dataset,
    contact: LubricatedContact,
    name: str,
    theory: str,
    speed: str,
    factor_std: float,
    formula_error: float,
) -> dict[str, float]:
    """Viscosity with which the median of the film over a theory is 1, beside that of [oil]."""
    fast = fast_triggers(film[speed].values)
    given = float(np.median(viscosity_at(film, contact.viscosity)[fast]))
    measured = film[name].values

    def factor(log: float) -> float:
        """Median factor at a viscosity times exp(log)."""
        expected = _with_viscosity(film, contact, math.exp(log))[theory]
        ratio = measured[fast] / np.where(expected[fast] > 0, expected[fast], np.nan)
        return float(np.nanmedian(ratio)) if np.isfinite(ratio).any() else math.nan

    ends = factor(-_WIDEST), factor(_WIDEST)
    unknown = dict.fromkeys(("viscosity", "viscosity_std", "viscosity_std_formula"), math.nan)
    found = unknown | {"viscosity_given": given}
    if ends[0] > 1 > ends[1] > 0:
        log = float(
            scipy.optimize.brentq(lambda one: math.log(factor(one)), -_WIDEST, _WIDEST, xtol=1e-4)
        )
        power = math.log(factor(log - _STEP) / factor(log + _STEP)) / (2 * _STEP)
        viscosity = given * math.exp(log)
        # a relative error of the factor, which is 1 here
        relative = factor_std / factor(0.0) / power
        found |= {"viscosity": viscosity, "viscosity_std": viscosity * relative}
        found["viscosity_std_formula"] = viscosity * formula_error / power
    return found


def _with_viscosity(film: xr.Dataset, contact: LubricatedContact, times: float) -> dict[str, Array]:
    """Steady films at a multiple of the viscosity. [um]"""
    one = contact.viscosity
    thicker = replace(one, a=times * one.a) if isinstance(one, VogelLaw) else times * one
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of ranges; the film has them as notes
        found = contact.films(
            film.sliding_speed.values, film["joint_load"].values, viscosity_at(film, thicker)
        )
    films = found.piezoviscous_elastic, found.film, found.central
    names = "film_hamrock_dowson", "film_theory", "film_theory_central"
    return {name: 1e6 * np.asarray(each) for name, each in zip(names, films, strict=True)}


def viscosity_powers(
    film: xr.Dataset, contact: LubricatedContact, names: Iterable[str]
) -> dict[str, float]:
    """Powers of the viscosity that steady films follow at the triggers, medians.

    Parameters
    ----------
    film : xarray.Dataset
        With these films, speed and load (trigger).
    contact : LubricatedContact
    names : iterable of str
        Variables of the films.

    Returns
    -------
    dict of str to float
        [1]
    """
    thicker = _with_viscosity(film, contact, math.exp(_STEP))
    with np.errstate(divide="ignore", invalid="ignore"):  # a surface at rest has no film
        ratios = {name: thicker[name] / film[name].values for name in names}
    return {name: float(np.log(np.nanmedian(one))) / _STEP for name, one in ratios.items()}


def _follow_speed(film: xr.Dataset, name: str) -> dict[str, Any]:
    """Correlation of the films with the speed, and the delay of the minimum behind it."""
    speed = film[name].values
    against = {"speed": speed}
    if "joint_load" in film:
        against["speed over load"] = speed / film["joint_load"].values
    part = film.share_beyond_range.values > LARGEST_BEYOND
    moved = "geometric" in film.get("speed_exponent_mean", xr.DataArray()).attrs
    names = ("film_min", "film_mean", "film_gap_mean")
    rows = []
    for one in names:
        values = np.where((part | moved) & (one == "film_mean"), np.nan, film[one].values)
        random = film[f"{one}_std_random"].values
        rows.append([correlate(values, random, each) for each in against.values()])

    found: dict[str, Any] = {
        "correlated_film": FILM["correlated_film"].fill(np.array(names)),
        "correlated_with": FILM["correlated_with"].fill(np.array(list(against))),
    }
    table = np.array(rows)
    for k, variable in enumerate(("rank", "", "low", "high")):
        full = "_".join(filter(None, ("speed_correlation", variable)))
        found[full] = FILM[full].fill(table[..., k], speed=name)
    if "crank_angle" in film:
        signed = (
            speed * film.stroke.values if name == "sliding_speed" and "stroke" in film else speed
        )
        delay, std = find_delay(film.film_min.values, signed, film.crank_angle.values)
        found["speed_delay"] = FILM["speed_delay"].fill(delay, speed=name)
        found["speed_delay_std"] = FILM["speed_delay_std"].fill(std)
    return found
