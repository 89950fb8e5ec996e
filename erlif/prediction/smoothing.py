"""A smooth path of the pin through its measured positions, with its rate and their covariance.

The path is a spline whose third derivative is penalised. The penalty is that of the largest
posterior density: a spline with a random third derivative (Wahba 1983), whose standard deviation
is not zero beforehand. So noise and what the path may do between the triggers and at its
ends enter the covariance, also where the positions fit a parabola.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from erlif.core.arrays import Array
from erlif.core.errors import ModelError

# Positions from which a rate is found: a parabola has three numbers, a scatter needs more.
FEWEST = 5

_DEGREE = 4  # of the spline: its rate has a continuous second derivative
_DIFFERENCE = 3  # order of the differences that are penalised; a parabola is free
_MOST_INTERVALS = 48  # intervals between knots: of one cycle, they follow 16 oscillations

# Penalties that are compared, over the one at which penalty and data are of equal weight.
_PENALTIES = np.logspace(-8, 8, 65)

# Scatter over the stated standard deviation, up to 128, that is compared.
_SCALES = np.sqrt(2.0) ** np.arange(15)

# Power of 1/penalty in the prior of the penalty: half of that which is even in the standard
# deviation of the third derivative. With the likelihood alone, a parabola counts as certain where
# the noise hides the difference, and the rate at the ends is off by 1.4 of its standard deviations;
# of 0.1, 0.25 and 0.5 this is the first with which it is within one (docs/theory/pressure.md).
_EVEN = 0.25

# Gain of log likelihood from which the scatter is taken to be larger than stated (e^3 to 1).
_DECISIVE = 3.0


@dataclass(frozen=True)
class SmoothPath:
    """A path through measured positions.

    Attributes
    ----------
    value : Array
        Position on the path, (time, parameter).
    rate : Array
        Its rate, (time, parameter).
    root : Array
        Root of the covariance of values and then rates at all times, (time, 2 parameter, cause):
        causes are independent and of unit variance.
    weights : Array
        Change of values and then rates with each measured position, (time, 2 parameter, measured,
        parameter).
    noise_scale : Array
        Scatter of the positions about the path over the stated one, (parameter,); 1 unless the
        scatter is larger beyond doubt.
    """

    value: Array
    rate: Array
    root: Array
    weights: Array
    noise_scale: Array

    @property
    def covariance(self) -> Array:
        """Of values and then rates at each time, (time, 2 parameter, 2 parameter)."""
        return np.asarray(self.root @ np.swapaxes(self.root, 1, 2))

    def carry(self, columns: Array) -> Array:
        """Change of values and rates with something that changes all positions.

        Parameters
        ----------
        columns : array, (time, parameter, cause)
            Change of each measured position with each cause.

        Returns
        -------
        array, (time, 2 parameter, cause)
        """
        return np.asarray(np.einsum("tpmk,mkc->tpc", self.weights, columns))


def smooth_path(time: Array, position: Array, covariance: Array) -> SmoothPath:
    """Lay a smooth path through measured positions.

    Parameters
    ----------
    time : array, (time,)
        Rising, `FEWEST` or more. [s]
    position : array, (time, parameter)
        Measured, finite.
    covariance : array, (time, parameter, parameter)
        Of the part of their error that is new at every time, finite.

    Returns
    -------
    SmoothPath
        At the same times.

    Raises
    ------
    ModelError
        If times do not rise, or a covariance is not one.

    Notes
    -----
    Penalised splines: Eilers and Marx, Stat. Sci. 11 (1996) 89. Covariance: Wahba, J. R. Stat. Soc.
    B 45 (1983) 133; averaged over the times its intervals have their nominal coverage.

    Examples
    --------
    >>> time = np.linspace(0.0, 0.5, 11)
    >>> path = smooth_path(time, 3 * time[:, None], np.full((11, 1, 1), 1e-4))
    >>> path.rate[5].round(3), np.sqrt(path.covariance[5, 1, 1]).round(3)
    (array([3.]), np.float64(0.038))
    """
    count, parameters = position.shape
    if not (np.diff(time) > 0).all():
        raise ModelError(
            "Expected rising times of the positions; they fall or repeat. Take each once, in order."
        )
    if not (np.linalg.eigvalsh(covariance)[:, 0] > 0).all():
        raise ModelError(
            "Expected covariances of positions that are positive definite; at least one is not. "
            "Leave out positions without a standard deviation."
        )
    middle = position.mean(axis=0)
    basis, slope = _lay_basis(time)
    size = basis.shape[1]
    differences = np.diff(np.eye(size), _DIFFERENCE, axis=0)
    roughness = differences.T @ differences

    # how rough the path of each parameter is, and how far the positions scatter about it
    penalty, scale = np.empty(parameters), np.ones(parameters)
    for k in range(parameters):
        penalty[k], scale[k] = _choose_penalty(
            basis, roughness, position[:, k] - middle[k], covariance[:, k, k]
        )

    # all parameters together; errors of one time are correlated
    precision = np.linalg.inv(covariance * scale * scale[:, None])
    normal = np.einsum("tkl,ti,tj->kilj", precision, basis, basis)
    for k in range(parameters):
        normal[k, :, k] += penalty[k] * roughness
    normal = normal.reshape(parameters * size, -1)
    pull = np.einsum("tkl,ti->kitl", precision, basis).reshape(parameters * size, -1)

    # unknowns of order one: a parameter in um and one in um/mm stand side by side
    unit = 1 / np.sqrt(np.diag(normal))
    factor = cholesky(normal * unit * unit[:, None], lower=True)
    root = solve_triangular(factor, np.eye(parameters * size), lower=True).T * unit[:, None]
    gain = (root @ (root.T @ pull)).reshape(parameters, size, count, parameters)
    causes = root.reshape(parameters, size, -1)

    both = np.stack([basis, slope])  # value, rate
    weights = np.einsum("dti,kimn->tdkmn", both, gain)
    path = np.einsum("tdkmn,mn->dtk", weights, position - middle)
    spread = np.einsum("dti,kic->tdkc", both, causes)
    return SmoothPath(
        value=path[0] + middle,
        rate=path[1],
        root=spread.reshape(count, 2 * parameters, -1),
        weights=weights.reshape(count, 2 * parameters, count, parameters),
        noise_scale=scale,
    )


def _lay_basis(time: Array) -> tuple[Array, Array]:
    """Splines and their derivatives at the times, (time, spline)."""
    intervals = min(time.size - 1, _MOST_INTERVALS)
    step = (time[-1] - time[0]) / intervals
    knots = time[0] + step * np.arange(-_DEGREE, intervals + _DEGREE + 1)
    from scipy.interpolate import BSpline  # loads scipy.optimize, which processing does not need

    splines = BSpline(knots, np.eye(intervals + _DEGREE), _DEGREE)
    return np.asarray(splines(time)), np.asarray(splines.derivative()(time))


def _choose_penalty(
    basis: Array, roughness: Array, values: Array, variance: Array
) -> tuple[float, float]:
    """Penalty of the largest posterior density, and scatter over the stated one."""
    weight = 1 / variance
    data = basis.T @ (weight[:, None] * basis)
    ratio = float(np.trace(data) / np.trace(roughness))

    # in these axes both data and roughness are diagonal, so that a trial costs nothing
    rough, axes = eigh(roughness * ratio, data + roughness * ratio)
    rough = np.clip(rough, 0.0, 1.0)
    rough[:_DIFFERENCE] = 0.0  # parabolas
    seen = 1 - rough
    moment = axes.T @ (basis.T @ (weight * values))
    square = float(values @ (weight * values))

    def likelihood(scale: float) -> Array:
        total = seen / scale**2 + _PENALTIES[:, None] * rough
        explained = ((moment / scale**2) ** 2 / total).sum(axis=1)
        penalised = len(rough) - _DIFFERENCE
        return np.asarray(
            0.5 * penalised * np.log(_PENALTIES)
            - 0.5 * np.log(total).sum(axis=1)
            - values.size * np.log(scale)
            - 0.5 * (square / scale**2 - explained)
        )

    table = np.array([likelihood(scale) for scale in _SCALES])
    best = table.max(axis=1)
    chosen = int(best.argmax())
    if best[chosen] < best[0] + _DECISIVE:
        chosen = 0
    density = table[chosen] - _EVEN * np.log(_PENALTIES)
    return float(_PENALTIES[density.argmax()] * ratio), float(_SCALES[chosen])
