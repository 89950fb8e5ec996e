"""The ratio field smoothed as far as its noise asks for and its steps allow; never done unless it is asked for.

At every pixel a plane is fitted to the logarithm of the ratio about it, with weights 1/variance times a Gaussian window, and read
off at the pixel: local linear regression (Fan and Gijbels, Local Polynomial Modelling, 1996, section 2.3). Its weights
reproduce planes exactly, also beside a hole and at the border of the image, and the variance that remains is the sum of their
squares times the variances of the pixels. A film steps where a bushing is grooved or worn, and a window that reaches over a
step would round it. So the plane is set against a plane with a step, whose noise is known: first, everywhere, with a step
through the pixel along x or along y; then, about every pixel where that is significant, with steps at all distances within the
window and in sixteen directions. Where the best of these is significant, the plane is fitted to this pixel's side of it alone
(one-sided windows after Gijbels, Lambert and Qiu, IEEE Trans. Pattern Anal. Mach. Intell. 28 (2006) 1075, who choose the side by
the residuals). Significant is against random noise and registration error together.

Neighbours are correlated after smoothing, over about the resolution: a mean over smoothed pixels does not gain by their number.
Where camera 2 was interpolated they are a little correlated before; by how much is measured from what the smoothing took off,
and the remaining variance is raised by it.
The denoisers of scikit-image and OpenCV take neither a variance for each pixel nor missing pixels, hence own code.
"""

from __future__ import annotations

import math

import cv2
import numba
import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Image, Mask
from erlif.core.errors import ModelError
from erlif.core.products import RatioImages, require

_SUSPECT = (
    3.5  # standard deviations of a step through a pixel from which on it is looked at closely
)


_SIGNIFICANT = (
    4.5  # standard deviations from which on a step counts, found among hundreds in a window
)


_DIRECTIONS = 16
_LAG = 2  # pixels over which neighbours may share noise before smoothing
_FLAT = 1e-3  # determinant, relative to its diagonal, below which the pixels about a pixel carry no plane


# Rows of the table of taps, d being the distance from the middle: the window times 1, d, d^2 (0 to 2), its square times the
# same (3 to 5), and the window times the sign of d and times |d| (6, 7).
# What is summed along y: of the weights (0), of weights times data (1), of the doubt (2), and with which taps.
_DOWN = np.array(
    [(0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (0, 5), (1, 0), (1, 1), (0, 6), (0, 7), (1, 6), (2, 0)]
)


# Which of these is summed along x, and with which taps.
_ACROSS = np.array(
    [
        *(
            (0, 0),
            (0, 1),
            (1, 0),
            (0, 2),
            (1, 1),
            (2, 0),
        ),  # normal matrix of a plane: 1, x, y, x^2, xy, y^2
        *(
            (3, 3),
            (3, 4),
            (4, 3),
            (3, 5),
            (4, 4),
            (5, 3),
        ),  # the same with the window squared, for the variance
        *((6, 0), (6, 1), (7, 0)),  # data: 1, x, y
        *((0, 6), (0, 7), (1, 6), (6, 6)),  # a step along x: with 1, x, y and data
        *((8, 0), (8, 1), (9, 0), (10, 0)),  # a step along y
        (11, 0),  # doubt
    ]
)


def smooth_ratio(ratios: RatioImages, *, resolution: float) -> RatioImages:
    """Smooth ratio images, keeping steps and holes.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (..., y, x) with log_ratio_var, log_ratio_var_shared and flags. Flagged pixels take no part.
    resolution : float
        Full width at half maximum of the Gaussian window, at least 2. [px]

    Returns
    -------
    RatioImages
        log_ratio; log_ratio_var, the random part that remains, and of it log_ratio_var_fixed where given. Both carry the
        attribute `resolution` [px], over which neighbours are now correlated. log_ratio_var_shared and flags are unchanged, and
        so is a flagged pixel or one whose surroundings carry no plane.

    Raises
    ------
    ModelError
        If the resolution is below 2 px, where the window holds little but its own pixel.
    """
    require(ratios, "log_ratio", "log_ratio_var", "log_ratio_var_shared", "flags")
    if not (math.isfinite(resolution) and resolution >= 2):
        raise ModelError(
            f"Smoothing needs a resolution of at least 2 px; got {resolution:g}. Leave it out for no smoothing."
        )
    taps, step_noise = _gaussian_window(resolution)
    images = (-1, *ratios.log_ratio.shape[-2:])
    value, variance, shared = (
        np.ascontiguousarray(ratios[name].values, np.float32).reshape(images)
        for name in ("log_ratio", "log_ratio_var", "log_ratio_var_shared")
    )
    sound = (ratios.flags.values.reshape(images) == 0) & np.isfinite(value) & (variance > 0)
    smooth, remaining = value.copy(), variance.copy()
    for n in range(value.shape[0]):
        if sound[n].any():
            _smooth_image(
                value[n],
                variance[n],
                shared[n],
                sound[n],
                taps,
                step_noise,
                smooth[n],
                remaining[n],
            )
    answer = {"log_ratio": smooth, "log_ratio_var": remaining}
    if "log_ratio_var_fixed" in ratios:
        left = np.divide(remaining, variance, out=np.ones_like(variance), where=sound)
        answer["log_ratio_var_fixed"] = left * ratios.log_ratio_var_fixed.values.reshape(images)
    return RatioImages(
        ratios.assign(
            {
                name: ratios[name]
                .copy(data=image.reshape(ratios[name].shape))
                .assign_attrs(resolution=float(resolution))
                for name, image in answer.items()
            }
        )
    )


def _gaussian_window(resolution: float) -> tuple[Image, float]:
    """Taps of the window along one axis, and the variance of a step over what least squares would give it."""
    sigma = resolution / math.sqrt(8 * math.log(2))
    reach = math.ceil(2.5 * sigma)
    d = np.arange(-reach, reach + 1, dtype=float)
    window = np.exp(-0.5 * (d / sigma) ** 2)
    step = np.where(d >= 0, 1.0, -1.0)
    taps = np.stack(
        [
            *(window * d**n for n in range(3)),
            *(window**2 * d**n for n in range(3)),
            window * step,
            window * d * step,
        ]
    )
    line = np.stack([np.ones_like(d), d])
    rest = step - line.T @ np.linalg.solve(window * line @ line.T, line @ (window * step))
    noise = (
        (window**2).sum() / window.sum() * (window**2 * rest**2).sum() / (window * rest**2).sum()
    )
    return taps.astype(np.float32), float(noise)


def _smooth_image(
    value: Image,
    variance: Image,
    shared: Image,
    sound: Mask,
    taps: Image,
    step_noise: float,
    smooth: Image,
    remaining: Image,
) -> None:
    """Smooth one image into the last two arguments, which hold it unsmoothed."""
    reach = taps.shape[1] // 2
    middle = np.median(value[sound][::97])  # single precision is kept for what differs
    planes = _weigh(value, variance, shared, sound, middle, reach)
    suspect = np.zeros(value.shape, np.uint8)
    _fit_planes(
        planes, taps, _DOWN, _ACROSS, _SUSPECT**2 * step_noise, middle, smooth, remaining, suspect
    )
    factor = _correlation_factor(value, variance, smooth, sound, taps[0])
    distances, limit = _distances(reach), _SIGNIFICANT**2 * factor
    places = np.argwhere(suspect)
    on_step = np.zeros(value.shape, np.uint8)
    on_step[tuple(places[_find_steps(planes, distances, places, limit)].T)] = 1
    if on_step.any():
        near = cv2.dilate(on_step, np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)).astype(bool)
        places = np.argwhere(near & sound)
        _fit_one_side(
            planes, taps[0], distances, places, limit, value, variance, middle, smooth, remaining
        )
        factor = _correlation_factor(
            value, variance, smooth, sound, taps[0]
        )  # freed of what the steps fed into it
    remaining[remaining < variance] *= factor


def _correlation_factor(
    value: Image, variance: Image, smooth: Image, sound: Mask, window: Image
) -> float:
    """By how much the variance of a mean over the window exceeds that of independent pixels; 1 if that is not significant.

    What smoothing takes off the pixels, r = n - S n for noise n and smoother S, has the autocovariance of n convolved with that
    of 1 - S. The latter is known, so that of n follows, taken to be zero beyond `_LAG` pixels.
    """
    every = max(1, value.size // 400_000)
    sums, pairs = _correlate(value, variance, smooth, sound, _LAG, every)
    if pairs < 1000:
        return 1.0
    kernel = window.astype(float) / window.sum(dtype=float)
    spread = 4 * _LAG
    line = {"once": np.zeros(2 * spread + 1), "twice": np.zeros(2 * spread + 1)}
    for name, values in (("once", kernel), ("twice", np.convolve(kernel, kernel))):
        half = min(spread, values.size // 2)
        line[name][spread - half : spread + half + 1] = values[
            values.size // 2 - half : values.size // 2 + half + 1
        ]
    once, twice = (np.outer(values, values) for values in line.values())
    taken_off = twice - 2 * once
    taken_off[spread, spread] += 1
    lags = np.array([(y, x) for y in range(-_LAG, _LAG + 1) for x in range(-_LAG, _LAG + 1)])
    apart = lags[:, None] - lags + spread
    covariance = np.linalg.solve(taken_off[apart[..., 0], apart[..., 1]], sums.ravel())
    share = twice[lags[:, 0] + spread, lags[:, 1] + spread] / twice[spread, spread]
    factor = float(covariance @ share / covariance[lags.shape[0] // 2])
    noise = math.sqrt(2 * ((share**2).sum() - 1) / pairs)
    return factor if factor > 1 + 3 * noise else 1.0


def _distances(reach: int) -> npt.NDArray[np.int64]:
    """Distance of each pixel of the window from a line through its middle, for each direction of the line. [px/2]"""
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    angle = np.arange(_DIRECTIONS)[:, None, None] * np.pi / _DIRECTIONS
    return np.asarray(np.rint(2 * (x * np.cos(angle) + y * np.sin(angle))), np.int64)


@numba.njit(nogil=True, cache=True)
def _weigh(value, variance, shared, sound, middle, reach):  # type: ignore[no-untyped-def]
    """Weights, weights times data, and variance with the registration over that without; 0 where a pixel is not sound.

    All have a margin of `reach` pixels.
    """
    height, width = value.shape
    planes = np.zeros((3, height + 2 * reach, width + 2 * reach), np.float32)
    for i in range(height):
        for j in range(width):
            if sound[i, j]:
                w = 1.0 / variance[i, j]
                planes[0, i + reach, j + reach] = w
                planes[1, i + reach, j + reach] = w * (value[i, j] - middle)
                planes[2, i + reach, j + reach] = 1.0 + (
                    shared[i, j] * w if shared[i, j] > 0 else 0.0
                )
    return planes


@numba.njit(nogil=True, cache=True)
def _add(out, row, factor):  # type: ignore[no-untyped-def]
    for j in range(out.size):
        out[j] += factor * row[j]


@numba.njit(nogil=True, cache=True)
def _invert_normal(m0, mx, my, mxx, mxy, myy):  # type: ignore[no-untyped-def]
    """Inverse of the normal matrix of a plane, in the order of the arguments; all 0 if the pixels carry no plane."""
    a, b, c = mxx * myy - mxy * mxy, mxy * my - mx * myy, mx * mxy - mxx * my
    determinant = m0 * a + mx * b + my * c
    if not determinant > _FLAT * m0 * mxx * myy:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    d, e, f = m0 * myy - my * my, mx * my - m0 * mxy, m0 * mxx - mx * mx
    return (
        a / determinant,
        b / determinant,
        c / determinant,
        d / determinant,
        e / determinant,
        f / determinant,
    )


@numba.njit(nogil=True, cache=True)
def _gain_of_step(inverse, z0, zx, zy, s0, sx, sy, zs, ss):  # type: ignore[no-untyped-def]
    """By how much a step lowers the sum of squares of a plane; z, s are the products of 1, x, y with the data and the step."""
    a, b, c, d, e, f = inverse
    p0, px, py = a * s0 + b * sx + c * sy, b * s0 + d * sx + e * sy, c * s0 + e * sx + f * sy
    rest = ss - (s0 * p0 + sx * px + sy * py)
    if not rest > _FLAT * ss:
        return 0.0
    return (zs - (z0 * p0 + zx * px + zy * py)) ** 2 / rest


@numba.njit(nogil=True, cache=True)
def _fit_planes(planes, taps, down, across, limit, middle, smooth, remaining, suspect):  # type: ignore[no-untyped-def]
    """Fit a plane about every pixel, and mark where a step through the pixel, along x or y, would fit better.

    The window is a function of y times one of x, so that sums over it are taken along y, then along x.
    """
    height, width = smooth.shape
    reach = taps.shape[1] // 2
    full = taps[0].sum() ** 2
    columns = np.empty((down.shape[0], planes.shape[2]), np.float32)
    sums = np.empty((across.shape[0], width), np.float32)
    s = np.empty(across.shape[0])
    for i in range(height):
        columns[:] = 0.0
        for k in range(down.shape[0]):
            for t in range(taps.shape[1]):
                _add(columns[k], planes[down[k, 0], i + t], taps[down[k, 1], t])
        sums[:] = 0.0
        for k in range(across.shape[0]):
            for t in range(taps.shape[1]):
                _add(sums[k], columns[across[k, 0], t : t + width], taps[across[k, 1], t])
        for j in range(width):
            if planes[0, i + reach, j + reach] == 0.0:
                continue
            for k in range(s.size):
                s[k] = sums[k, j]
            inverse = _invert_normal(s[0], s[1], s[2], s[3], s[4], s[5])
            a, b, c = inverse[:3]
            left = (
                a * a * s[6]
                + b * b * s[9]
                + c * c * s[11]
                + 2 * (a * b * s[7] + a * c * s[8] + b * c * s[10])
            )
            if not 0.0 < left < remaining[i, j]:
                continue
            smooth[i, j] = middle + a * s[12] + b * s[13] + c * s[14]
            remaining[i, j] = left
            along_x = _gain_of_step(inverse, s[12], s[13], s[14], s[15], s[16], s[17], s[18], s[0])
            along_y = _gain_of_step(inverse, s[12], s[13], s[14], s[19], s[20], s[21], s[22], s[0])
            if max(along_x, along_y) > limit * max(s[23] / full, 1.0):
                suspect[i, j] = 1


@numba.njit(nogil=True, cache=True)
def _correlate(value, variance, smooth, sound, lag, every):  # type: ignore[no-untyped-def]
    """Autocovariance of what was taken off, in standard deviations, up to `lag`; and from how many pixels."""
    height, width = value.shape
    sums = np.zeros((2 * lag + 1, 2 * lag + 1))
    pixels = 0
    rest = np.full((height, width), np.nan, np.float32)
    for i in range(height):
        for j in range(width):
            if sound[i, j]:
                r = (value[i, j] - smooth[i, j]) / np.sqrt(variance[i, j])
                if abs(r) < 5.0:
                    rest[i, j] = r
    for i in range(lag, height - lag, every):
        for j in range(lag, width - lag):
            near = rest[i - lag : i + lag + 1, j - lag : j + lag + 1]
            if np.isfinite(near.sum()):
                pixels += 1
                for k in range(2 * lag + 1):
                    for m in range(2 * lag + 1):
                        sums[k, m] += near[lag, lag] * near[k, m]
    return (sums + sums[::-1, ::-1]) / (2 * max(pixels, 1)), pixels


@numba.njit(nogil=True, cache=True)
def _find_steps(planes, distances, places, limit):  # type: ignore[no-untyped-def]
    """Whether there is a significant step about each of the given pixels."""
    taps = distances.shape[1]
    found = np.zeros(places.shape[0], np.bool_)
    for n in range(places.shape[0]):
        i, j = places[n]
        surroundings = planes[:, i : i + taps, j : j + taps]
        found[n] = _cut_at_step(surroundings, distances, limit, surroundings[0] > 0.0)
    return found


@numba.njit(nogil=True, cache=True)
def _fit_one_side(  # type: ignore[no-untyped-def]
    planes, window, distances, places, limit, value, variance, middle, smooth, remaining
):
    """Fit a plane to what lies on the side of the given pixels, cutting their surroundings at steps until none is significant."""
    taps = window.size
    for n in range(places.shape[0]):
        i, j = places[n]
        surroundings = planes[:, i : i + taps, j : j + taps]
        kept = surroundings[0] > 0.0
        cuts = 0
        while _cut_at_step(surroundings, distances, limit, kept):
            cuts += 1
        if cuts == 0:
            continue
        m, square, z, _ = _sum_over(surroundings, kept, window)
        a, b, c = _invert_normal(m[0], m[1], m[2], m[3], m[4], m[5])[:3]
        left = a * a * square[0] + b * b * square[3] + c * c * square[5]
        left += 2 * (a * b * square[1] + a * c * square[2] + b * c * square[4])
        if 0.0 < left < variance[i, j]:
            smooth[i, j] = middle + a * z[0] + b * z[1] + c * z[2]
            remaining[i, j] = left
        else:
            smooth[i, j] = value[i, j]
            remaining[i, j] = variance[i, j]


@numba.njit(nogil=True, cache=True)
def _sum_over(surroundings, kept, window):  # type: ignore[no-untyped-def]
    """Over the kept pixels: 1, x, y, x^2, xy, y^2 with the window, the same with its square, 1, x, y times data, and the doubt."""
    taps = window.size
    reach = taps // 2
    m, square, z, doubt = np.zeros(6), np.zeros(6), np.zeros(3), 0.0
    powers = np.empty(6)
    for u in range(taps):
        for v in range(taps):
            if kept[u, v]:
                y, x, k = u - reach, v - reach, window[u] * window[v]
                powers[0], powers[1], powers[2] = 1.0, x, y
                powers[3], powers[4], powers[5] = x * x, x * y, y * y
                for q in range(6):
                    product = k * surroundings[0, u, v] * powers[q]
                    m[q] += product
                    square[q] += k * product
                for q in range(3):
                    z[q] += k * surroundings[1, u, v] * powers[q]
                doubt += surroundings[2, u, v]
    return m, square, z, doubt


@numba.njit(nogil=True, cache=True)
def _cut_at_step(surroundings, distances, limit, kept):  # type: ignore[no-untyped-def]
    """Drop what lies beyond the most significant step of what is kept; says whether there was one."""
    taps = kept.shape[0]
    reach = taps // 2
    m, _, z, doubt = _sum_over(surroundings, kept, np.ones(taps, np.float32))
    inverse = _invert_normal(m[0], m[1], m[2], m[3], m[4], m[5])
    if inverse[0] == 0.0:
        return False
    best, direction, place = limit * doubt / kept.sum(), -1, 0
    farthest = distances.max()
    lines = np.empty((2 * farthest + 1, 4))
    for k in range(distances.shape[0]):
        lines[:] = 0.0
        for u in range(taps):
            for v in range(taps):
                if kept[u, v]:
                    w = surroundings[0, u, v]
                    line = lines[distances[k, u, v] + farthest]
                    line[0] += w
                    line[1] += w * (v - reach)
                    line[2] += w * (u - reach)
                    line[3] += surroundings[1, u, v]
        s0, sx, sy, zs = 0.0, 0.0, 0.0, 0.0
        for t in range(2 * farthest, 0, -1):
            if lines[t, 0] == 0.0:
                continue
            s0 += lines[t, 0]
            sx += lines[t, 1]
            sy += lines[t, 2]
            zs += lines[t, 3]
            gain = _gain_of_step(inverse, z[0], z[1], z[2], s0, sx, sy, zs, s0)
            if gain > best:
                best, direction, place = gain, k, t - farthest
    if direction < 0:
        return False
    for u in range(taps):
        for v in range(taps):
            if (distances[direction, u, v] >= place) != (place <= 0):
                kept[u, v] = False
    return True
