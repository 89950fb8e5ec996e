"""The rate at which the pin moves, from its measured positions at the triggers.

The rate is that of a smooth path through the positions, with the covariance of both.

The path is a spline whose third derivative is penalised. The penalty is that of the largest
posterior density: a spline with a random third derivative (Wahba 1983), whose standard deviation is
not zero beforehand. So noise and what the path may do between the triggers and at its ends enter
the covariance, also where the positions fit a parabola.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from erlif.core.arrays import Array, Mask
from erlif.core.errors import ModelError
from erlif.core.statistics import covariance_root

# Numbers of a position: two displacements, then two tilts, towards the load and sideways.
NUMBERS = 4

# A quarter of a turn of displacement and tilt, from the load towards the side.
_QUARTER = np.kron(np.eye(2), np.array([[0.0, -1.0], [1.0, 0.0]]))


@dataclass(frozen=True)
class PinMotion:
    """Position and rate of the pin at every trigger, with their errors.

    Attributes
    ----------
    time : Array
        Rising, (trigger,). [s]
    angle : Array
        Of the bushing from the middle of its swing, (trigger,). [rad]
    position : Array
        Displacements towards the load and sideways [m], tilts [m/m], (trigger, number).
    rate : Array
        Of the same numbers, (trigger, number). [m/s, 1/s]
    turning : Array
        Speed of rotation of the bushing, positive where its surface moves along sliding,
        (trigger,). [rad/s]
    random_root : Array
        Root of the covariance of position and rate by noise, (trigger, 2 number, cause): causes are
        independent, of unit variance, and the same at all triggers.
    shared_root : Array
        By what all triggers share, surfaces and calibration; as random_root.
    noise_scale : Array
        Scatter of the positions about a smooth path over the stated one, (number,).
    period : float or None
        Of a turn of the crank; None for a turn of evenly spaced triggers. [s]
    recorded : Mask or None
        Which of the times are triggers, (trigger,); None where all are. At the others the motion is
        predicted (`erlif.prediction.gaps`).
    otherwise : PinMotion or None
        The motion at the same times by the triggers alone, where some are no triggers.
    """

    time: Array
    angle: Array
    position: Array
    rate: Array
    turning: Array
    random_root: Array
    shared_root: Array
    noise_scale: Array
    period: float | None = None
    recorded: Mask | None = None
    otherwise: PinMotion | None = None

    @property
    def sunk(self) -> Array:
        """Change of the position in a turn, where the path is joined to the next one. (number,)"""
        step = self.turn - (self.time[-1] - self.time[0])
        return np.asarray(
            self.position[-1] + step / 2 * (self.rate[-1] + self.rate[0]) - self.position[0]
        )

    def at(self, time: Array) -> tuple[Array, Array]:
        """Position and rate at times of the turn from the first trigger on, (time, number)."""
        from scipy.interpolate import CubicHermiteSpline  # loads scipy.optimize

        path = CubicHermiteSpline(
            np.append(self.time, self.time[0] + self.turn),
            np.vstack([self.position, self.position[0] + self.sunk]),
            np.vstack([self.rate, self.rate[0]]),
        )
        return path(time), path.derivative()(time)

    @property
    def turn(self) -> float:
        """Duration of a turn of the crank. [s]"""
        even = float(self.time[-1] - self.time[0] + np.median(np.diff(self.time)))
        return even if self.period is None else self.period

    @property
    def widest_gap(self) -> float:
        """Largest part of a turn without a trigger, from turn to turn. [1]"""
        last = self.turn - float(self.time[-1] - self.time[0])
        return max(float(np.diff(self.time).max()), last) / self.turn

    @property
    def random_cov(self) -> Array:
        """Covariance of position and rate by noise, (trigger, 2 number, 2 number)."""
        return np.asarray(self.random_root @ np.swapaxes(self.random_root, 1, 2))

    @property
    def shared_cov(self) -> Array:
        """Covariance by what all triggers share, the same shape."""
        return np.asarray(self.shared_root @ np.swapaxes(self.shared_root, 1, 2))


def find_pin_motion(
    time: Array,
    angle: Array,
    turning: Array,
    position: Array,
    *,
    random_cov: Array,
    surface_cov: Array | None = None,
    gradient: Array | None = None,
    calibration_cov: Array | None = None,
    period: float | None = None,
) -> PinMotion:
    """Find the rate of the pin from its positions at the triggers.

    Errors that are the same at all triggers, those of marks on the surfaces, cancel in the rate.
    A pin that is free sideways swings with half the angle of the bushing: the path is smoothed
    after as much of this swing is taken off as the positions show.

    Parameters
    ----------
    time : array, (trigger,)
        Rising. [s]
    angle : array, (trigger,)
        Of the bushing from the middle of its swing, positive where its surface moves along sliding.
        [rad]
    turning : array, (trigger,)
        Rate of the angle. [rad/s]
    position : array, (trigger, number)
        Displacements towards the load and sideways [m], tilts [m/m].
    random_cov : array, (trigger, number, number)
        Covariance by noise.
    surface_cov : array, (trigger, number, number), optional
        By marks of the surfaces, the same at all triggers.
    gradient : array, (trigger, number, parameter), optional
        Change of the position with the parameters of the calibration.
    calibration_cov : array, (parameter, parameter), optional
        Their covariance.
    period : float, optional
        As of `PinMotion`. [s]

    Returns
    -------
    PinMotion

    Raises
    ------
    ModelError
        As `smooth_path`.

    Examples
    --------
    A pin that sinks by 0.6 um/s, with noise of 5 nm:

    >>> time = np.linspace(0.0, 0.5, 25)
    >>> noise = np.diag([5e-9, 50e-9, 1e-9, 1e-9]) ** 2
    >>> position = np.zeros((25, 4))
    >>> position[:, 0] = 225e-6 + 0.6e-6 * time
    >>> found = find_pin_motion(time, 0 * time, 0 * time, position,
    ...                         random_cov=np.broadcast_to(noise, (25, 4, 4)))
    >>> (found.rate[12, 0] * 1e6).round(3)
    np.float64(0.6)
    """
    share = _swing_with_bushing(time, angle, position)
    turn = _turn_to_load(share * angle / 2)
    back = np.swapaxes(turn, 1, 2)
    path = smooth_path(time, _on(back, position), back @ random_cov @ turn)

    # back to the image, in which the swing adds to the rate
    spin = share * turning[:, None, None] / 2 * (turn @ _QUARTER)
    whole = np.block([[turn, np.zeros_like(turn)], [spin, turn]])
    both = _on(whole, np.concatenate([path.value, path.rate], axis=1))
    shared = [np.zeros((time.size, 2 * NUMBERS, 0))]
    if surface_cov is not None:
        # the marks are the same at all triggers, each of which shows how large they are
        marks = np.zeros((time.size, 2 * NUMBERS, NUMBERS))
        marks[:, :NUMBERS] = covariance_root(surface_cov.mean(axis=0))
        shared.append(marks)
    if gradient is not None and calibration_cov is not None:
        shared.append(whole @ path.carry(back @ gradient) @ covariance_root(calibration_cov))
    return PinMotion(
        time=time,
        angle=angle,
        position=both[:, :NUMBERS],
        rate=both[:, NUMBERS:],
        turning=turning,
        random_root=whole @ path.root,
        shared_root=np.concatenate(shared, axis=2),
        noise_scale=path.noise_scale,
        period=period,
    )


def _swing_with_bushing(time: Array, angle: Array, position: Array) -> float:
    """Share of half the angle of the bushing with which the pin swings: 1 if free, 0 if guided."""
    swing = position[:, 0] * np.sin(angle / 2)
    columns = np.stack([np.ones_like(time), time - time.mean(), swing], axis=1)
    scale = np.abs(columns).max(axis=0)
    if not (scale > 0).all():
        return 0.0
    found = np.linalg.lstsq(columns / scale, position[:, 1], rcond=None)[0] / scale
    return float(np.clip(found[2], 0.0, 1.0))


def _turn_to_load(angle: Array) -> Array:
    """Rotation of displacement and tilt, (trigger, number, number)."""
    cosine, sine = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    return np.asarray(cosine * np.eye(NUMBERS) + sine * _QUARTER)


def _on(matrices: Array, vectors: Array) -> Array:
    """Product of a matrix and a vector at each trigger."""
    return np.asarray(np.einsum("tij,tj->ti", matrices, vectors))


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
