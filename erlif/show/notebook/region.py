"""Mean and minimum film thickness of a rectangle, from the maps of a film."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.calibration import Calibration, calibration_of
from erlif.core.errors import ConfigError, ErlifError
from erlif.core.products import RatioImages, ThicknessMaps
from erlif.io.files import settings_of, takes
from erlif.trend import FilmStatistics, Region, find_region, summarise_film

Interval = tuple[float, float]

_COLUMNS = {
    "film_mean": "mean film thickness",
    "film_mean_std": "standard deviation of the mean film thickness",
    "film_mean_std_random": "its part that is new at every trigger",
    "film_mean_std_shared": "its part that all triggers share",
    "film_min": "minimum film thickness",
    "film_min_std": "standard deviation of the minimum film thickness",
    "film_min_std_random": "its part that is new at every trigger",
    "film_min_std_shared": "its part that all triggers share",
}


@takes(film="film")
def summarise_region(
    film: xr.Dataset, *, x: Interval | None = None, y: Interval | None = None
) -> xr.Dataset:
    """Mean and minimum film thickness over a rectangle of the maps, at every trigger.

    As `erlif.process` does it for the region of interest, from the maps in place of the frames.
    Pixels that are flagged do not count; those at the ends of the measurable range are among
    them, so that a region with many of them has a mean that is too near to its middle.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.open_film` returns it, with dim trigger or at one trigger.
    x, y : (float, float), optional
        Bounds, included. Default: all of the image. [mm]

    Returns
    -------
    xarray.Dataset
        film_mean and film_min with their _std, _std_random and _std_shared [um]; film_min_x and
        film_min_y, column and row of the minimum in the image [px]; pixels and share_valid, number
        and share of the valid pixels. NaN where too few are valid.

    Raises
    ------
    ErlifError
        If the dataset is no film, or fewer than 32 x 32 pixels lie in the rectangle.

    Examples
    --------
    >>> film = erlif.open_film("film.nc")  # doctest: +SKIP
    >>> found = summarise_region(film, x=(4, 15), y=(2, 13))  # doctest: +SKIP
    >>> found.film_mean.plot(x="crank_angle")  # doctest: +SKIP
    """
    region = _find_region(film, x, y)
    calibration = calibration_of(film)
    along_x = settings_of(film).optics.x_axis == "sliding"
    several = "trigger" in film.dims
    names = ["thickness", "thickness_std", "thickness_std_shared", "flags"]
    maps = film[names].isel(y=region.rows, x=region.columns)

    found, counts = [], []
    for trigger in range(film.sizes["trigger"] if several else 1):
        one = (maps.isel(trigger=trigger) if several else maps).load()
        found.append(_summarise(one, calibration, along_x=along_x))
        counts.append(int((one.flags == 0).sum()))

    dims = ("trigger",) if several else ()
    columns = {
        name: (dims, np.reshape(values, (-1,) if several else ()))
        for name, values in _tabulate(found).items()
    }
    pixels = np.reshape(counts, (-1,) if several else ())
    places = np.array([one.minimum_place for one in found]).T
    at = {
        f"film_min_{axis}": (
            dims,
            np.reshape(first + place, (-1,) if several else ()),
            {"units": "px", "long_name": f"{name} of the minimum film thickness"},
        )
        for axis, name, first, place in zip(
            "xy", ("column", "row"), (region.columns.start, region.rows.start), places, strict=True
        )
    }
    total = maps.sizes["y"] * maps.sizes["x"]
    described = xr.Dataset(
        {
            **{
                name: (*column, {"units": "um", "long_name": _COLUMNS[name]})
                for name, column in columns.items()
            },
            **at,
            "pixels": (dims, pixels, {"units": "1", "long_name": "valid pixels"}),
            "share_valid": (
                dims,
                pixels / total,
                {"units": "1", "long_name": "share of valid pixels"},
            ),
        },
        film.film_mean.coords,
    )
    bounds = {"x": film.x.values[region.columns], "y": film.y.values[region.rows]}
    return described.assign_attrs(
        title="film thickness over x {:.2f} to {:.2f} mm, y {:.2f} to {:.2f} mm".format(
            *(float(place) for one in bounds.values() for place in (one[0], one[-1]))
        )
    )


def _find_region(film: xr.Dataset, x: Interval | None, y: Interval | None) -> Region:
    bounds = tuple(
        (float(film[name][0]), float(film[name][-1])) if given is None else given
        for name, given in (("x", x), ("y", y))
    )
    try:
        return find_region(film.x.values, film.y.values, roi=(bounds[0], bounds[1]))
    except ConfigError as error:
        raise ErlifError(
            f"Expected a region of at least 32 x 32 pixels within x 0 to {float(film.x[-1]):.2f} "
            f"mm and y 0 to {float(film.y[-1]):.2f} mm; got x = {x}, y = {y}. Give bounds in mm "
            "that are farther apart."
        ) from error


def _summarise(maps: xr.Dataset, calibration: Calibration, *, along_x: bool) -> FilmStatistics:
    """Statistics of one trigger: the logarithm of the ratio follows from the calibration."""
    thickness = maps.thickness.values.astype(float)
    valid = maps.flags.values == 0
    film = np.where(valid, thickness, np.mean(calibration.thickness_range))
    slope = calibration.slope(film)
    own = np.square(slope * np.where(valid, maps.thickness_std.values, 0.0))

    # the shared error of a pixel is that of calibration and registration; the first enters the
    # statistics by the covariance of the calibration
    both = np.where(valid, maps.thickness_std_shared.values, 0.0)
    displaced = np.square(slope) * np.maximum(
        np.square(both) - np.square(calibration.thickness_std(film)), 0.0
    )
    dims = ("y", "x")
    ratios = xr.Dataset(
        {
            "log_ratio": (dims, calibration.predict_log(film)),
            "log_ratio_var": (dims, own),
            "log_ratio_var_shared": (dims, displaced),
            "flags": (dims, maps.flags.values),
        }
    )
    of_maps = xr.Dataset(
        {
            "log_ratio_near": (dims, np.where(valid, ratios.log_ratio.values, np.nan)),
            "flags": (dims, maps.flags.values),
        }
    )
    whole = Region(slice(0, valid.shape[0]), slice(0, valid.shape[1]))
    return summarise_film(
        RatioImages(ratios),
        ThicknessMaps(of_maps),
        calibration,
        region=whole,
        sliding_along_x=along_x,
    )


def _tabulate(found: list[FilmStatistics]) -> dict[str, list[float]]:
    """Values and standard deviations of all triggers by their names."""
    table: dict[str, list[float]] = {name: [] for name in _COLUMNS}
    for one in found:
        for name, value, std, random in (
            ("film_mean", one.mean, one.mean_std, one.mean_random_std),
            ("film_min", one.minimum, one.minimum_std, one.minimum_random_std),
        ):
            table[name].append(value)
            table[f"{name}_std"].append(std)
            table[f"{name}_std_random"].append(random)
            table[f"{name}_std_shared"].append(float(np.sqrt(max(std**2 - random**2, 0.0))))
    return table
