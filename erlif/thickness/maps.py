"""Log ratio to film thickness, and which pixels determine one.

The calibration is read from tables in single precision.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from erlif.calibration import RatioCurve
from erlif.core.arrays import AnyArray, FlagImage, Image
from erlif.core.flags import FLAG_ATTRS
from erlif.core.products import RatioImages, ThicknessMaps, require
from erlif.core.speed.kernels import njit
from erlif.core.variables import FILM
from erlif.thickness.surroundings import PAD, Surroundings, decide, enter_row

_ZERO, _NAN = np.float32(0), np.float32(np.nan)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

# Rows and columns between the pixels whose median is the offset of the sums: some hundreds.
_STEPS = (61, 67)

# Attributes of log_ratio_near, which is in no file.
_NEAR = {"units": "1", "long_name": "mean of log_ratio about the pixel"}


def measure_thickness(ratios: RatioImages, calibration: RatioCurve) -> ThicknessMaps:
    """Convert ratio images to film thickness, pixel by pixel.

    A pixel is flagged, and not extrapolated, where its surroundings lie beyond the measurable range
    (`erlif.thickness.surroundings`) or its own ratio beyond what the fixture covers. It is flagged
    poor_registration where the error of the registration exceeds the noise.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (..., y, x) with log_ratio_var, log_ratio_var_shared and flags.
    calibration : RatioCurve

    Returns
    -------
    ThicknessMaps
        thickness; thickness_std, from the noise of the pixel; thickness_std_shared, from
        calibration and registration, common to all pixels [um]; flags; log_ratio_near, mean log
        ratio about each valid pixel [1].

    Raises
    ------
    ErlifError
        If a variable is missing.

    Examples
    --------
    >>> from erlif.calibration import Calibration
    >>> calibration = Calibration(
    ...     0.65, 0.40, 0.25, 1e-8 * np.eye(3), (0.5, 12.0), (580.0, 610.0), xr.Dataset(), 1.0, ""
    ... )
    >>> image = np.full((16, 16), calibration.predict_log(np.array(4.0)), np.float32)
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (("y", "x"), image),
    ...     "log_ratio_var": (("y", "x"), np.full_like(image, 1e-4)),
    ...     "log_ratio_var_shared": (("y", "x"), np.zeros_like(image)),
    ...     "flags": (("y", "x"), np.zeros(image.shape, np.uint16)),
    ... }))
    >>> maps = measure_thickness(ratios, calibration)
    >>> round(float(maps.thickness[8, 8]), 3)
    4.0

    The standard deviation is that of the log ratio over the slope, 0.25/(e - 1) - 0.4/(e^1.6 - 1):

    >>> slope = 0.25 / np.expm1(0.25 * 4) - 0.40 / np.expm1(0.40 * 4)
    >>> round(float(maps.thickness_std[8, 8] * slope), 4)
    0.01
    """
    require(ratios, "log_ratio", "log_ratio_var", "log_ratio_var_shared", "flags")
    # single precision throughout: its rounding is far below the noise of a pixel
    tables = FilmTables.of(calibration)
    shape = ratios.log_ratio.shape
    thickness, std, std_shared, near = (np.empty(shape, np.float32) for _ in range(4))
    flags = np.empty(shape, np.uint16)
    log_ratio, variance, displaced = (
        np.ascontiguousarray(ratios[name].values, np.float32)
        for name in ("log_ratio", "log_ratio_var", "log_ratio_var_shared")
    )
    for n in np.ndindex(shape[:-2]):
        images = log_ratio[n], variance[n], displaced[n], ratios.flags.values[n]
        # medians of the image keep the digits of the sums over squares
        offset, noise = find_medians(images[0], images[1], images[3])
        surroundings = Surroundings.of(shape[-1], offset=offset, variance=noise)
        maps = thickness[n], std[n], std_shared[n], flags[n]
        _fill_maps(
            images,
            *tables,
            tuple(surroundings),
            tuple(LookUpRows.of(shape[-1])),
            near[n],
            maps,
        )

    dims = ratios.log_ratio.dims
    names = ("thickness", "thickness_std", "thickness_std_shared")
    described = {
        name: (dims, image, FILM[name].attrs)
        for name, image in zip(names, (thickness, std, std_shared), strict=True)
    }
    others = {"log_ratio_near": (dims, near, _NEAR), "flags": (dims, flags, FLAG_ATTRS)}
    return ThicknessMaps(xr.Dataset(described | others, ratios.coords))


class LookUpRows(NamedTuple):
    """Rows of the table look-up that stay in cache, (x,).

    Attributes
    ----------
    around : AnyArray
        Flags by the surroundings.
    near : Image
        Log ratio half-way to the mean of the surroundings; then the rate there.
    entry : AnyArray
        Entry of the tables, for the ratio itself and that near it, (2, x).
    part : Image
        Distance from that entry, (2, x).
    film : Image
        Film at the entry below and above, two numbers for each pixel.
    pairs : AnyArray
        The same of rate and calibration, as pairs in one number.
    slopes : Image
        Memory of `pairs` in single precision.
    own : Image
        Part of the calibration.
    """

    around: AnyArray
    near: Image
    entry: AnyArray
    part: Image
    film: Image
    pairs: AnyArray
    slopes: Image
    own: Image

    @classmethod
    def of(cls, width: int) -> LookUpRows:
        """Empty rows of an image of some width."""
        near, own = (np.empty(width, np.float32) for _ in range(2))
        around, entry = np.empty(width, np.uint16), np.empty((2, width), np.uint32)
        part, film = np.empty((2, width), np.float32), np.empty(2 * width, np.float32)
        pairs = np.empty(2 * width, np.float64)
        return cls(around, near, entry, part, film, pairs, pairs.view(np.float32), own)


def find_medians(log_ratio: Image, variance: Image, flags: FlagImage) -> tuple[float, float]:
    """Median log ratio and variance of some hundred sound pixels, of all where none of them is.

    Parameters
    ----------
    log_ratio, variance, flags : array, (y, x)

    Returns
    -------
    tuple of two float
    """
    for steps in (_STEPS, (1, 1)):
        sample = slice(None, None, steps[0]), slice(None, None, steps[1])
        sound = flags[sample] == 0
        if sound.any():
            images = log_ratio[sample], variance[sample]
            middle, noise = (float(np.median(image[sound])) for image in images)
            return middle, noise
    return 0.0, 0.0


@njit(nogil=True, cache=True, error_model="numpy", inline="always")
def look_up(log_ratio, i, tables, scale, rows):  # type: ignore[no-untyped-def]
    """Entries for the film at the ratio of row i, and for rate and calibration at the row near."""
    _, near, entry, part, film, pairs, _, _ = rows
    films, slopes = tables
    start, per_step, last = scale
    y = _at(i)
    for q in range(2):
        # entry of the table below each value, and the distance from it in entries
        row = _at(q)
        for t in range(near.size):
            x = _at(t)
            place = ((log_ratio[y, x] if q == 0 else near[x]) - start) * per_step
            place = place if place > _ZERO else _ZERO  # NaN becomes 0
            place = place if place < last else last
            below = np.uint32(place)
            entry[row, x] = below
            part[row, x] = place - np.float32(below)
    for t in range(near.size):
        n = entry[_at(0), _at(t)]
        film[_at(2 * t)] = films[_at(n)]
        film[_at(2 * t + 1)] = films[_at(n) + _at(1)]
    for t in range(near.size):
        n = entry[_at(1), _at(t)]
        pairs[_at(2 * t)] = slopes[_at(n)]
        pairs[_at(2 * t + 1)] = slopes[_at(n) + _at(1)]


@njit(nogil=True, cache=True, error_model="numpy", inline="always")
def fill_maps(variance, displaced, i, rows, maps):  # type: ignore[no-untyped-def]
    """Fill row i of the maps; NaN where it is flagged."""
    _, rate, _, part, film, _, slopes, own = rows
    thickness, std, std_shared, flags = maps
    y, first, second = _at(i), _at(0), _at(1)

    # few rows a loop: more would need more comparisons of addresses than the compiler accepts
    for t in range(flags.shape[1]):
        x = _at(t)
        below = film[_at(2 * t)]
        value = below + part[first, x] * (film[_at(2 * t + 1)] - below)
        thickness[y, x] = value if flags[y, x] == 0 else _NAN
    for t in range(flags.shape[1]):
        x = _at(t)
        below, also = slopes[_at(4 * t)], slopes[_at(4 * t + 1)]
        rate[x] = below + part[second, x] * (slopes[_at(4 * t + 2)] - below)
        own[x] = also + part[second, x] * (slopes[_at(4 * t + 3)] - also)

    # the maps may be in the memory of the ratio, which loops in vector registers do not expect
    for t in range(flags.shape[1]):
        x = _at(t)
        film[x] = rate[x] * np.sqrt(variance[y, x]) if flags[y, x] == 0 else _NAN
    for t in range(flags.shape[1]):
        x = _at(t)
        shared = np.sqrt(own[x] * own[x] + rate[x] * rate[x] * displaced[y, x])
        own[x] = shared if flags[y, x] == 0 else _NAN
    for t in range(flags.shape[1]):
        x = _at(t)
        std[y, x] = film[x]
    for t in range(flags.shape[1]):
        x = _at(t)
        std_shared[y, x] = own[x]


@njit(nogil=True, cache=True, error_model="numpy")
def _fill_maps(  # type: ignore[no-untyped-def]
    images, scale, tables, limits, surroundings, rows, near, maps
):
    """Fill the maps, and the mean log ratio about each pixel.

    The film pass of the pipeline does the same, and sums over blocks beside it.
    """
    log_ratio, variance, displaced, _ = images
    bits_around, half_way, flags = rows[0], rows[1], maps[3]
    for u in range(log_ratio.shape[0] + PAD):
        enter_row(images, u, surroundings)

        # row i is in the middle of the squares
        i = u - PAD
        if i >= 0:
            decide(log_ratio, i, limits, surroundings, bits_around, half_way, flags)
            for j in range(log_ratio.shape[1]):
                mean = half_way[j] + (half_way[j] - log_ratio[i, j])
                near[i, j] = mean if bits_around[j] == 0 else _NAN
            look_up(log_ratio, i, tables, scale, rows)
            fill_maps(variance, displaced, i, rows, maps)


class FilmTables(NamedTuple):
    """Tables of a calibration for the film pass, in single precision.

    Attributes
    ----------
    scale : tuple[np.float32, np.float32, np.float32]
        Log ratio at the first entry of the tables, one over the distance of the entries, and the
        largest number below that of the last entry. [1]
    films : tuple[Image, AnyArray]
        Film thickness, (entry,) [um]. Its derivative by the log ratio [um] and its standard
        deviation due to the calibration [um], two numbers in the memory of one, read at once.
    limits : Image
        Log ratios of the calibrated range, of what the fixture covers, and the first and last one
        that the tables hold, (6,). [1]
    """

    scale: tuple[np.float32, np.float32, np.float32]
    films: tuple[Image, AnyArray]
    limits: Image

    @classmethod
    def of(cls, calibration: RatioCurve) -> FilmTables:
        """Tables of a calibration.

        Parameters
        ----------
        calibration : RatioCurve

        Returns
        -------
        FilmTables
        """
        table = calibration.inverse
        ranges = *calibration.thickness_range, *calibration.covered_range

        # the first and last number in single precision that lie between the ends of the tables
        end = table.start + table.step * (table.thickness.size - 1)
        first, last = np.float32(table.start), np.float32(end)
        if float(first) < table.start:
            first = np.nextafter(first, np.float32(np.inf))
        while (float(last) - table.start) / table.step > table.thickness.size - 1:
            last = np.nextafter(last, np.float32(-np.inf))
        entries = np.nextafter(np.float32(table.thickness.size - 1), np.float32(0))
        slopes = np.stack([table.per_log_ratio, table.calibration_std], axis=-1).astype(np.float32)
        return cls(
            (np.float32(table.start), np.float32(1 / table.step), entries),
            (table.thickness.astype(np.float32), slopes.ravel().view(np.float64)),
            np.append(calibration.predict_log(ranges), [first, last]).astype(np.float32),
        )

    def growing_to(
        self, last: FilmTables, passed: float, middle: FilmTables | None = None
    ) -> FilmTables:
        """Tables when a share of a run has passed, between those of its first and its last frame.

        Parameters
        ----------
        last : FilmTables
            Of the same calibration; the error that grows from nothing is there at its full size.
        passed : float
            Share of the run. [1]
        middle : FilmTables, optional
            At half of the run, where what grows is correlated with what does not.

        Returns
        -------
        FilmTables
        """
        slopes, end = (tables.films[1].view(np.float32).copy() for tables in (self, last))
        fixed, whole = slopes[1::2] ** 2, end[1::2] ** 2
        if middle is None:
            variance = fixed + passed**2 * np.maximum(whole - fixed, 0.0)
        else:
            # a parabola of the share
            half = middle.films[1].view(np.float32)[1::2] ** 2
            bend = 2 * (fixed + whole - 2 * half)
            variance = fixed + passed * (whole - fixed - bend) + passed**2 * bend
        slopes[1::2] = np.sqrt(np.maximum(variance, 0.0))
        return self._replace(films=(self.films[0], slopes.view(np.float64)))
