"""Attribute `erlif` of datasets and arrays in a notebook.

``import erlif`` is enough: `film.erlif` then exists for each dataset of xarray. It shows a film,
opens its groups, makes masks of flags and sums up a region.
"""

from erlif.show.notebook.film import FilmAccessor, MapAccessor
from erlif.show.notebook.region import summarise_region

__all__ = ["FilmAccessor", "MapAccessor", "summarise_region"]
