"""The profile of a map along sliding, and the gap of rigid bodies fitted to it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.arrays import Array
from erlif.core.described import describe
from erlif.core.flags import Flag
from erlif.core.statistics import robust_rms
from erlif.io.files import check_trigger, region_of, settings_of
from erlif.models.contact import conformal_radius

_RANGE_FLAGS = int(Flag.BELOW_RANGE | Flag.ABOVE_RANGE)

# Share of a line outside the measurable range above which the rest is a biased sample.
_MOST_BEYOND = 0.02

_CUT = 0.1  # of the axial extent of the region, of a cut through a minimum
_LEAST_VALID = 0.25  # share of valid pixels of a line, at least

# Pixels averaged before the gap is fitted: machining marks correlate closer neighbours. [px]
_BLOCK = 8

_LEAST_BLOCKS = 6
_WIDEST = 0.9  # of the clearance: radii that a thicker film contradicts give no curvature
_PASSES = 3  # of the fit of the rigid gap, whose curvature depends a little on its minimum


def average_across_sliding(
    film: xr.Dataset,
    *,
    trigger: int,
    between: tuple[float, float] | None = None,
    exchanged: bool = False,
) -> xr.Dataset:
    """Profile of the film along sliding, averaged over the axial extent of the region of interest.

    The log ratio is averaged and then inverted: noise leaves no bias where the inverse is curved.
    All pixels have equal weights, because weights by their error bars would favour the pixels that
    noise makes thin.

    Parameters
    ----------
    film : xarray.Dataset
    trigger : int
        Of the film, counted from 0.
    between : (float, float), optional
        Another extent, across sliding. [mm]
    exchanged : bool
        Exchange sliding and axis: a profile along the axis, averaged along sliding.

    Returns
    -------
    xarray.Dataset
        On dim position [mm], with the trigger among its attributes: thickness, thickness_std
        (random) and thickness_std_shared [um]. NaN where fewer than a quarter of the pixels are
        valid, or more than 2 % lie outside the measurable range.

    Raises
    ------
    ErlifError
        If there is no such trigger.

    Examples
    --------
    The example film is a gap with its minimum in the middle of the image:

    >>> from erlif.show.plots import example_film
    >>> profile = average_across_sliding(example_film(), trigger=2)
    >>> minimum = profile.position[np.nanargmin(profile.thickness.values)]
    >>> bool(abs(minimum - profile.position.mean()) < 1)
    True
    """
    check_trigger(film, trigger)
    along_x = (settings_of(film).optics.x_axis == "sliding") != exchanged
    sliding, axial = ("x", "y") if along_x else ("y", "x")
    calibration, region = calibration_of(film, trigger), region_of(film)
    low, high = getattr(region, axial) if between is None else between
    inside = (film[axial].values >= low) & (film[axial].values <= high)
    names = ["thickness", "thickness_std", "thickness_std_shared", "flags"]
    one = film[names].isel(trigger=trigger)
    one = one.transpose(axial, sliding).isel({axial: inside}).load()

    # sums over the valid pixels of each line across sliding
    flags = one.flags.values
    good = flags == 0
    thickness = np.where(good, one.thickness.values.astype(float), 1.0)
    log_ratio = np.where(good, calibration.predict_log(thickness), 0.0)
    variance = np.where(good, one.thickness_std.values.astype(float), 0.0) ** 2

    # a line with many pixels outside the range has lost its thinnest or thickest pixels
    beyond = ((flags & _RANGE_FLAGS) != 0).sum(axis=0)
    enough = good.mean(axis=0) >= _LEAST_VALID
    unbiased = beyond <= _MOST_BEYOND * (good.sum(axis=0) + beyond)
    total = np.where(enough & unbiased, good.sum(axis=0), np.nan)

    mean = calibration.inverse.look_up(log_ratio.sum(axis=0) / total)
    std = np.sqrt(variance.sum(axis=0)) / total
    shared = np.where(good, one.thickness_std_shared.values.astype(float), 0.0)
    random, common = std * _line_scatter(mean, std), shared.sum(axis=0) / total
    name, std_name = "axial" if exchanged else "sliding", "its standard deviation"
    return describe(
        {
            "thickness": ("position", mean, "um", f"film along {name}"),
            "thickness_std": ("position", random, "um", f"{std_name}, random part"),
            "thickness_std_shared": ("position", common, "um", f"{std_name}, common to all pixels"),
        },
        {"position": ("position", film[sliding].values, "mm", f"{sliding}, {name}")},
    ).assign_attrs(trigger=trigger)


def cut_through_minimum(film: xr.Dataset, *, trigger: int, exchanged: bool = False) -> xr.Dataset:
    """Profile along sliding of a point contact, or of a lobe, through its minimum film.

    It is that of a tenth of the axial extent of the region of interest, over which a parabola
    through the edge of the region rises by a third of a per cent of its height.

    Parameters
    ----------
    film : xarray.Dataset
        With film_min_x and film_min_y.
    trigger : int
        Of the film, counted from 0.
    exchanged : bool
        As for `average_across_sliding`.

    Returns
    -------
    xarray.Dataset
        As of `average_across_sliding`; over the whole extent where there is no minimum.

    Raises
    ------
    ErlifError
        If there is no such trigger.

    Examples
    --------
    The mean of few pixels has more noise than that of all:

    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> column, row = (np.full(film.sizes["trigger"], film.sizes[axis] / 2) for axis in "xy")
    >>> film = film.assign(film_min_x=("trigger", column), film_min_y=("trigger", row))
    >>> cut, mean = (f(film, trigger=2) for f in (cut_through_minimum, average_across_sliding))
    >>> bool(cut.thickness_std.mean() > 2 * mean.thickness_std.mean())
    True
    """
    place = place_of_minimum(film, trigger=trigger)
    if place is None:
        return average_across_sliding(film, trigger=trigger, exchanged=exchanged)
    along_x = (settings_of(film).optics.x_axis == "sliding") != exchanged
    axial = "y" if along_x else "x"
    low, high = getattr(region_of(film), axial)
    reach = max(_CUT * (high - low), abs(float(film[axial][1] - film[axial][0]))) / 2
    between = (place[axial] - reach, place[axial] + reach)
    return average_across_sliding(film, trigger=trigger, between=between, exchanged=exchanged)


def place_of_minimum(film: xr.Dataset, *, trigger: int) -> dict[str, float] | None:
    """Position of the minimum film.

    Arguments and errors as of `cut_through_minimum`.

    Returns
    -------
    dict or None
        Position by the names of the axes, x and y [mm]; None where it is not known.

    Examples
    --------
    >>> film = xr.Dataset({"film_min_x": ("trigger", [1.5]), "film_min_y": ("trigger", [0.0])})
    >>> place_of_minimum(film.assign_coords(x=[0.0, 0.5, 1.0], y=[0.0, 0.5]), trigger=0)
    {'x': 0.75, 'y': 0.0}
    """
    check_trigger(film, trigger)
    if "film_min_x" not in film:
        return None
    place = {
        axis: float(np.interp(film[f"film_min_{axis}"][trigger], np.arange(at.size), at))
        for axis, at in (("x", film.x.values), ("y", film.y.values))
    }
    return place if all(map(math.isfinite, place.values())) else None


@dataclass(frozen=True)
class RigidGap:
    """The gap of a rigid pin in a rigid bushing, as fitted.

    The middles of both circles are c - h_min apart, c the radial clearance, so that
    h = h_min + (1 - h_min/c) (x - x_min)^2/(2 R). The circles of a vanishing film have 1/R.

    Attributes
    ----------
    minimum : float
        h_min. [um]
    position_of_minimum : float
        x_min. [mm]
    radius : float
        Conformal radius R of pin and bushing. [m]
    curvature : float
        Second derivative of a parabola with free curvature, for comparison with 1/R. [um/mm2]
    curvature_std : float
        Its standard deviation, from scatter and calibration. [um/mm2]
    clearance : float
        Radial clearance c; infinite for the parabola of a vanishing film. [um]
    """

    minimum: float
    position_of_minimum: float
    radius: float
    curvature: float
    curvature_std: float
    clearance: float = math.inf

    @property
    def rigid_curvature(self) -> float:
        """Second derivative of the gap of the circles. [um/mm2]"""
        return _gap_curvature(self.minimum, self.clearance, self.radius)

    def thickness(self, position: npt.ArrayLike) -> Array:
        """Gap at a position in mm. [um]"""
        away = np.asarray(position, float) - self.position_of_minimum
        return self.minimum + self.rigid_curvature * away**2 / 2


def rigid_gap(profile: xr.Dataset, film: xr.Dataset) -> RigidGap | None:
    """Fit the gap of rigid bodies to a profile along sliding.

    Parameters
    ----------
    profile : xarray.Dataset
        From `average_across_sliding`.
    film : xarray.Dataset
        The film, for the radii of its joint and its calibration.

    Returns
    -------
    RigidGap or None
        None where fewer than six blocks of eight pixels are valid, or the settings have no joint.

    Examples
    --------
    Pin and bushing of 33.36 mm and 33.59 mm have a conformal radius of 4.872 m:

    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> gap = rigid_gap(average_across_sliding(film, trigger=2), film)
    >>> round(gap.radius, 3)
    4.872
    >>> bool(abs(gap.minimum - film.film_min[2]) < 0.05)
    True
    """
    joint = settings_of(film).joint
    if joint is None:
        return None
    radius = conformal_radius(joint.pin_radius, bushing_radius=joint.bushing_radius)

    # blocks of the profile, weighted by their error bars
    x, h, std = (profile[name].values for name in ("position", "thickness", "thickness_std"))
    block = np.arange(x.size) // _BLOCK
    use = np.isfinite(h)
    weight = np.bincount(block[use], std[use] ** -2.0)
    full = weight > 0
    if full.sum() < _LEAST_BLOCKS:
        return None
    x, h = (
        np.bincount(block[use], values[use] / std[use] ** 2)[full] / weight[full]
        for values in (x, h)
    )

    # level and slope with the curvature of the radii, and all three free
    root = np.sqrt(weight[full])
    middle = float(x.mean())
    design = np.column_stack([np.ones_like(x), x - middle, (x - middle) ** 2 / 2])
    clearance = 1e6 * (joint.bushing_radius - joint.pin_radius)
    minimum, place, bend = 0.0, middle, 1 / radius
    for _ in range(_PASSES):
        rest = h - bend * design[:, 2]
        level, slope = np.linalg.lstsq(design[:, :2] * root[:, None], rest * root, rcond=None)[0]
        minimum, place = level - slope**2 / (2 * bend), middle - slope / bend
        bend = _gap_curvature(minimum, clearance, radius)
    solve = np.linalg.pinv(design * root[:, None])

    # the error of the curvature: scatter of the blocks, and what the calibration shares with all
    residual = root * (h - design @ (solve @ (root * h)))
    scale = float(residual @ residual) / max(h.size - 3, 1)
    calibration = calibration_of(film, profile.attrs.get("trigger"))
    along_x = settings_of(film).optics.x_axis == "sliding"
    along = x / abs(float(film.x[1] - film.x[0]))
    across = np.full_like(x, 0.5 * film.sizes["y" if along_x else "x"])
    at = (along, across) if along_x else (across, along)
    change = solve[2] @ (root * calibration.film_gradient(h, place=at)).T
    variance = float(solve[2] @ solve[2]) * max(scale, 1.0) + float(
        change @ calibration.full_covariance @ change
    )
    return RigidGap(
        minimum=float(minimum),
        position_of_minimum=float(place),
        radius=float(radius),
        curvature=float(solve[2] @ (root * h)),
        curvature_std=math.sqrt(variance),
        clearance=float(clearance),
    )


def _gap_curvature(minimum: float, clearance: float, radius: float) -> float:
    """Second derivative of the gap of two circles at a minimum film [um]. [um/mm2]"""
    return (1 - min(max(minimum / clearance, 0.0), _WIDEST)) / radius


def _line_scatter(values: Array, std: Array) -> float:
    """Scatter of a smooth line over its error bars, at least 1, from second differences.

    Camera 2 is interpolated: the noise of neighbouring rows is correlated and averages out less
    than that of independent pixels.
    """
    difference = values[:-2] - 2 * values[1:-1] + values[2:]
    expected = np.sqrt(std[:-2] ** 2 + 4 * std[1:-1] ** 2 + std[2:] ** 2)
    deviation = np.abs(difference / expected)
    deviation = deviation[np.isfinite(deviation)]
    return max(1.0, robust_rms(deviation)) if deviation.size > 8 else 1.0
