"""Film against theory and speed in lines: films, factors, viscosities, correlations, friction."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from erlif.io.files import (
    applicable_theory,
    fastest_trigger,
    formula_label,
    formula_scope,
    shows_plateau,
)
from erlif.show.report.layout import decimals

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
    text, mean = _describe_correlation(film, 0, 0), float(film.speed_correlation[1, 0])
    if not text:
        return ""
    return f"correlation {text}" + (f"; of the mean {mean:+.2f}" if np.isfinite(mean) else "")


def _describe_correlation(film: xr.Dataset, k: int, j: int) -> str:
    """Correlation of film k with speed j, its interval and that of the ranks; empty if unknown."""
    rank, log, low, high = (float(film[name][k, j]) for name in _CORRELATION)
    return f"{log:+.2f} ({low:+.2f} to {high:+.2f}), rank {rank:+.2f}" if np.isfinite(log) else ""


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
            if text := _describe_correlation(film, k, j):
                texts.append(f"{name} {text}")
        lines += [f"{against}: " + "; ".join(texts)] if texts else []
    return "\n".join([*lines, *filter(None, [describe_delay(film)])])
