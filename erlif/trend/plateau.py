"""Central and minimum film of an elastic contact: a plateau with a constriction at its edge.

The load flattens the bodies over an ellipse. Its film is nearly even, with a constriction in the
shape of a horseshoe at outlet and sides; beyond its edge the film rises steeply. The outline is an
ellipse through the places where the film is two to four times that of the plateau. Within it the
film is a sum of splines of the distance rho from the centre, over that of the outline, times
cos(k theta), k = 0 to 4, with theta about the centre: symmetric about the direction of sliding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy

from erlif.core.arrays import Array, Mask
from erlif.trend.block_fit import BlockMeans, sum_by_strips
from erlif.trend.curve import FilmCurve
from erlif.trend.number import FilmNumber

_RING = (2.0, 4.0)  # films of the outline, over that of the plateau [1]
_THIN = 0.05  # quantile of the films from which the search for the outline begins
_LEAST_RING = 16  # blocks that determine an ellipse
_ROUNDS = 8  # of the search, and of the weights

# Ends of the splines in rho; the solved constrictions lie between 0.5 and 0.85. [1]
_KNOTS = np.array([0, 0.2, 0.4, 0.55, 0.65, 0.75, 0.85, 0.95, 1.15])
_COARSE = _KNOTS[::2]
_HARMONICS = 4
_SEARCHED = 0.95  # rho within which the minimum lies
_STEPS = 77  # of the search along either axis: about 0.025, a quarter of the closest knots
_CENTRE = 0.15  # rho over which the central film is averaged
_OFF = 0.1  # rho by which the centre of the outline may be off that of the dry contact

# Of the change of the minimum from splines of twice the width: that by still narrower ones, if the
# error of a spline is of third order, and what is an error of the minimum.
_FINER, _RESOLUTION = 1 / 7, 1 / 2

_TOLERATED = 1 / 3  # error above which a minimum is not stated, over it [1]
_THICKEST = 5.0  # film of a block that is fitted, over that of the plateau [1]
_OUTLIER = 5.0  # departure beyond which a block does not count [std]
_TAIL = 0.9  # quantile of the departures by which their variance is found: 1.645 std
_TINY = 1e-6  # share of their mean by which the squares of the splines are raised: those unseen
_DRAWS = 200  # of the errors, for the bias of a minimum
_INNER = 0.5  # rho within which the film is that of the plateau, in the search for the outline
_PLACES = 4  # of a block along either side, at which the splines are averaged


class Plateau(NamedTuple):
    """Central and minimum film of an elastic contact.

    Attributes
    ----------
    minimum : FilmNumber
        NaN where the region does not hold the whole contact, or where its own error is above a
        third of it.
    central : FilmNumber
    along, across : float
        Place of the minimum, from -1 to 1 over the region.
    """

    minimum: FilmNumber
    central: FilmNumber
    along: float
    across: float


class _Outline(NamedTuple):
    """Ellipse about the plateau, from -1 to 1 over the region: centre, half axes, and its film."""

    centre: Array
    axes: Array
    film: float

    def place(self, along: Array, across: Array) -> tuple[Array, Array]:
        """Places over the half axes, from the centre."""
        (s, z), (a, b) = self.centre, self.axes
        return (along - s) / a, (across - z) / b

    def position(self, along: Array, across: Array) -> tuple[Array, Array]:
        """Positions over the region; of both sides of the axis, that nearer to its middle."""
        (s, z), (a, b) = self.centre, self.axes
        left, right = z - across * b, z + across * b
        return s + along * a, np.where(np.abs(left) < np.abs(right), left, right)


def find_plateau(
    blocks: BlockMeans, gradient: Callable[[Array, Mask], Array], curve: FilmCurve
) -> Plateau | None:
    """Central and minimum film of an elastic contact in the means of the blocks of a region.

    The minimum is that of the fitted film. Noise and marks make it too low, as the thinnest of many
    places is chosen; the mean over 200 draws of these errors is taken out. Splines of twice the
    width change it by more than still narrower ones would: a seventh of that change is added, and
    half of it is part of its error.

    Parameters
    ----------
    blocks : BlockMeans
    gradient : callable
        Change of the log ratio with each parameter of the calibration, (parameter, block), from
        films [um], (block,), and the mask of their blocks.
    curve : FilmCurve

    Returns
    -------
    Plateau or None
        None where no plateau has an outline, or its middle is not in the region.

    Examples
    --------
    An even film has no outline:

    >>> from erlif.show.plots import example_calibration
    >>> calibration = example_calibration()
    >>> s, z = (one.ravel() for one in np.meshgrid(np.linspace(-1, 1, 20), np.linspace(-1, 1, 16)))
    >>> strips = [((one + 1) * 7).astype(int) for one in (z, s)]
    >>> ratio = np.full(s.size, calibration.predict_log(3.0))
    >>> blocks = BlockMeans(ratio, 1e-6 + 0 * s, s, s**2, z, z**2, *strips)
    >>> find_plateau(blocks, None, FilmCurve.of(calibration)) is None
    True
    """
    value = blocks.log_ratio
    place, off = curve.find_bins(value)
    film, rate = curve.film[place] + curve.rate[place] * off, curve.rate[place]
    known = (value > curve.bins[0]) & (value < curve.bins[1])
    outline = _find_outline(blocks.along[known], blocks.across[known], film[known], film.max())
    if outline is None:
        return None
    s, z = outline.place(blocks.along, blocks.across)
    use = known & (np.hypot(s, z) < _KNOTS[-1]) & (film < _THICKEST * outline.film)
    variance = (rate**2 * blocks.variance)[use]
    fit, coarse = (
        _fit(blocks, outline, use, film[use], variance, knots) for knots in (_KNOTS, _COARSE)
    )
    if fit is None or coarse is None:
        return None

    # half of the contact stands for both
    even = np.linspace(-_SEARCHED, _SEARCHED, _STEPS)
    along, across = np.meshgrid(even, even[even >= 0])
    within = np.hypot(along, across) < _SEARCHED
    along, across = along[within], across[within]
    shapes = _splines(along, across, _KNOTS)
    found = fit.amplitudes @ shapes
    lowest = int(np.argmin(found))
    change = found[lowest] - (coarse.amplitudes @ _splines(along, across, _COARSE)).min()

    by_block = -gradient(film[use], use) * rate[use]
    middle = np.hypot(along, across) < _CENTRE
    beside = _splines(np.array([-_OFF, _OFF]), np.zeros(2), _KNOTS)
    steep = float(fit.amplitudes @ (beside[:, 1] - beside[:, 0])) / 2
    central = fit.number(shapes[:, middle].mean(axis=1), by_block, steep)
    minimum = fit.number(shapes[:, lowest], by_block, _RESOLUTION * change)

    # a contact that the region cuts may have its minimum outside
    s, z = outline.position(along, across)
    own = math.hypot(minimum.random_std, minimum.surface_std)
    if np.maximum(np.abs(s), np.abs(z)).max() > 1 or own > _TOLERATED * minimum.value:
        unknown = FilmNumber.unknown(curve.parameters)
        return Plateau(unknown, central, math.nan, math.nan)
    corrected = minimum.value - fit.bias(shapes) + _FINER * change
    return Plateau(minimum._replace(value=corrected), central, s[lowest], z[lowest])


def _find_outline(along: Array, across: Array, film: Array, thickest: float) -> _Outline | None:
    """Ellipse through the blocks of a ring about the plateau, whose film is that of its middle."""
    level = float(np.quantile(film, _THIN)) if film.size else math.nan
    for _ in range(_ROUNDS):
        low, high = _RING
        ring = (film > low * level) & (film < min(high * level, thickest))
        if ring.sum() < _LEAST_RING:
            return None
        s, z = along[ring], across[ring]
        shapes = np.stack([s**2, z**2, s, z])
        squares, slopes = np.split(np.linalg.lstsq(shapes.T, np.ones(s.size))[0], 2)
        if (squares <= 0).any():
            return None
        centre = -slopes / (2 * squares)
        axes = np.sqrt((1 + squares @ centre**2) / squares)
        outline = _Outline(centre, axes, level)
        s, z = outline.place(along, across)
        inner = np.hypot(s, z) < _INNER
        if not inner.any():
            return None
        level = float(np.median(film[inner]))

    # of a plateau the ring goes all round
    sides = [[(one[ring] < 0).any(), (one[ring] > 0).any()] for one in (s, z)]
    if not np.all(sides) or (np.abs(centre) > 1).any():
        return None
    return outline._replace(film=level)


def _splines(along: Array, across: Array, knots: Array) -> Array:
    """Shapes of the film at places over the half axes, (shape, *place)."""
    rho, theta = np.hypot(along, across), np.arctan2(across, along)
    ends = np.pad(knots, 3, mode="edge")
    within = np.minimum(rho.ravel(), knots[-1])
    radial = scipy.interpolate.BSpline.design_matrix(within, ends, 3).toarray().T
    radial = radial.reshape(-1, *rho.shape)

    # at the centre the film is smooth: even in rho, and without the harmonics
    even = np.concatenate([radial[:1] + radial[1:2], radial[2:]])
    others = [radial[min(k, 2) :] * np.cos(k * theta) for k in range(1, _HARMONICS + 1)]
    return np.concatenate([even, *others])


class _Fit(NamedTuple):
    """Film fitted to blocks: amplitudes, and their change with the film of each block."""

    amplitudes: Array
    pull: Array  # (shape, block)
    residual: Array  # enlarged by what the fit absorbs [um]
    variance: Array  # of the blocks, by noise [um2]
    excess: float  # by the surfaces [um2]
    strips: Sequence[npt.NDArray[np.intp]]

    def number(self, at: Array, by_block: Array, form: float) -> FilmNumber:
        """The sum of the amplitudes times `at`; `form` is the error by the shapes. [um]

        `by_block` is the change of its film with each parameter, (parameter, block).
        """
        pull = at @ self.pull
        random = float(pull**2 @ self.variance)
        score = (pull * self.residual)[None]
        total = max(float(sum_by_strips(score, strip)[0, 0]) for strip in self.strips)
        surface = max(total - random, self.excess * float(pull @ pull))
        own = math.hypot(math.sqrt(surface), form)
        return FilmNumber(float(at @ self.amplitudes), math.sqrt(random), own, by_block @ pull)

    def bias(self, shapes: Array) -> float:
        """Mean by which the minimum over the places of `shapes` is too low. [um]"""
        root = self.pull * np.sqrt(self.variance + self.excess)
        values, vectors = np.linalg.eigh(root @ root.T)
        draws = np.random.default_rng(0).normal(size=(len(values), _DRAWS))
        errors = (vectors * np.sqrt(np.maximum(values, 0.0))) @ draws
        found = self.amplitudes @ shapes
        return float((found[:, None] + shapes.T @ errors).min(axis=0).mean() - found.min())


def _fit(
    blocks: BlockMeans, outline: _Outline, use: Mask, film: Array, variance: Array, knots: Array
) -> _Fit | None:
    """Fit splines to the films of blocks by least squares, without outliers."""
    # the constriction is about as wide as a block: its shapes are averaged over each
    even = (2 * np.arange(_PLACES) + 1) / _PLACES - 1
    spread = even / math.sqrt(float(np.mean(even**2)))
    means = (blocks.along, blocks.along_squared), (blocks.across, blocks.across_squared)
    wide = [np.sqrt(np.maximum(square - mean**2, 0.0)) for mean, square in means]
    steps = np.stack(np.meshgrid(spread, spread)).reshape(2, -1, 1)
    along, across = (
        mean[use] + step * width[use]
        for (mean, _), step, width in zip(means, steps, wide, strict=True)
    )
    shapes = _splines(*outline.place(along, across), knots).mean(axis=1)

    counted, excess = np.ones(film.size, bool), 0.0
    for _ in range(_ROUNDS):
        if counted.sum() < 2 * len(shapes):
            return None
        weight = counted / (variance + excess)
        squares = (shapes * weight) @ shapes.T
        squares += _TINY * np.trace(squares) / len(squares) * np.eye(len(squares))
        pull = np.linalg.solve(squares, shapes * weight)
        residual = film - (pull @ film) @ shapes
        excess = max(float(np.quantile((residual / 1.645) ** 2 - variance, _TAIL)), 0.0)
        counted = np.abs(residual) < _OUTLIER * np.sqrt(variance + excess)
    free = 1 - len(shapes) / int((weight > 0).sum())
    strips = [
        np.unique(strip[use], return_inverse=True)[1]
        for strip in (blocks.strip_along, blocks.strip_across)
    ]
    return _Fit(pull @ film, pull, residual / math.sqrt(free), variance, excess, strips)
