"""The rate at which the pin moves, from its measured positions at the triggers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.core.statistics import covariance_root
from erlif.prediction.smoothing import smooth_path

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
