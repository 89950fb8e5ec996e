"""Effect of the tolerance of each part on error, range and film."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from erlif.io.settings import PlanSettings
from erlif.planning.design import Design, FilteredCamera, log_ratio, log_ratio_slope
from erlif.planning.optimum import FILMS, largest_error
from erlif.planning.precision import WantedFilm, measurable_range

# Tolerances by default, those of the settings: shares of the value, the filter in nm.
TOLERANCES: Mapping[str, float] = {
    name: float(value) for name, value in PlanSettings.model_fields["tolerances"].default
}


@dataclass(frozen=True)
class ToleranceEffect:
    """Effect of one tolerance, the worse of both signs.

    Attributes
    ----------
    what : str
        Quantity, "concentration of dye 1".
    tolerance : str
        Its size, "5 %" or "2 nm".
    std : float
        Relative change of the largest standard deviation over thickness in the wanted range; NaN
        where that is infinite with and without the change. [1]
    thinnest : float
        Change of the thin end of the measurable range; NaN where there is none. [um]
    thickest : float
        Change of its thick end. [um]
    film : float
        Largest relative error of a film in the measurable part of the wanted range, where the
        change happens after the calibration. [1]
    """

    what: str
    tolerance: str
    std: float
    thinnest: float
    thickest: float
    film: float

    @property
    def effect(self) -> float:
        """Larger of both relative effects that are known. [1]"""
        return float(np.nanmax(np.abs([self.std, self.film, 0.0])))


def vary_tolerances(
    design: Design, film: WantedFilm, tolerances: Mapping[str, float] = TOLERANCES
) -> list[ToleranceEffect]:
    """Change each part of a design by its tolerance.

    Parameters
    ----------
    design : Design
    film : WantedFilm
    tolerances : mapping of str to float
        Keys as in `TOLERANCES`.

    Returns
    -------
    list of ToleranceEffect
        The largest effect first. Shifts of filters are left out where the dyes are given by
        coefficients.

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> changes = vary_tolerances(example_dye_design(), WantedFilm(2.0, 8.0, (0.1, 18.0)))
    >>> changes[0].what[:14], changes[-1].effect < 0.05
    ('gain of camera', True)
    """
    # a shift of the ratio is no film where the ratio hardly changes
    low, high = measurable_range(design, film)
    first, last = max(film.thinnest, low), min(film.thickest, high)
    if not first < last:
        first, last = film.thinnest, film.thickest
    films = np.geomspace(first, last, FILMS)
    before, slope = log_ratio(design, films), log_ratio_slope(design, films)
    error = largest_error(design, film)

    def change(what: str, size: str, varied: Design) -> ToleranceEffect:
        thin, thick = measurable_range(varied, film)
        moved = log_ratio(varied, films) - before
        # counts and not electrons are compared: the gains of both cameras are part of the ratio
        gains = [camera.gain for camera in (*varied.cameras, *design.cameras)]
        moved += np.log(gains[0] / gains[1] * gains[3] / gains[2])
        return ToleranceEffect(
            what,
            size,
            # an infinite error cannot change
            largest_error(varied, film) / error - 1 if math.isfinite(error) else math.nan,
            thin - low,
            thick - high,
            float(np.abs(moved / slope / films).max()),
        )

    # of each tolerance the sign with the larger effect
    narrow = any(dye.absorption.narrow or dye.emission.narrow for dye in design.dyes)
    changes = []
    for what, size, unit, vary in _variations(design, {**TOLERANCES, **tolerances}):
        if narrow and unit == "nm":
            continue
        text = f"{100 * size:.3g} %" if unit == "%" else f"{size:g} nm"
        both = [change(what, text, vary(step)) for step in (size, -size)]
        changes.append(max(both, key=lambda one: (one.effect, one.std)))
    return sorted(changes, key=lambda one: -one.effect)


_Vary = Callable[[float], Design]


def _variations(design: Design, size: Mapping[str, float]) -> list[tuple[str, float, str, _Vary]]:
    """Name, size, unit and the changed design of each tolerance."""

    def dye(n: int) -> _Vary:
        return lambda step: design.with_concentrations(
            design.concentrations * np.where(np.arange(2) == n, 1 + step, 1.0)
        )

    def camera(key: str, *numbers: int) -> _Vary:
        def changed(one: FilteredCamera, step: float) -> FilteredCamera:
            value = getattr(one, key)
            # the tolerance of a filter is a shift
            return replace(one, **{key: value + step if key == "band" else value * (1 + step)})

        return lambda step: replace(
            design,
            cameras=tuple(
                changed(one, step) if n in numbers else one for n, one in enumerate(design.cameras)
            ),
        )

    def energy(step: float) -> Design:
        return replace(design, energy=design.energy * (1 + step))

    varied: list[tuple[str, float, str, _Vary]] = []
    for n in (0, 1):
        varied += [
            (f"concentration of dye {n + 1}", size["concentration"], "%", dye(n)),
            (f"filter of camera {n + 1}", size["filter"], "nm", camera("band", n)),
            (f"gain of camera {n + 1}", size["gain"], "%", camera("gain", n)),
        ]
    return [
        *varied,
        ("pulse energy", size["pulse_energy"], "%", energy),
        ("read noise", size["read_noise"], "%", camera("read_noise", 0, 1)),
        ("full well", size["full_well"], "%", camera("full_well", 0, 1)),
    ]
