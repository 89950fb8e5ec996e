"""The stages from counts to film in plain steps: the reference of the compiled kernels.

One step for each idea, in double precision where that is simplest. The tests hold
`erlif.correction`, `erlif.registration`, `erlif.ratio` and `erlif.thickness` to these.
"""

import cv2
import numpy as np
import xarray as xr

from erlif.core.detector import QUANTISATION_VAR
from erlif.core.flags import Flag
from erlif.ratio import BlurDifference, find_bubbles
from erlif.ratio.softening import Softening
from erlif.registration import interpolation_variance_factor, orient, warp
from erlif.thickness import CLEAR

LIGHT = ("signal", "signal_var", "signal_var_fixed", "flags")
"""Variables of corrected and of aligned frames."""

RATIO = ("log_ratio", "log_ratio_var", "log_ratio_var_fixed", "log_ratio_var_shared", "flags")


def correct_frames(frames, references, *, least_signal=100.0):
    """Counts to light, camera by camera and frame by frame."""
    counts = frames.counts.values
    energies = np.ones(counts.shape[1])
    if "pulse_energy" in frames.coords:
        energies = frames.pulse_energy.values
    stages = {name: np.empty(counts.shape, np.float32) for name in LIGHT[:3]}
    stages["flags"] = np.empty(counts.shape, np.uint16)
    for camera, n in np.ndindex(counts.shape[:2]):
        reference = references.isel(camera=camera)
        one = correct(counts[camera, n], reference, least_signal, float(energies[n]))
        for name, image in zip(LIGHT, one, strict=True):
            stages[name][camera, n] = image
    dims = ("camera", "frame", "y", "x")
    return xr.Dataset({name: (dims, image) for name, image in stages.items()}, frames.coords)


def correct(counts, reference, least_signal, energy):
    """Light of one image, both variances and the flags."""
    dark, flat = reference.dark.values, reference.flat.values.astype(float)
    gain, least = float(reference.gain), least_signal / float(reference.gain)
    light = counts.astype(float) - dark
    page = np.zeros(counts.shape)
    of_dark = reference.dark_var.values.astype(float)
    if "background" in reference:
        page = energy * reference.background.values.astype(float)
        of_dark = (1 - energy * float(reference.background_recorded)) ** 2 * of_dark
        of_dark = of_dark + energy**2 * reference.background_var.values
    signal = (light - page) / flat

    bad = reference.bad.values
    flags = np.where(counts >= int(reference.full_scale), Flag.SATURATED, 0)
    flags = flags | np.where(light - page < least, Flag.DIM, 0) | np.where(bad, Flag.BAD_PIXEL, 0)
    signal = fill_bad_pixels(signal, bad)

    # shot noise of light below dark is zero, and the flat scales every part alike
    read_var = (float(reference.read_noise) / gain) ** 2 + QUANTISATION_VAR
    seen = np.maximum(signal * flat + page, 0)
    of_flat = signal**2 * reference.flat_var.values
    return signal, (seen / gain + read_var) / flat**2, (of_dark + of_flat) / flat**2, flags


def fill_bad_pixels(signal, bad):
    """The mean of the good pixels of the smallest square that has some, up to five pixels away."""
    filled = signal.copy()
    for i, j in np.argwhere(bad):
        for reach in range(1, 6):
            rows, columns = (slice(max(at - reach, 0), at + reach + 1) for at in (i, j))
            good = ~bad[rows, columns]
            if good.any():
                filled[i, j] = signal[rows, columns][good].mean()
                break
    return filled


def align_frames(frames, camera_map, *, drift):
    """Camera 2 on the pixels of camera 1: light by the spline, variances bilinearly."""
    out = {name: frames[name].values.copy() for name in LIGHT}
    dx, dy = camera_map.displacement_x, camera_map.displacement_y
    turn = camera_map.settings.orientation
    averaging = np.ones(len(drift))
    for n, (x, y) in enumerate(np.asarray(drift, float).tolist()):
        own = {
            name: np.ascontiguousarray(orient(frames[name].values[1, n], turn)) for name in LIGHT
        }
        out["signal"][1, n] = warp(own["signal"], dx, dy, (x, y))
        factor = interpolation_variance_factor(dx + np.float32(x), dy + np.float32(y))
        row, down = locate(dy, np.float32(y), own["flags"].shape[0], 0)
        column, along = locate(dx, np.float32(x), own["flags"].shape[1], 1)
        seen = (row >= 0) & (column >= 0)
        k, m = np.maximum(row, 0), np.maximum(column, 0)
        for name in LIGHT[1:3]:
            image = own[name].astype(float)
            top = image[k, m] + along * (image[k, m + 1] - image[k, m])
            bottom = image[k + 1, m] + along * (image[k + 1, m + 1] - image[k + 1, m])
            out[name][1, n] = np.where(seen, (top + down * (bottom - top)) * factor, np.nan)
        if seen.any():
            averaging[n] = factor[seen].mean(dtype=float)

        # every flag reaches the points that are interpolated from its pixel: 4 x 4 of them
        padded = np.pad(own["flags"], ((1, 2), (1, 2)), mode="edge")
        flags = np.zeros_like(own["flags"])
        for i, j in np.ndindex(4, 4):
            flags |= padded[i : i + flags.shape[0], j : j + flags.shape[1]]
        flags = np.where(seen, flags[k, m], Flag.OUTSIDE_OVERLAP)
        flags = flags | np.where(camera_map.overlap, 0, Flag.OUTSIDE_OVERLAP)
        poor = camera_map.poor | np.isnan(x)
        out["flags"][1, n] = flags | np.where(poor, Flag.POOR_REGISTRATION, 0)
    dims = ("camera", "frame", "y", "x")
    return xr.Dataset(
        {name: (dims, image) for name, image in out.items()}
        | {
            "displacement_std": (("y", "x"), camera_map.displacement_std),
            "interpolation": ("frame", averaging),
        },
        frames.coords,
    )


def locate(field, drift, size, axis):
    """Pixel before each point along an axis and the distance from it; -1 outside the image."""
    shift = field + drift
    known = np.abs(shift) < 1e6
    whole = np.floor(np.where(known, shift, 0))
    part = np.where(known, shift, 0) - whole
    pixel = np.indices(field.shape)[axis] + whole.astype(int)
    last = (pixel == size - 1) & (part == 0)  # reached from the pixel before it
    pixel, part = np.where(last, pixel - 1, pixel), np.where(last, 1, part)
    return np.where(known & (pixel >= 0) & (pixel < size - 1), pixel, -1), part


def compute_ratio(frames, *, no_film_below=0.25, blur=None):
    """Logarithm of camera 2 over camera 1 of one pair with its variances and flags, (y, x)."""
    softening = Softening.of(BlurDifference() if blur is None else blur)
    one, two = (
        soften(frames.signal.values[n, 0].astype(float), frames["flags"].values[n, 0], taps)
        for n, taps in enumerate(softening.taps)
    )
    lit = (one > 0) & (two > 0)
    a, b = np.where(lit, one, np.nan), np.where(lit, two, np.nan)
    kept = np.reshape(softening.factors, (2, 1, 1)) / np.square([a, b])
    repeated = frames.signal_var_fixed.values[:, 0] * kept
    relative = frames.signal_var.values[:, 0] * kept + repeated
    log_ratio = np.log(b / a) + 0.5 * (relative[1] - relative[0]) - softening.excess

    flags = frames["flags"].values[0, 0] | frames["flags"].values[1, 0]
    flags = np.where((flags == 0) & ~lit, Flag.DIM, flags)
    total, of_two = relative.sum(axis=0)[flags == 0].sum(), relative[1][flags == 0].sum()
    dark = find_bubbles(*frames.signal.values[:, 0], share=no_film_below)
    seen = frames.signal.values[1, 0].astype(float)
    shared = (frames.displacement_std.values * log_gradient(seen)) ** 2
    images = (log_ratio, relative.sum(axis=0), repeated.sum(axis=0), shared)
    images = (*images, flags | np.where(dark, Flag.NO_FILM, 0))
    share = of_two / total if total > 0 else 0.0
    lowered = softening.factors[0], softening.factors[1] * float(frames.interpolation[0])
    correlation = (1 - share) / lowered[0] + share / lowered[1]
    dims = ("y", "x")
    variables = {name: (dims, image) for name, image in zip(RATIO, images, strict=True)}
    return xr.Dataset(variables | {"noise_correlation": correlation})


def soften(light, flags, taps):
    """Blur along x and then along y; a neighbour that is flagged has the value of the pixel."""
    blurred = np.where(np.isnan(light), 0, light)
    sound = flags == 0
    for axis, line in zip((1, 0), taps, strict=True):
        middle, total = blurred, blurred.copy()
        for n, weight in enumerate(line, -(line.size // 2)):
            beside = np.clip(np.arange(light.shape[axis]) + n, 0, light.shape[axis] - 1)
            inside = np.arange(light.shape[axis]) + n == beside
            inside = inside[None, :] if axis else inside[:, None]
            used = np.take(sound, beside, axis) & inside
            total = total + weight * np.where(used, np.take(middle, beside, axis) - middle, 0)
        blurred = total
    return np.where(np.isnan(light), np.nan, blurred)


def log_gradient(signal):
    """Size of the gradient of the logarithm of an image by Sobel's operator; 0 at the border."""
    inside = np.zeros(signal.shape)
    if min(signal.shape) < 3:
        return inside
    along = [cv2.Sobel(signal.astype(float), -1, *order) for order in ((1, 0), (0, 1))]
    mean = 0.5 * cv2.filter2D(signal.astype(float), -1, np.outer([1.0, 2, 1], [1, 2, 1]))
    size = np.where(mean > 0, np.hypot(*along) / mean, 0)
    inside[1:-1, 1:-1] = size[1:-1, 1:-1]
    return inside


def find_range(log_ratio, variance, flags, calibration):
    """Mean log ratio about each pixel, and where it lies beyond the measurable range."""
    sound = flags == 0
    around = mean_of_surroundings(log_ratio, sound, width=17, without=5)
    margin = np.float32(CLEAR) * np.sqrt(mean_of_surroundings(variance, sound))
    first, last = calibration.predict_log(calibration.thickness_range).astype(np.float32)
    thinnest, thickest = calibration.predict_log(calibration.covered_range).astype(np.float32)
    beyond = np.zeros(flags.shape, np.uint16)
    with np.errstate(invalid="ignore"):
        beyond[(around < first) | (around - margin < thinnest)] = Flag.BELOW_RANGE
        beyond[(around > last) | (around + margin > thickest)] = Flag.ABOVE_RANGE
    return mean_of_surroundings(log_ratio, sound), beyond


def measure_thickness(ratios, calibration):
    """Maps of one ratio image (y, x)."""
    table = calibration.inverse
    log_ratio, variance, shared = (ratios[name].values for name in (RATIO[0], RATIO[1], RATIO[3]))
    flags = ratios["flags"].values.copy()
    flags[(flags == 0) & (shared > variance)] = Flag.POOR_REGISTRATION
    near, beyond = find_range(log_ratio, variance, flags, calibration)
    flags = np.where(flags == 0, beyond, flags)
    near[flags != 0] = np.nan

    entry = (log_ratio - table.start) / table.step
    last = table.thickness.size - 1
    flags = np.where((flags == 0) & (entry < 0), Flag.BELOW_RANGE, flags)
    flags = np.where((flags == 0) & (entry > last), Flag.ABOVE_RANGE, flags).astype(np.uint16)

    # the slope of a curve at a noisy ratio is correlated with its error
    half_way = 0.5 * (entry + (near - table.start) / table.step)
    entries = np.arange(last + 1)
    rate = np.interp(half_way, entries, table.per_log_ratio)
    own = np.interp(half_way, entries, table.calibration_std)
    images = {
        "thickness": np.interp(entry, entries, table.thickness),
        "thickness_std": rate * np.sqrt(variance),
        "thickness_std_shared": np.sqrt(own**2 + rate**2 * shared),
    }
    dims = ("y", "x")
    maps = {name: (dims, np.where(flags == 0, image, np.nan)) for name, image in images.items()}
    return xr.Dataset({**maps, "flags": (dims, flags), "log_ratio_near": (dims, near)})


def block_light(image, width=8):
    """Mean of square blocks; those at the lower and right edge may be smaller."""
    total, count = image.astype(float), np.ones(image.shape)
    for axis, size in enumerate(image.shape):
        starts = np.arange(0, size, width)
        total, count = (np.add.reduceat(each, starts, axis=axis) for each in (total, count))
    return (total / count).astype(np.float32)


def mean_of_surroundings(image, sound, *, width=9, without=0):
    """Mean of the valid pixels in a square about each pixel; NaN without one."""
    # sums of differences from the median: in single precision, sums of large values lose digits
    middle = np.float32(np.median(image[sound][::97])) if sound.any() else np.float32(0)
    values, count = np.where(sound, image - middle, np.float32(0)), sound.astype(np.float32)
    total, count = (
        sum_over_square(plane, width) - (sum_over_square(plane, without) if without else 0)
        for plane in (values, count)
    )

    valid = count > 0.5  # whole numbers, up to rounding
    return np.where(valid, middle + total / np.maximum(count, 1), np.float32(np.nan))


def sum_over_square(image, width):
    """Sum over a square of a width about each pixel; nothing is added beyond the border."""
    summed = cv2.boxFilter(
        image, -1, (width, width), normalize=False, borderType=cv2.BORDER_CONSTANT
    )
    return np.asarray(summed, np.float32)
