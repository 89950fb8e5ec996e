"""The script a user would write today, as the peer of `erlif process`.

OpenPIV per frame, spline warp, curve_fit, interp.

It uses the libraries in their documented way, on the same files, with the settings their tutorials
show. No error bars, no flags.
"""

import json
import time
import tomllib
from pathlib import Path

import numpy as np
import tifffile
from openpiv import filters, pyprocess, validation
from scipy import ndimage
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import curve_fit


def corrected(directory: Path, camera: int):
    """Frames of one camera, dark subtracted and divided by the flat."""
    dark = tifffile.imread(directory / f"camera{camera}_dark.tif").mean(axis=0)
    flat = tifffile.imread(directory / f"camera{camera}_flat.tif").mean(axis=0) - dark
    flat /= flat.mean()
    flat[flat < 0.1] = 1.0  # dead pixels
    for path in sorted((directory / f"camera{camera}").glob("*.tif")):
        yield (tifffile.imread(path) - dark) / flat


def displacement(one, two, window=32, overlap=24):
    """Displacement of camera 2 against camera 1 at every pixel, from one pass."""
    # the ratio changes slowly over the image: take it out before correlating
    flat_one, flat_two = (image / ndimage.gaussian_filter(image, 12) for image in (one, two))
    u, v, s2n = pyprocess.extended_search_area_piv(
        flat_one.astype(np.float32),
        flat_two.astype(np.float32),
        window_size=window,
        overlap=overlap,
        search_area_size=window,
        sig2noise_method="peak2peak",
        normalized_correlation=True,
    )
    invalid = validation.sig2noise_val(s2n, threshold=1.05)
    u, v = filters.replace_outliers(u, v, invalid, method="localmean", max_iter=3, kernel_size=2)
    x, y = pyprocess.get_coordinates(one.shape, search_area_size=window, overlap=overlap)
    u, v = (ndimage.gaussian_filter(field, 1.0) for field in (u, v))
    rows, columns = np.arange(one.shape[0]), np.arange(one.shape[1])
    return tuple(RectBivariateSpline(y[:, 0], x[0], field)(rows, columns) for field in (u, v))


def ratio(one, two):
    """Camera 2 / camera 1 on the grid of camera 1."""
    u, v = displacement(one, two)
    y, x = np.indices(one.shape)
    return ndimage.map_coordinates(two, [y + v, x + u], order=3, mode="nearest") / one


def calibrate(fixture: Path):
    """Thickness against ratio: the model of eq. 5.7 fitted to the mean ratio over the profile."""
    settings = tomllib.loads((fixture / "fixture.toml").read_text())
    pitch = float(settings["optics"]["pixel_pitch"].split()[0]) / 1e3
    mean = np.mean(
        [ratio(a, b) for a, b in zip(corrected(fixture, 1), corrected(fixture, 2), strict=True)],
        axis=0,
    )
    profile = np.genfromtxt(fixture / "profile.csv", delimiter=",", names=True)
    columns = np.nanmedian(mean, axis=0)[16:-16]
    thickness = np.interp(
        np.arange(mean.shape[1]) * pitch, profile["x_mm"], profile["thickness_um"]
    )[16:-16]

    def model(t, K, p, q):
        t = np.maximum(t, 1e-6)
        return K * p / q * np.expm1(-q * t) / np.expm1(-p * t)

    best, _ = curve_fit(model, thickness, columns, p0=[columns[0], 0.5, 0.3], maxfev=20000)
    grid = np.linspace(0.01, 18, 4000)
    return model(grid, *best), grid


def process(run: Path, curve):
    """Thickness map of every frame."""
    ratios, grid = curve
    for one, two in zip(corrected(run, 1), corrected(run, 2), strict=True):
        yield np.interp(ratio(one, two), ratios, grid, left=np.nan, right=np.nan)


def write_curve(fixture: str, output: str) -> None:
    """Calibration curve of a fixture into a file."""
    ratios, grid = calibrate(Path(fixture))
    np.savez(output, ratios=ratios, grid=grid)


def write_maps(run: str, curve: str, output: str) -> None:
    """The whole command: frames of a run to one file for each map, not compressed.

    Prints its seconds and processor seconds without the imports.
    """
    start = (time.perf_counter(), time.process_time())
    stored = np.load(curve)
    Path(output).mkdir(exist_ok=True)
    for k, thickness in enumerate(process(Path(run), (stored["ratios"], stored["grid"]))):
        np.save(Path(output) / f"{k:06d}.npy", thickness.astype(np.float32))
    print(json.dumps([time.perf_counter() - start[0], time.process_time() - start[1]]))
