"""Concentrations with which the worst film of a wanted range has the smallest relative error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.planning.design import Design
from erlif.planning.precision import WantedFilm, dimmed_to_full_scale, thickness_std
from erlif.planning.spectra import Dye

# Films of the range whose largest error is minimised.
FILMS = 25

_SEARCH = 10  # concentrations of each dye on the first, coarse grid
_CLOSE = 1e-4  # of ln concentration and of the error: where the search ends
_LEAST_DEPTH = 1e-2  # optical depth of the thickest film at the smallest concentration searched


@dataclass(frozen=True)
class Optimum:
    """The best concentrations.

    Attributes
    ----------
    design : Design
        With these concentrations, and the pulse energy that the cameras allow.
    error : float
        Largest standard deviation over thickness in the wanted range. [1]
    at_limit : tuple[bool, bool]
        Whether the solubility limits dye 1 and dye 2.
    """

    design: Design
    error: float
    at_limit: tuple[bool, bool]


def largest_error(design: Design, film: WantedFilm) -> float:
    """Largest relative standard deviation of a pixel over the wanted range.

    Parameters
    ----------
    design : Design
    film : WantedFilm

    Returns
    -------
    float
        [1]

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> round(largest_error(example_dye_design(), WantedFilm(2.0, 8.0, (0.1, 18.0))), 2)
    0.16
    """
    films = np.geomspace(film.thinnest, film.thickest, FILMS)
    std = thickness_std(design, films, frames=film.frames, average=film.average)
    return float((std / films).max())


def find_optimum(
    design: Design, film: WantedFilm, *, largest: float = 0.05, fill: float = 0.75
) -> Optimum:
    """Find the concentrations with the smallest `largest_error`.

    A coarse grid of logarithms of both concentrations, then the simplex of Nelder and Mead from its
    best point (`brute` and `fmin` of `scipy.optimize`).

    Parameters
    ----------
    design : Design
        Its concentrations do not matter; its pulse energy is the largest one allowed.
    film : WantedFilm
    largest : float
        Largest concentration that dissolves, of each dye. [mol/L]
    fill : float
        Largest mean signal, share of full scale; speckle and pulse energy need the rest. The pulse
        energy is lowered where the thickest film would exceed it. [1]

    Returns
    -------
    Optimum

    Raises
    ------
    ModelError
        If no concentration gives a ratio that rises over the whole range.

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> film = WantedFilm(2.0, 30.0, (0.5, 45.0))
    >>> found = find_optimum(example_dye_design(), film)
    >>> found.error < largest_error(example_dye_design(), film)
    True
    """
    from scipy.optimize import brute, fmin  # heavy, and only needed here

    # with less than the smallest concentration the thickest film would not absorb at all
    depth = np.array([film.thickest * _attenuation_per_molar(design, dye) for dye in design.dyes])
    high = np.full(2, np.log(largest))
    with np.errstate(divide="ignore"):  # a dye that absorbs nowhere has no smallest concentration
        low = np.log(_LEAST_DEPTH / depth)
    low = np.minimum(low, high - 1.0)

    def prepared(logarithms: Array) -> Design:
        mixed = design.with_concentrations(np.exp(np.minimum(logarithms, high)))
        return dimmed_to_full_scale(mixed, film.thickest, fill)

    def error(logarithms: Array) -> float:
        # the logarithm has a finite slope where the error is huge; beyond the solubility it rises
        beyond = float(np.maximum(logarithms - high, 0.0).sum())
        return float(np.log(min(largest_error(prepared(logarithms), film), 1e12))) + beyond

    coarse = brute(
        error,
        tuple(zip(low, high, strict=True)),
        Ns=_SEARCH,
        finish=None,
    )
    best = fmin(error, np.asarray(coarse), xtol=_CLOSE, ftol=_CLOSE, disp=False)
    best_design = prepared(np.asarray(best))
    reached = largest_error(best_design, film)
    if not np.isfinite(reached):
        raise ModelError(
            "Expected two bands whose ratio rises with thickness for some concentrations; none was "
            "found. Exchange the cameras, or choose filters of which dye 2 absorbs only one."
        )
    limited = best_design.concentrations > 0.999 * largest
    return Optimum(best_design, reached, (bool(limited[0]), bool(limited[1])))


def _attenuation_per_molar(design: Design, dye: Dye) -> float:
    """At the laser; in the bands where the dye does not absorb the laser. [L/mol/um]"""
    bands = [camera.band for camera in design.cameras]
    attenuation = float(dye.attenuation(design.laser)) or float(dye.attenuation(bands).max())
    return attenuation / dye.concentration
