"""The predicted film in a few lines, beside the measured one."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.notes import join_notes
from erlif.io.files import settings_of
from erlif.pipeline.physics.prediction import describe_sideways, note_difference
from erlif.prediction import speed_correlation
from erlif.show.report.layout import TABLES, print_rows


def describe_correlations(film: xr.Dataset) -> str:
    """Correlation of the minimum film with the size of the speed over the triggers."""
    if "film_predicted_min" not in film or "rocker_speed" not in film:
        return ""
    speed = film["rocker_speed"].values
    # a run directory has a prediction without a measured film
    found = [
        speed_correlation(film[name].values, speed) if name in film else np.nan
        for name in ("film_min", "film_predicted_min")
    ]
    measured, predicted = (f"{value:+.2f}" if np.isfinite(value) else "none" for value in found)
    return f"measured {measured}, predicted {predicted}"


def describe_difference(film: xr.Dataset) -> str:
    """Mean and rms of the measured minimum less the predicted one; empty without either."""
    off = _differences(film)
    if not off.size:
        return ""
    return f"mean {off.mean():+.3g} um, rms {np.sqrt(np.mean(off**2)):.3g} um"


def carrying_sentences(film: xr.Dataset) -> list[str]:
    """What is assumed to carry the film, how far the measured film agrees, and how to test it."""
    if "film_predicted_min" not in film:
        return []
    options = settings_of(film).prediction
    lines = [
        f"Assumed: {describe_sideways(options)} ([prediction]).",
        TABLES["carried"].get(str(options.sideways), TABLES["carried"]["held"]),
    ]
    off = _differences(film)
    if off.size:
        mean, rms = f"{off.mean():+.2g}".replace("-", "−"), np.sqrt(np.mean(off**2))
        lines.append(f"Measured less predicted minimum film: mean {mean} µm, rms {rms:.2g} µm.")
    lines.append(
        "erlif predict FILM --fit compares a free with a guided pin by the measured positions and "
        "fits the viscosity."
    )
    return lines


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
    if "film_min" in prediction and np.isfinite(prediction["film_min"].values).any():
        low, high = np.nanmin(prediction["film_min"]), np.nanmax(prediction["film_min"])
        rows["measured minimum film"] = f"{low:.4g} to {high:.4g} um"
    source = "fitted to the measured minima" if attrs["start_film_fitted"] else "as given"
    rows["minimum at the first frame"] = f"{attrs['start_film']:.4g} um, {source}"
    rows["measured less predicted"] = describe_difference(prediction)
    rows["correlation with |speed|"] = describe_correlations(prediction)
    if "settings" in attrs:
        notes = note_difference(prediction, settings_of(prediction).prediction)
        rows["notes"] = join_notes(notes)
    return print_rows(f"{name}: {attrs['model']}, {minimum.size} triggers", rows)
