"""What the attribute `erlif` of datasets and arrays offers in a notebook.

``import erlif`` is enough: `film.erlif` then exists for each dataset of xarray. It shows a film,
opens its groups, makes masks of flags and sums up a region.
"""

from erlif.notebook.array import MapAccessor
from erlif.notebook.film import FilmAccessor
from erlif.notebook.region import summarise_region

__all__ = ["FilmAccessor", "MapAccessor", "summarise_region"]
