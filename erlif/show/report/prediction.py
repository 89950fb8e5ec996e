"""The predicted film in a few lines, beside the measured one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.prediction import Estimate, ModelComparison
from erlif.prediction.comparison import DESCRIBED
from erlif.show.report.layout import TABLES, print_rows
from erlif.trend import correlate


def describe_difference(film: xr.Dataset) -> str:
    """Mean and rms of the measured minimum less the predicted one; empty without either.

    The mean with a fitted start film is left out: the fit makes it small.
    """
    off = _differences(film)
    if not off.size:
        return ""
    rms = f"rms {np.sqrt(np.mean(off**2)):.3g} um"
    if _start_is_fitted(film):
        return f"{rms}, start film fitted"
    return f"mean {off.mean():+.3g} um, {rms}"


def _start_is_fitted(film: xr.Dataset) -> bool:
    """Whether the start film was fitted to the measured minima."""
    attrs = {**film.attrs, **film["film_predicted_min"].attrs}
    return bool(attrs.get("start_film_fitted", 0))


def _differences(film: xr.Dataset) -> Array:
    """Measured less predicted minimum where both are known; empty without either. [um]"""
    if "film_predicted_min" not in film or "film_min" not in film:
        return np.empty(0)
    off: Array = film["film_min"].values - film["film_predicted_min"].values
    known: Array = off[np.isfinite(off)]
    return known


def summarise_prediction(prediction: xr.Dataset) -> str:
    """Describe a prediction: range over the cycle, start film, comparison with the measured film.

    Parameters
    ----------
    prediction : xarray.Dataset
        From `erlif.predict`, with the measured film where there is one.

    Returns
    -------
    str
        A first line with model and triggers, then a title and its text on each line.

    Examples
    --------
    >>> attrs = {"title": "predicted oil-film thickness, test", "start_film_fitted": 0,
    ...          "model": "transient Reynolds, pin free sideways", "start_film": 5.0}
    >>> films = {"film_predicted_min": ("trigger", [5.0, 4.8, 4.7])}
    >>> print(summarise_prediction(xr.Dataset(films, attrs=attrs)))
    test: transient Reynolds, pin free sideways, 3 triggers
      predicted minimum film      4.7 to 5 um
      minimum at the first frame  5 um, as given
    """
    attrs, minimum = prediction.attrs, prediction["film_predicted_min"].values
    name = str(attrs["title"]).removeprefix("predicted oil-film thickness, ")
    rows = {"predicted minimum film": f"{minimum.min():.4g} to {minimum.max():.4g} um"}
    rows["its standard deviation"] = describe_band(prediction)
    if "film_min" in prediction and np.isfinite(prediction["film_min"].values).any():
        low, high = np.nanmin(prediction["film_min"]), np.nanmax(prediction["film_min"])
        rows["measured minimum film"] = f"{low:.4g} to {high:.4g} um"
    source = "fitted to the measured minima" if attrs["start_film_fitted"] else "as given"
    rows["minimum at the first frame"] = f"{attrs['start_film']:.4g} um, {source}"
    rows["measured less predicted"] = describe_difference(prediction)
    rows["correlation with |speed|"] = describe_correlation(prediction)
    return print_rows(f"{name}: {attrs['model']}, {minimum.size} triggers", rows)


def describe_band(prediction: xr.Dataset) -> str:
    """Largest standard deviation of the predicted minimum; empty where there is none."""
    std = prediction.get("film_predicted_min_std", xr.DataArray(np.nan)).values
    if not np.isfinite(std).any():
        return ""
    return f"± {np.nanmax(std):.2g} um at most: viscosity, load, clearance"


def describe_correlation(prediction: xr.Dataset) -> str:
    """Rank correlation of predicted and measured minimum with the size of the speed."""
    if "rocker_speed" not in prediction:
        return ""
    speed, texts = prediction["rocker_speed"].values, []
    # a run directory has a prediction without a measured film
    for name, title in (("film_min", "measured"), ("film_predicted_min", "predicted")):
        if name in prediction:
            film = prediction[name].values
            texts.append(f"{title} {correlate(film, 0 * film, speed).rank:+.2f}")
    return ", ".join(texts)


_SMALL_PART = 0.01  # of an error, below which one of its parts is not printed
_ALIKE = "load_line", "guided"  # what is fitted and not determined, and for which pin


def summarise_comparison(found: ModelComparison) -> str:
    """Describe a comparison: the verdict, the models in their order, and the best fit.

    Examples
    --------
    >>> from erlif.prediction import FilmModel
    >>> one = FilmModel("a guided pin", 0.0, 4, 1.0, 4e-8)
    >>> print(summarise_comparison(ModelComparison((one,), "It swings.", None)))
    It swings.
      model          BIC  residual [um]
      a guided pin   0    0.04
    """
    names = [*[one.name for one in found.candidates], *found.not_fitted]
    width = max(map(len, names)) + 3
    lines = [found.verdict, f"  {'model':{width}s}{'BIC':5s}residual [um]"]
    lines += [
        f"  {one.name:{width}s}{one.bic:<4.0f} {one.residual * 1e6:.3g}" for one in found.candidates
    ]
    lines += [f"  {name:{width}s}not fitted: {why}" for name, why in found.not_fitted.items()]
    # the numbers of a wrong model mean nothing
    if found.fit is not None and found.fit.inflation <= DESCRIBED:
        held = found.fit.sideways
        lines.append(f"  fitted: pin {held} sideways")
        # of a guided pin, that and the place at rest leave the same film but for a few errors
        fitted = {n: e for n, e in found.fit.estimates.items() if (n, held) != _ALIKE}
        for name, shown in TABLES["fitted"].items():
            if name in fitted:
                lines.append(f"    {shown['title']}: {_value(fitted[name], shown)}")
        lines += [f"  {note.level}: {note}" for note in found.fit.notes]
    return "\n".join(lines)


def _value(estimate: Estimate, shown: Mapping[str, Any]) -> str:
    """A value with its standard deviation and their parts, or the limit of the data."""
    one, unit = estimate.times(shown.get("factor", 1.0), shown["unit"] or "1"), shown["unit"]
    if one.low > 0 and np.isfinite(one.low) and np.isinf(one.high):
        return f"above {one.low:.3g} (95 %) {unit}"
    if not shown.get("signed", False) and not one.std < abs(one.value):
        return "not determined"
    parts = {name: std for name, std in one.parts.items() if std > _SMALL_PART * one.std}
    if set(parts) <= {"fit"}:
        return str(one)
    return f"{one}: " + ", ".join(f"{n.replace('_', ' ')} {std:.2g}" for n, std in parts.items())
