"""Errors of the films by source, as variables of the film and in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve
from erlif.core.arrays import Array
from erlif.core.statistics import covariance_root
from erlif.core.terms import SOURCES
from erlif.core.variables import FILM
from erlif.io.settings import RunSettings
from erlif.pipeline.physics.systematics import has_dry_joint
from erlif.trend import FilmStatistics


def describe_errors(statistics: Sequence[FilmStatistics], calibration: RunCurve) -> dict[str, Any]:
    """Errors of mean and minimum film by source, as variables of the film.

    Parameters
    ----------
    statistics : sequence of FilmStatistics
        Of the triggers.
    calibration : RunCurve
        With what the run shows of its systematics.

    Returns
    -------
    dict of str to variable
    """
    columns: dict[str, list[dict[str, float]]] = {"film_mean_error": [], "film_min_error": []}
    means = calibration.split_errors([one.mean.gradient for one in statistics])
    minima = calibration.split_errors([one.gap.minimum.gradient for one in statistics])
    for one, mean, minimum in zip(statistics, means, minima, strict=True):
        columns["film_mean_error"].append({"noise": one.mean.random_std, "marks": 0.0} | mean)
        surface, lowest = "form" if one.departs else "marks", one.gap.minimum
        noise = {"noise": lowest.random_std, surface: lowest.surface_std}
        columns["film_min_error"].append(noise | minimum)

    known = {term for rows in columns.values() for row in rows for term in row}
    # those of the run, then those of the fixture
    terms = sorted(
        (key for key in SOURCES if key in known), key=lambda key: SOURCES[key].file == "fixture"
    )
    values: dict[str, Any] = {"error_term": np.array(terms)}
    for name, rows in columns.items():
        whole = np.array([[row.get(term, 0.0) for row in rows] for term in terms])
        values[name] = np.where(np.isnan(whole).any(axis=0), np.nan, whole)  # no film, no error
    return {name: FILM[name].fill(column) for name, column in values.items()}


def shared_errors(statistics: Sequence[FilmStatistics], calibration: RunCurve) -> Array:
    """Change of the minima with one standard deviation of each error that all triggers share.

    Parameters
    ----------
    statistics, calibration
        As for `describe_errors`.

    Returns
    -------
    array, (trigger, source)
        The surfaces last, whose marks are the same at every trigger: the median of their sizes,
        each of which is an estimate of its own. [um]
    """
    minima = [one.gap.minimum for one in statistics]
    gradient = np.array([one.gradient for one in minima])
    by_fixture = gradient @ covariance_root(calibration.full_covariance)
    surfaces = np.array([one.surface_std for one in minima])
    known = surfaces[np.isfinite(surfaces)]
    surface = np.median(known) if known.size else np.nan  # no film has a minimum
    return np.column_stack([by_fixture, np.full(len(minima), surface)])


def name_largest_error(
    film: xr.Dataset, settings: RunSettings, before: RunCurve, after: RunCurve
) -> str:
    """The largest error of the median mean film, its size, where it comes from and what lowers it.

    Parameters
    ----------
    film : xarray.Dataset
        With the variables of `describe_errors`.
    settings : RunSettings
    before, after : RunCurve
        With the systematics of the settings, and with those that the run shows.

    Returns
    -------
    str
        Empty where no trigger has a mean film.
    """
    known = np.flatnonzero(np.isfinite(film.film_mean.values))
    if not known.size:
        return ""
    trigger = known[np.argsort(film.film_mean.values[known])[known.size // 2]]
    errors = film.film_mean_error.values[:, trigger]
    term = str(film.error_term.values[int(np.argmax(errors))])
    dry = term == "background" and has_dry_joint(settings)
    followed = term == "temperature" and settings.temperature.coefficient is not None
    on_patch = term == "ratio" and settings.light.ratio == "correct"
    key = "energy" if dry else "followed" if followed else "patch" if on_patch else term
    source = _source_of(term, key, settings, before, after)
    size = f"{1e3 * errors.max():.0f} nm at {float(film.film_mean[trigger]):.2g} um"
    return f"{size}: {SOURCES[key].what}. {source}{SOURCES[key].cure}"


def _source_of(
    term: str, key: str, settings: RunSettings, before: RunCurve, after: RunCurve
) -> str:
    """State whether the width of a term was measured, declared by a key, or is the default.

    Empty for what is no error of the run: fixture.toml states those of the fixture.
    """
    if SOURCES[key].file != "run":
        return ""
    changed = not np.array_equal(_covariance_of(term, before), _covariance_of(term, after))
    if after.follows_run or changed:
        return "As the run shows it. "
    stated = key in settings.systematics.model_fields_set
    return "As stated in [systematics]. " if stated else "Not stated in [systematics]. "


def _covariance_of(term: str, calibration: RunCurve) -> Array:
    """Covariance of the parameters of a term, empty where it has none."""
    systematics = calibration.systematics
    own = systematics.places(term)
    return systematics.covariance[np.ix_(own, own)]
