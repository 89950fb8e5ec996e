"""Mean and minimum film thickness of a rectangle, from the maps of a film."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve, calibration_of
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError, ErlifError
from erlif.core.products import RatioImages, ThicknessMaps
from erlif.core.tables import read_table
from erlif.core.variables import FILM
from erlif.io.files import settings_of, takes
from erlif.trend import FilmStatistics, GapShape, Region, find_region, summarise_film

Interval = tuple[float, float]

# Unit and title of the numbers that no film has.
_OWN = read_table("erlif.show.notebook", "region.toml")


@takes(film="film")
def summarise_region(
    film: xr.Dataset, *, x: Interval | None = None, y: Interval | None = None
) -> xr.Dataset:
    """Mean and minimum film thickness over a rectangle of the maps, at every trigger.

    As `erlif.process` does it for the region of interest, from the maps in place of the frames.
    Pixels that are flagged do not count; those at the ends of the measurable range are among
    them, so that a region with many of them has a mean that is too near to its middle. The error of
    the registration, a few nanometres of a pixel, is left out.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.open_film` returns it, with dim trigger or at one trigger.
    x, y : (float, float), optional
        Bounds, included. Default: all of the image. [mm]

    Returns
    -------
    xarray.Dataset
        film_mean, film_min and film_gap_mean with their _std, _std_random and _std_shared [um];
        film_min_x and film_min_y, column and row of the minimum in the image [px]; pixels and
        share_valid, number and share of the valid pixels. NaN where too few are valid.

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
    if "trigger" not in film.dims:
        return summarise_region(film.expand_dims("trigger"), x=x, y=y).isel(trigger=0)
    region = _find_region(film, x, y)
    along_x = settings_of(film).optics.x_axis == "sliding"
    contact = GapShape(film.attrs.get("contact", GapShape.LINE))
    names = ["thickness", "thickness_std", "flags"]
    names += ["noise_correlation"] if "noise_correlation" in film else []
    maps = film[names].isel(y=region.rows, x=region.columns)

    # one map in memory at a time
    rows = []
    for trigger in range(film.sizes["trigger"]):
        one = maps.isel(trigger=trigger).load()
        calibration = calibration_of(film, trigger)
        found = _summarise(one, calibration, contact, along_x=along_x)
        row = _tabulate(found, calibration.full_covariance)
        row["film_min_x"] += region.columns.start
        row["film_min_y"] += region.rows.start
        row["pixels"] = int((one.flags == 0).sum())
        row["share_valid"] = row["pixels"] / one.flags.size
        rows.append(row)

    columns = {}
    for name in rows[0]:
        attrs = _OWN.get(name) or {key: FILM[name].attrs[key] for key in ("units", "long_name")}
        columns[name] = "trigger", [row[name] for row in rows], attrs
    low_x, *_, high_x = film.x.values[region.columns]
    low_y, *_, high_y = film.y.values[region.rows]
    bounds = f"x {low_x:.2f} to {high_x:.2f} mm, y {low_y:.2f} to {high_y:.2f} mm"
    title = f"film thickness over {bounds}"
    return xr.Dataset(columns, film.film_mean.coords, {"title": title})


def _find_region(film: xr.Dataset, x: Interval | None, y: Interval | None) -> Region:
    across, down = film.x.values, film.y.values
    whole = (float(across[0]), float(across[-1])), (float(down[0]), float(down[-1]))
    roi = whole[0] if x is None else x, whole[1] if y is None else y
    try:
        return find_region(across, down, roi=roi)
    except ConfigError as error:
        raise ErlifError(
            f"Expected a region of at least 32 x 32 pixels within x 0 to {across[-1]:.2f} mm and y "
            f"0 to {down[-1]:.2f} mm; got x = {x}, y = {y}. Give bounds in mm that are farther "
            "apart."
        ) from error


def _summarise(
    maps: xr.Dataset, calibration: RunCurve, contact: GapShape, *, along_x: bool
) -> FilmStatistics:
    """Statistics of one trigger: the logarithm of the ratio follows from the calibration."""
    thickness = maps.thickness.values.astype(float)
    valid = maps.flags.values == 0
    film = np.where(valid, thickness, np.mean(calibration.thickness_range))
    slope = calibration.slope(film)
    own = np.square(slope * np.where(valid, maps.thickness_std.values, 0.0))

    # the error of the calibration enters by its covariance after the run; that of the maps is the
    # one before it, rounded to 3 %, in which the error of the registration is lost
    log_ratio = calibration.predict_log(film)
    images = {"log_ratio": log_ratio, "log_ratio_near": np.where(valid, log_ratio, np.nan)}
    images |= {"log_ratio_var": own, "log_ratio_var_shared": np.zeros_like(own)}
    images |= {"flags": maps.flags.values}
    # ratio and map in one dataset: the statistics take from each what it has
    combined = xr.Dataset({name: (("y", "x"), image) for name, image in images.items()})
    combined["noise_correlation"] = maps.get("noise_correlation", 1.0)
    pair = RatioImages(combined), ThicknessMaps(combined)
    whole = Region(slice(0, valid.shape[0]), slice(0, valid.shape[1]))
    return summarise_film(
        *pair, calibration, region=whole, sliding_along_x=along_x, contacts=(contact,)
    )


def _tabulate(one: FilmStatistics, covariance: Array) -> dict[str, float]:
    """Values and standard deviations of a trigger by their names; places from the region's edge."""
    row = dict(zip(("film_min_x", "film_min_y"), one.gap.place.tolist(), strict=True))
    for name, number in (
        ("film_mean", one.mean),
        ("film_min", one.gap.minimum),
        ("film_gap_mean", one.gap.mean),
    ):
        std, random = number.std(covariance), number.random_std
        row[name], row[f"{name}_std"], row[f"{name}_std_random"] = number.value, std, random
        row[f"{name}_std_shared"] = float(np.sqrt(max(std**2 - random**2, 0.0)))
    return row
