"""Two scripts with OpenPIV as entrants of the ERLIF challenge: a user's, and a careful user's."""

import tomllib
import warnings
from pathlib import Path

import numpy as np
import tifffile
from scipy import ndimage

from benchmarks import user_script
from benchmarks.challenge.methods import Array, Rig
from benchmarks.registration import openpiv_quintic

GAIN, READ_NOISE = 4.4, 9.0  # electron/DN and electron, as every run.toml states
EDGE = 10  # columns at both ends of the fixture that are left out of the fit
SMOOTH = 3.0  # pixels over which a script smooths a map before it takes the minimum


def fold(frames: Array, maps: int) -> Array:
    """Mean of the frames of each map, (map, y, x); frame k belongs to map k modulo `maps`."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # pixels without a value in any frame
        return np.nanmean(frames.reshape(-1, maps, *frames.shape[1:]), axis=0)


def summarise(rig: Rig, film: Array) -> dict[str, Array | float]:
    """Lowest hundredth of each smoothed map, and the power of speed over load that it follows."""
    minimum = []
    for one in film:
        known = np.isfinite(one)
        weight = ndimage.gaussian_filter(known.astype(float), SMOOTH)
        smooth = ndimage.gaussian_filter(np.where(known, one, 0.0), SMOOTH)
        inside = (smooth / np.where(weight > 0.5, weight, np.nan))[rig.region]
        minimum.append(np.nanpercentile(inside, 1) if np.isfinite(inside).any() else np.nan)
    found = {"thickness": film, "minimum": np.array(minimum)}
    good = np.isfinite(found["minimum"]) & (found["minimum"] > 0)
    if good.sum() > 4 and np.ptp(rig.speed_over_load) > 0.1:
        logs = np.log(rig.speed_over_load[good]), np.log(found["minimum"][good])
        found["exponent"] = float(np.polyfit(*logs, 1)[0])
    return found


@np.errstate(divide="ignore", invalid="ignore")  # pixels without light have no ratio
def measure_script(rig: Rig) -> dict[str, Array | float]:
    """The script of a user: one pass of OpenPIV a pair, eq. 5.7 fitted; no error bars."""
    curve = user_script.calibrate(rig.home / "fixture")
    frames = np.array(list(user_script.process(rig.home / "run", curve)))
    return summarise(rig, fold(frames, rig.speed_over_load.size))


def find_fields(pairs: Array) -> tuple[Array, Array]:
    """Displacement of camera 2 over all pairs (axis, y, x), and the shift of each, (k, axis, 1, 1).

    OpenPIV in three passes and a polynomial of degree five through its vectors. The cameras shake
    against each other, so a pair differs from the median of all by a shift.
    """
    fields = np.array(
        [openpiv_quintic(*pair, windows=(32, 32, 32)) for pair in pairs.swapaxes(0, 1)]
    )
    shifts = np.median(fields, axis=(2, 3), keepdims=True)
    return np.median(fields - shifts, axis=0), shifts


def log_ratios(directory: Path, form: Array | None = None) -> tuple[Array, Array, Array]:
    """Log ratio of every pair on the grid of camera 1, its variance by photons, and the field.

    The thin end of a fixture misleads a correlation, so that a field of the run can be given.
    """
    pairs = np.array([list(user_script.corrected(directory, camera)) for camera in (1, 2)])
    found, shifts = find_fields(pairs)
    form = found if form is None else form
    y, x = np.indices(pairs.shape[2:])
    for two, (u, v) in zip(pairs[1], form + shifts, strict=True):
        two[:] = ndimage.map_coordinates(two, [y + v, x + u], order=3, mode="nearest")
    one, two = GAIN * np.maximum(pairs, 1.0)
    variance = sum((light + READ_NOISE**2) / light**2 for light in (one, two))
    return np.log(two / one), variance, form


def measure_openpiv(rig: Rig) -> dict[str, Array | float]:
    """OpenPIV with a fitted curve, by a careful user: error bars of photons, no bad pixels."""
    of_run, variances, form = log_ratios(rig.home / "run")
    ratios, _, _ = log_ratios(rig.home / "fixture", form)
    profile = np.genfromtxt(rig.home / "fixture" / "profile.csv", delimiter=",", names=True)
    settings = tomllib.loads((rig.home / "fixture" / "fixture.toml").read_text(encoding="utf-8"))
    pitch = float(settings["optics"]["pixel_pitch"].split()[0]) / 1e3
    columns = np.arange(ratios.shape[2])[EDGE:-EDGE]
    wedge = np.interp(columns * pitch, profile["x_mm"], profile["thickness_um"])
    curve = np.polynomial.Polynomial.fit(wedge, np.median(ratios, axis=(0, 1))[columns], 5)
    grid = np.linspace(wedge.min() / 2, wedge.max(), 2000)
    logs = np.maximum.accumulate(curve(grid))

    frames = np.interp(of_run, logs, grid, left=np.nan, right=np.nan)
    frames[:, bad_pixels(rig.home / "run")] = np.nan
    maps = rig.speed_over_load.size
    std = np.sqrt(variances) / np.abs(curve.deriv()(frames))
    counted = np.isfinite(frames).reshape(-1, maps, *frames.shape[1:]).sum(axis=0)
    found = summarise(rig, fold(frames, maps))
    found["std"] = np.sqrt(fold(std**2, maps) / np.maximum(counted, 1))
    return found


def bad_pixels(run: Path) -> Array:
    """Pixels of either camera that are hot in the darks or dim in the flats, (y, x)."""
    bad = False
    for camera in (1, 2):
        dark = tifffile.imread(run / f"camera{camera}_dark.tif").mean(axis=0)
        flat = tifffile.imread(run / f"camera{camera}_flat.tif").mean(axis=0)
        bad = bad | (dark > np.median(dark) + 20) | (flat < 0.5 * np.median(flat))
    return ndimage.binary_dilation(bad)  # camera 2 is a few pixels off
