"""A calibration for people: its parameters by name and value, and its curve as a picture."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from erlif.calibration.departure import Departure
from erlif.calibration.regression import BLACK, Reabsorption
from erlif.core.arrays import Array
from erlif.core.html import curve_picture

# Points of the curve in a notebook.
_CURVE_POINTS = 60


def describe_parameters(
    model: Reabsorption,
    std: Array,
    *,
    thickness_range: tuple[float, float],
    bands: tuple[float, float],
    reduced_chi_square: float,
    curve: xr.Dataset,
    departure: Departure | None,
) -> list[tuple[str, str]]:
    """Parameters, ranges and quality of a calibration by name and value.

    Parameters
    ----------
    model : Reabsorption
    std : array, (parameter,)
        Standard deviations of its parameters.
    thickness_range, bands, reduced_chi_square, curve, departure
        As `Calibration` has them.

    Returns
    -------
    list of (str, str)

    Examples
    --------
    >>> K, *_ = describe_parameters(
    ...     Reabsorption(np.array([0.66, 0.4, 0.25])),
    ...     np.full(3, 1e-3),
    ...     thickness_range=(0.3, 16.0),
    ...     bands=(580.0, 610.0),
    ...     reduced_chi_square=1.0,
    ...     curve=xr.Dataset(),
    ...     departure=None,
    ... )
    >>> K
    ('K, ratio of a vanishing film', '0.66000 ± 0.00100')
    """
    K, p, q = model.parameters[:BLACK]
    low, high = thickness_range
    one, two = bands
    rows = [
        ("K, ratio of a vanishing film", f"{K:.5f} ± {std[0]:.5f}"),
        ("p, attenuation camera 1", f"{p:.5f} ± {std[1]:.5f} 1/um"),
        ("q, attenuation camera 2", f"{q:.5f} ± {std[2]:.5f} 1/um"),
        *(
            [
                ("a, attenuation of the laser", f"{model.parameters[3]:.3f} ± {std[3]:.3f} 1/um"),
                ("R, reflectance of the wall", f"{model.parameters[4]:.3f} ± {std[4]:.3f}"),
            ]
            if model.reflects
            else []
        ),
        ("calibrated range", f"{low:.2f} to {high:.2f} um"),
        ("reduced chi-square", f"{reduced_chi_square:.2f}"),
        ("bands", f"{one:g} nm and {two:g} nm"),
    ]
    if "curve_ratio" in curve:
        rows.append(("fitted points", f"{curve.curve_ratio.size}"))
    if departure is not None:
        rows.append(("departure from the model", "spline"))
    return rows


def draw_curve(
    curve: xr.Dataset, covered_range: tuple[float, float], predict: Callable[[Array], Array]
) -> str:
    """Ratio against thickness as a small picture; empty without fitted points.

    Parameters
    ----------
    curve : xarray.Dataset
        The fitted points, as `Calibration` has them.
    covered_range : (float, float)
        Ends of the drawn curve. [um]
    predict : callable
        Ratio of films.

    Returns
    -------
    str
        HTML.

    Examples
    --------
    >>> draw_curve(xr.Dataset(), (0.3, 16.0), np.exp)
    ''
    """
    if not {"curve_thickness", "curve_ratio"} <= set(curve):
        return ""
    thickness = np.linspace(*covered_range, _CURVE_POINTS)
    points = (curve.curve_thickness.values, curve.curve_ratio.values)
    return curve_picture(
        (thickness, predict(thickness)),
        (np.asarray(points[0], float), np.asarray(points[1], float)),
        labels=("film thickness [um]", "ratio camera 2 / camera 1"),
    )
