"""The film along the axis of a bore that is not straight."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.errors import ConfigError
from erlif.io.files import settings_of
from erlif.pipeline.plane import ObjectPlane
from erlif.show.plots import style
from erlif.show.plots.prediction import has_prediction, predicted_map
from erlif.show.plots.profiles import draw_profile, mark_minimum
from erlif.show.plots.style import MINIMUM, RETURN
from erlif.trend import cut_through_minimum, place_of_minimum


@style.film_panel
def film_along_axis(film: xr.Dataset, *, trigger: int, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the film along the axis through its minimum, with the shape of the bore.

    The film is the mean over a tenth of the region along sliding. Beside it are the bore above a
    parallel pin at the minimum film, and the predicted film. Bands are one standard deviation: blue
    of the random error, grey of the error that all pixels share. The diamond is the minimum film
    with its bar. Arguments as in `erlif.plots`.

    Returns
    -------
    list of Artist
        Profile, random band, shared band, minimum, bore; the predicted film where there is one.

    Raises
    ------
    ErlifError
        If the bore is straight, or the trigger has no minimum film.

    Examples
    --------
    The bore of the example film is straight:

    >>> from erlif.show.plots import example_film
    >>> film_along_axis(example_film(), trigger=0)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected a film with bore in [joint] and a minimum at ...
    """
    plane = ObjectPlane(settings_of(film), (film.sizes["y"], film.sizes["x"]))
    place = place_of_minimum(film, trigger=trigger)
    if plane.bore is None or place is None:
        raise ConfigError(
            "Expected a film with bore in [joint] and a minimum at the trigger; the bore is "
            "straight, or there is no minimum. Choose another trigger, or draw thickness_map."
        )
    axial, shape = plane.across, plane.bore.at(plane.across)
    profile = cut_through_minimum(film, trigger=trigger, exchanged=True)
    artists = draw_profile(ax, film, profile, np.zeros_like(axial))
    artists += mark_minimum(ax, film, trigger, "y" if plane.sliding_along_x else "x")

    least = plane.bore.at(place["y" if plane.sliding_along_x else "x"])
    gap = float(film.film_min[trigger]) + shape - least
    look: dict[str, Any] = {"width": 2.5, "alpha": 0.5, "zorder": 1.2, "label": "bore"}
    artists += style.draw_line(ax, axial, gap, RETURN, **look)
    if has_prediction(film):
        across = predicted_map(film, trigger=trigger).min(axis=int(plane.sliding_along_x))
        look = {"form": "--", "width": 0.7, "label": "predicted"}
        artists += style.draw_line(ax, axial, across, MINIMUM, **look)
    ax.set_ylim(0.0, 1.1 * float(np.nanmax(profile.thickness, initial=gap.min())))
    ax.set_ylabel("film thickness [µm]")
    style.legend_above(ax, ncols=1)
    return artists
