"""Which maps a page of bounded size holds, and how finely."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.show.report.maps import MapCoding, embed_map, finest_coding

_WANTED = 50  # triggers that are kept before pixels are
_SAMPLED = 3  # maps whose size stands for that of all
_ROUNDED = 0.05  # of the random standard deviation of a pixel, the coarsest step of its thickness
_AROUND = 80  # characters of the element around a map
_MARGIN = 1.05  # of the mean size of the sampled maps
_FEWEST = 32  # pixels along the longer side of the smallest map


@dataclass(frozen=True)
class KeptMaps:
    """What a page holds of the maps of a film.

    Attributes
    ----------
    triggers : tuple of int
        Numbers of the triggers, rising.
    coding : MapCoding
        Kept pixels, and the thickness of one count.
    """

    triggers: tuple[int, ...]
    coding: MapCoding


def choose_maps(
    film: xr.Dataset,
    *,
    room: float,
    thickest: float,
    opening: int,
    triggers: Sequence[int],
) -> KeptMaps:
    """Choose triggers, pixels and steps whose maps fit into a page.

    Everything is kept where it fits. Else the steps grow to a twentieth of the standard deviation
    of a pixel, then pixels are left out until fifty triggers fit, and of the triggers as many are
    kept, evenly, as there is room for.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.open_film` returns it.
    room : float
        Characters for all maps.
    thickest : float
        Film that 16 bits have to reach. [um]
    opening : int
        A trigger that is always kept.
    triggers : sequence of int
        The triggers to choose from, rising.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> choose_maps(film, room=1e6, thickest=16.0, opening=1, triggers=range(6))
    KeptMaps(triggers=(0, 1, 2, 3, 4, 5), coding=MapCoding(stride=1, step=0.001))
    """
    finest = finest_coding(thickest)
    std = np.nanmedian(np.nan_to_num(film.thickness_std.isel(trigger=opening).values))
    coarse = max(finest.step, round(float(_ROUNDED * std) / finest.step) * finest.step)
    sampled = spread_evenly(triggers, _SAMPLED, opening)

    def count(coding: MapCoding) -> int:
        sizes = [len(embed_map(film, trigger=k, coding=coding)) + _AROUND for k in sampled]
        return int(room / (_MARGIN * float(np.mean(sizes))))

    if count(finest) >= len(triggers):
        return KeptMaps(tuple(triggers), finest)
    longest = max(film.sizes["x"], film.sizes["y"])
    wanted, stride = min(len(triggers), _WANTED), 1
    while True:
        coding = MapCoding(stride, coarse)
        fitting = count(coding)
        if fitting >= wanted or longest // (stride + 1) < _FEWEST:
            kept = spread_evenly(triggers, max(1, fitting), opening)
            return KeptMaps(kept, coding)
        stride += 1


def spread_evenly(triggers: Sequence[int], count: int, kept: int) -> tuple[int, ...]:
    """Choose triggers evenly, `kept` among them.

    Examples
    --------
    >>> spread_evenly(range(100), 4, kept=10)
    (0, 10, 50, 99)
    """
    if count >= len(triggers):
        return tuple(triggers)
    places = np.linspace(0, len(triggers) - 1, count - 1).round().astype(int)
    return tuple(sorted({kept, *(triggers[k] for k in places.tolist())}))
