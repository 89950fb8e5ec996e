"""Planes fitted to the neighbourhood of each pixel, on one side of a step where there is one.

The kernels of `erlif.ratio.smoothing`, compiled together. Pixels are passed as `weigh_pixels` makes
them: three planes with a margin of the reach of the window, 1/variance, data/variance, and
the variance with registration over that without; all are 0 where a pixel is not valid.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from erlif.core.speed.kernels import njit

# Directions of a step that are tried, evenly over half a turn.
DIRECTIONS = 16

# Determinant relative to its diagonal below which the pixels determine no plane or no step.
_SINGULAR = 1e-3

# The window is a function of y times one of x, so that sums over it are taken along y, then along
# x. Rows of the table of taps, d being the distance from the middle:
#   0, 1, 2: the window times 1, d, d^2
#   3, 4, 5: its square times 1, d, d^2
#   6, 7: the window times the sign of d, times |d|

# Sums along y: the plane of the pixels, and the taps.
_DOWN = np.array(
    [
        *((0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (0, 5)),  # weights, for a plane and its variance
        *((1, 0), (1, 1)),  # data
        *((0, 6), (0, 7), (1, 6)),  # weights and data with a step along y
        (2, 0),  # share of the registration
    ]
)

# Sums along x: the row of `_DOWN`, and the taps.
_ACROSS = np.array(
    [
        *((0, 0), (0, 1), (1, 0), (0, 2), (1, 1), (2, 0)),  # normal matrix: 1, x, y, x^2, xy, y^2
        *((3, 3), (3, 4), (4, 3), (3, 5), (4, 4), (5, 3)),  # the same with the window squared
        *((6, 0), (6, 1), (7, 0)),  # data: 1, x, y
        *((0, 6), (0, 7), (1, 6), (6, 6)),  # a step along x with 1, x, y and data
        *((8, 0), (8, 1), (9, 0), (10, 0)),  # a step along y with 1, x, y and data
        (11, 0),  # share of the registration
    ]
)


def step_distances(reach: int) -> npt.NDArray[np.int64]:
    """Distance of each pixel of a window from lines through its middle.

    Parameters
    ----------
    reach : int
        Pixels from the middle of the window to its edge. [px]

    Returns
    -------
    array, (direction, y, x)
        In half pixels, rounded. [px/2]

    Examples
    --------
    The first line is vertical, and distances from it are those along x:

    >>> step_distances(1)[0].tolist()
    [[-2, 0, 2], [-2, 0, 2], [-2, 0, 2]]
    """
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    angle = np.arange(DIRECTIONS)[:, None, None] * np.pi / DIRECTIONS
    return np.asarray(np.rint(2 * (x * np.cos(angle) + y * np.sin(angle))), np.int64)


@njit(nogil=True, cache=True)
def weigh_pixels(value, variance, shared, sound, middle, reach):  # type: ignore[no-untyped-def]
    """Pixels as the fits read them.

    Parameters
    ----------
    value, variance, shared : array, (y, x)
        Log ratio, its variance, and the variance by the registration. [1]
    sound : array of bool, (y, x)
        Valid pixels.
    middle : float
        Subtracted from the values: single precision is kept for their differences. [1]
    reach : int
        Width of the margin. [px]

    Returns
    -------
    array, (3, y + 2 reach, x + 2 reach)
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


@njit(nogil=True, cache=True)
def fit_planes(  # type: ignore[no-untyped-def]
    planes, taps, limit, middle, smooth, remaining, suspect
):
    """Fit a plane about every pixel, and mark where a step through the pixel would fit better.

    Parameters
    ----------
    planes : array
        Pixels by `weigh_pixels`.
    taps : array, (8, position)
        The window along one axis.
    limit : float
        Reduction of the sum of squares by a step along x or y from which on a pixel is marked. [1]
    middle : float
        Added to the values. [1]
    smooth, remaining : array, (y, x)
        Values and their variance, replaced where there is a plane with a smaller variance. [1]
    suspect : array, (y, x)
        Set to 1 where a step may be.
    """
    height, width = smooth.shape
    reach = taps.shape[1] // 2
    full = taps[0].sum() ** 2
    columns = np.empty((_DOWN.shape[0], planes.shape[2]), np.float32)
    sums = np.empty((_ACROSS.shape[0], width), np.float32)

    # sums about one pixel, in the order of _ACROSS
    s = np.empty(_ACROSS.shape[0])
    normal, squared, data, by_x, by_y = s[:6], s[6:12], s[12:15], s[15:19], s[19:23]
    for i in range(height):
        _sum_row(planes, taps, i, columns, sums)
        for j in range(width):
            if planes[0, i + reach, j + reach] == 0.0:
                continue
            for k in range(s.size):
                s[k] = sums[k, j]

            inverse = _invert_normal(normal)
            left = _plane_variance(inverse, squared)
            if not 0.0 < left < remaining[i, j]:
                continue
            a, b, c = inverse[:3]
            smooth[i, j] = middle + a * data[0] + b * data[1] + c * data[2]
            remaining[i, j] = left

            along_x = _gain_of_step(inverse, data, by_x[0], by_x[1], by_x[2], by_x[3], s[0])
            along_y = _gain_of_step(inverse, data, by_y[0], by_y[1], by_y[2], by_y[3], s[0])
            if max(along_x, along_y) > limit * max(s[23] / full, 1.0):
                suspect[i, j] = 1


@njit(nogil=True, cache=True)
def _sum_row(planes, taps, i, columns, sums):  # type: ignore[no-untyped-def]
    """Fill the sums over the window for one row of pixels: along y, then along x."""
    width = sums.shape[1]
    columns[:] = 0.0
    for k in range(_DOWN.shape[0]):
        for t in range(taps.shape[1]):
            _add(columns[k], planes[_DOWN[k, 0], i + t], taps[_DOWN[k, 1], t])

    sums[:] = 0.0
    for k in range(_ACROSS.shape[0]):
        for t in range(taps.shape[1]):
            _add(sums[k], columns[_ACROSS[k, 0], t : t + width], taps[_ACROSS[k, 1], t])


@njit(nogil=True, cache=True)
def _add(out, row, factor):  # type: ignore[no-untyped-def]
    for j in range(out.size):
        out[j] += factor * row[j]


@njit(nogil=True, cache=True)
def _invert_normal(normal):  # type: ignore[no-untyped-def]
    """Inverse of the normal matrix of a plane, both as 1, x, y, x^2, xy, y^2; 0 if singular."""
    m0, mx, my = normal[0], normal[1], normal[2]
    mxx, mxy, myy = normal[3], normal[4], normal[5]
    a, b, c = mxx * myy - mxy * mxy, mxy * my - mx * myy, mx * mxy - mxx * my
    determinant = m0 * a + mx * b + my * c
    if not determinant > _SINGULAR * m0 * mxx * myy:
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


@njit(nogil=True, cache=True)
def _plane_variance(inverse, squared):  # type: ignore[no-untyped-def]
    """Variance of a plane at the middle: the sum of its squared weights times the variances."""
    a, b, c = inverse[:3]
    left = a * a * squared[0] + b * b * squared[3] + c * c * squared[5]
    return left + 2 * (a * b * squared[1] + a * c * squared[2] + b * c * squared[4])


@njit(nogil=True, cache=True)
def _gain_of_step(inverse, data, s0, sx, sy, zs, ss):  # type: ignore[no-untyped-def]
    """Reduction of the sum of squares of a plane by a step.

    `s0`, `sx`, `sy`, `zs` and `ss` are the products of the step with 1, x, y, the data and itself.
    """
    a, b, c, d, e, f = inverse
    p0, px, py = a * s0 + b * sx + c * sy, b * s0 + d * sx + e * sy, c * s0 + e * sx + f * sy
    rest = ss - (s0 * p0 + sx * px + sy * py)
    if not rest > _SINGULAR * ss:
        return 0.0
    return (zs - (data[0] * p0 + data[1] * px + data[2] * py)) ** 2 / rest


@njit(nogil=True, cache=True)
def find_steps(planes, distances, places, limit):  # type: ignore[no-untyped-def]
    """Find the pixels with a significant step in their window.

    Parameters
    ----------
    planes : array
        Pixels by `weigh_pixels`.
    distances : array, (direction, y, x)
        By `step_distances`.
    places : array, (pixel, 2)
        Row and column of the pixels that are looked at.
    limit : float
        Reduction of the sum of squares from which on a step is significant. [1]

    Returns
    -------
    array of bool, (pixel,)
    """
    taps = distances.shape[1]
    steps = np.zeros(places.shape[0], np.bool_)
    for n in range(places.shape[0]):
        i, j = places[n]
        surroundings = planes[:, i : i + taps, j : j + taps]
        steps[n] = _cut_at_step(surroundings, distances, limit, surroundings[0] > 0.0)
    return steps


@njit(nogil=True, cache=True)
def fit_one_side(  # type: ignore[no-untyped-def]
    planes, window, distances, places, limit, value, variance, middle, smooth, remaining
):
    """Fit planes to the pixels on one side of the steps in the window.

    The window is cut at steps until none is significant. Pixels without a step keep their plane.

    Parameters
    ----------
    planes, distances, places, limit
        As for `find_steps`.
    window : array, (position,)
        The window along one axis.
    value, variance : array, (y, x)
        The pixels alone, which replace a plane that is not determined or not better. [1]
    middle : float
        Added to the values. [1]
    smooth, remaining : array, (y, x)
        Values and their variance, replaced at the pixels with a step. [1]
    """
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

        normal, squared, data, _ = _sum_over(surroundings, kept, window)
        inverse = _invert_normal(normal)
        left = _plane_variance(inverse, squared)
        if 0.0 < left < variance[i, j]:
            a, b, c = inverse[:3]
            smooth[i, j] = middle + a * data[0] + b * data[1] + c * data[2]
            remaining[i, j] = left
        else:
            smooth[i, j] = value[i, j]
            remaining[i, j] = variance[i, j]


@njit(nogil=True, cache=True)
def _sum_over(surroundings, kept, window):  # type: ignore[no-untyped-def]
    """Sums over the kept pixels.

    1, x, y, x^2, xy, y^2 with the window; the same with its square; 1, x, y times the data with the
    window; and the sum of the variances with registration over those without.
    """
    taps = window.size
    reach = taps // 2
    normal, squared, data, registration = np.zeros(6), np.zeros(6), np.zeros(3), 0.0
    powers = np.empty(6)
    for u in range(taps):
        for v in range(taps):
            if not kept[u, v]:
                continue
            y, x, k = u - reach, v - reach, window[u] * window[v]
            powers[0], powers[1], powers[2] = 1.0, x, y
            powers[3], powers[4], powers[5] = x * x, x * y, y * y

            for q in range(6):
                product = k * surroundings[0, u, v] * powers[q]
                normal[q] += product
                squared[q] += k * product
            for q in range(3):
                data[q] += k * surroundings[1, u, v] * powers[q]
            registration += surroundings[2, u, v]
    return normal, squared, data, registration


@njit(nogil=True, cache=True)
def _cut_at_step(surroundings, distances, limit, kept):  # type: ignore[no-untyped-def]
    """Drop the pixels beyond the most significant step; return whether there was one."""
    taps = kept.shape[0]
    normal, _, data, registration = _sum_over(surroundings, kept, np.ones(taps, np.float32))
    inverse = _invert_normal(normal)
    if inverse[0] == 0.0:
        return False

    # the limit rises where the registration adds to the noise
    best, direction, place = limit * registration / kept.sum(), -1, 0
    farthest = distances.max()
    lines = np.empty((2 * farthest + 1, 4))
    for k in range(distances.shape[0]):
        _sum_along_lines(surroundings, distances[k], kept, lines)

        # a step at line t is the sum of all lines from t on
        s0, sx, sy, zs = 0.0, 0.0, 0.0, 0.0
        for t in range(2 * farthest, 0, -1):
            if lines[t, 0] == 0.0:
                continue
            s0 += lines[t, 0]
            sx += lines[t, 1]
            sy += lines[t, 2]
            zs += lines[t, 3]
            gain = _gain_of_step(inverse, data, s0, sx, sy, zs, s0)
            if gain > best:
                best, direction, place = gain, k, t - farthest

    if direction < 0:
        return False
    for u in range(taps):
        for v in range(taps):
            # the middle of the window, at distance 0, lies on the side that is kept
            if (distances[direction, u, v] >= place) != (place <= 0):
                kept[u, v] = False
    return True


@njit(nogil=True, cache=True)
def _sum_along_lines(surroundings, distance, kept, lines):  # type: ignore[no-untyped-def]
    """Fill the sums of weights times 1, x, y and of the weighted data, for each distance."""
    taps = kept.shape[0]
    reach = taps // 2
    farthest = lines.shape[0] // 2
    lines[:] = 0.0
    for u in range(taps):
        for v in range(taps):
            if kept[u, v]:
                w = surroundings[0, u, v]
                line = lines[distance[u, v] + farthest]
                line[0] += w
                line[1] += w * (v - reach)
                line[2] += w * (u - reach)
                line[3] += surroundings[1, u, v]
