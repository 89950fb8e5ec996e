"""Friction of a pin in a bushing: torque ratios and friction coefficients.

The torque ratio T* of a pressure distribution is the friction torque over mu F R. It exceeds 1
because friction acts along the whole arc while only the pressure along the line of load carries;
the closed forms are those of Colbert et al. (2009).

Arguments that are off by orders of magnitude raise `erlif.core.errors.UnitWarning`.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula

# Torque ratio of a bushing worn to its steady state. Colbert et al. (2009), eq. A6. [1]
#
# The pressure is a cosine over half the shaft. The source prints 1.25 for this limit of its
# equation; the limit is 1.2732, and 1.25 belongs to 86.6 degrees.
STEADY_WEAR_TORQUE_RATIO = 4 / np.pi

# Half angle below which the series of the thin Winkler bushing is exact to rounding. [rad]
_SERIES_BELOW = 0.03


@formula(load="load or zero", radius="length")
def friction_torque(
    friction: Values, *, load: Values, radius: Values, torque_ratio: Values = 1.0
) -> Values:
    """Compute the torque that turns a loaded shaft. Colbert et al. (2009), eqs. 1 and 4.

    T = T* mu F R.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    friction, radius : float or array
        Friction coefficient mu [1], radius R of the shaft [m].
    torque_ratio : float or array
        T* of the pressure distribution; 1 takes the contact for a line, as Farzaneh (2002),
        appendix A.3, does. [1]

    Returns
    -------
    float or array
        Friction torque T. [N m]

    Notes
    -----
    Farzaneh (2002) computes its torque with a pin radius of 1.25 in; the pin has 33.36 mm, which
    makes it 5 % larger.

    Examples
    --------
    The machine of Farzaneh (2002) at 100,000 lbf, with the radius of the source:

    >>> print(f"{friction_torque(0.15, load=444.822e3, radius=1.25 * 0.0254):.1f} N m")
    2118.5 N m
    """
    return torque_ratio * friction * load * radius


@formula(torque="signed number", radius="length")
def friction_coefficient(
    torque: Values, *, load: Values, radius: Values, torque_ratio: Values = 1.0
) -> Values:
    """Compute the friction coefficient from a torque. Colbert et al. (2009), eqs. 1, 4 and B6.

    mu = T / (T* F R).

    Parameters
    ----------
    load : float or array
        Load F. [N]
    torque : float or array
        Friction torque T; its sign is kept. [N m]
    radius : float or array
        Radius R of the shaft. [m]
    torque_ratio : float or array
        T* of the pressure distribution. With 1 the result is the apparent coefficient mu' of the
        source, which is at least the true one. [1]

    Returns
    -------
    float or array
        Friction coefficient mu. [1]

    Examples
    --------
    PTFE with 0.105 on a flat has 0.134 in a worn bushing; Colbert et al. (2009) measured 0.131.

    >>> from erlif.joint.models.friction import STEADY_WEAR_TORQUE_RATIO, friction_torque
    >>> torque = friction_torque(
    ...     0.105, load=400.0, radius=0.005, torque_ratio=STEADY_WEAR_TORQUE_RATIO
    ... )
    >>> print(f"{friction_coefficient(torque, load=400.0, radius=0.005):.3f}")
    0.134
    """
    return torque / (torque_ratio * load * radius)


@formula()
def uniform_torque_ratio(half_angle: Values) -> Values:
    """Compute T* of a uniform pressure over an arc. Colbert et al. (2009), eq. 4.

    alpha / sin alpha, pi/2 at 90 degrees.

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]

    Returns
    -------
    float or array
        Torque ratio T*. [1]

    Examples
    --------
    The source prints 1.57 for half the shaft:

    >>> print(f"{uniform_torque_ratio(np.pi / 2):.2f}")
    1.57
    """
    return 1 / _sinc(half_angle)


@formula()
def cosine_torque_ratio(half_angle: Values) -> Values:
    """Compute T* of the pressure cos(pi theta / 2 alpha). Colbert et al. (2009), eq. A6.

    (pi^2 - 4 alpha^2) / (pi^2 cos alpha).

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]

    Returns
    -------
    float or array
        Torque ratio T*. [1]

    Notes
    -----
    The limit at 90 degrees is 4/pi = 1.2732; the source prints 1.25.

    Examples
    --------
    10/9 at 60 degrees, 4/pi at 90 degrees:

    >>> print(f"{cosine_torque_ratio(np.pi / 3):.4f} {cosine_torque_ratio(np.pi / 2):.4f}")
    1.1111 1.2732
    """
    # with the rest of the right angle, cos alpha = sin rest and pi - 2 alpha = 2 rest: the factor
    # that makes the fraction 0/0 at 90 degrees cancels
    rest = np.pi / 2 - half_angle
    return 2 * (np.pi + 2 * half_angle) / (np.pi**2 * _sinc(rest))


@formula()
def elliptic_torque_ratio(half_angle: Values) -> Values:
    """Compute T* of the pressure sqrt(1 - (theta/alpha)^2). Colbert et al. (2009), section 3.

    alpha / (2 J1(alpha)).

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]

    Returns
    -------
    float or array
        Torque ratio T*. [1]

    Examples
    --------
    >>> from scipy.special import j1
    >>> print(f"{elliptic_torque_ratio(np.pi / 2):.6f} {np.pi / 4 / j1(np.pi / 2):.6f}")
    1.385612 1.385612
    """
    # 2 J1(x) / x without the 0/0 at zero
    return 1 / scipy.special.hyp0f1(2.0, -(half_angle**2) / 4)


@formula()
def truncated_cosine_torque_ratio(half_angle: Values) -> Values:
    """Compute T* of the pressure cos theta cut off at the ends of the arc.

    sin a / (a/2 + sin(2a)/4), 4/pi at 90 degrees; from Colbert et al. (2009), eq. 4.

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]

    Returns
    -------
    float or array
        Torque ratio T*. [1]

    Examples
    --------
    At 60 degrees it is sqrt(3)/2 over pi/6 + sqrt(3)/8:

    >>> closed = np.sqrt(3) / 2 / (np.pi / 6 + np.sqrt(3) / 8)
    >>> print(f"{truncated_cosine_torque_ratio(np.pi / 3):.6f} {closed:.6f}")
    1.170138 1.170138
    """
    # sines over angles keep the limit of 1 at zero
    return 2 * _sinc(half_angle) / (1 + _sinc(2 * half_angle))


@formula()
def thin_winkler_torque_ratio(half_angle: Values) -> Values:
    """Compute mu* of a Winkler bushing with a thin clearance. Colbert et al. (2009), B1 to B10.

    2 (sin a - a cos a) / (a - sin a cos a), the limit as Rs/c goes to infinity: the pressure is
    cos theta - cos a.

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact a, 0 to pi/2; `thin_winkler_load` gives the load that belongs to
        it. [rad]

    Returns
    -------
    float or array
        Torque ratio mu*. [1]

    Examples
    --------
    4/pi at 90 degrees, as for a cosine over half the shaft:

    >>> print(f"{thin_winkler_torque_ratio(np.pi / 2):.6f} {4 / np.pi:.6f}")
    1.273240 1.273240
    """
    # both brackets vanish as a^3, so small angles take the quotient of their series
    small = (half_angle < _SERIES_BELOW) * 1
    series = (1 - half_angle**2 / 10 + half_angle**4 / 280) / (
        1 - half_angle**2 / 5 + 2 * half_angle**4 / 105
    )
    a = half_angle + small  # keeps the closed form away from 0/0 where it is not used
    closed = 2 * (np.sin(a) - a * np.cos(a)) / (a - np.sin(a) * np.cos(a))
    return small * series + (1 - small) * closed


@formula()
def thin_winkler_load(half_angle: Values) -> Values:
    """Compute the load group F* t* R/c of a thin-clearance Winkler bushing.

    (a - sin a cos a) / cos a, from Colbert et al. (2009), B1 to B10; see
    `thin_winkler_torque_ratio`.

    Parameters
    ----------
    half_angle : float or array
        Half of the arc of contact. [rad]

    Returns
    -------
    float or array
        Load group F* t* R/c, which grows without bound towards 90 degrees. [1]

    Raises
    ------
    ModelError
        An angle outside 0 to pi/2, or pi/2 itself, which no load reaches.

    Examples
    --------
    At 60 degrees: 2 pi/3 - sqrt(3)/2.

    >>> print(f"{thin_winkler_load(np.pi / 3):.6f} {2 * np.pi / 3 - np.sqrt(3) / 2:.6f}")
    1.228370 1.228370
    """
    if np.any(np.equal(half_angle, np.pi / 2)):
        raise ModelError("half_angle must be below pi/2: no load wraps a thin clearance that far.")
    return (half_angle - np.sin(half_angle) * np.cos(half_angle)) / np.cos(half_angle)


@formula(angle="signed number")
def torque_ratio(angle: Values, *, pressure: Values) -> Values:
    """Integrate T* of any pressure distribution. Colbert et al. (2009), eq. 4.

    int P / int P cos theta.

    Parameters
    ----------
    angle : array, (..., n)
        Angles from the line of load, rising, spanning the contact. [rad]
    pressure : array, (..., n)
        Pressure there. [Pa, or any unit]

    Returns
    -------
    float or array
        Torque ratio T*, over the last axis. [1]

    Raises
    ------
    ModelError
        Angles that do not rise, or a pressure that is negative, infinite, of another length or
        carries no load.

    Examples
    --------
    A cosine over half the shaft, sampled every degree:

    >>> angle = np.radians(np.arange(-90, 91))
    >>> print(f"{torque_ratio(angle, pressure=np.cos(angle)):.4f} {4 / np.pi:.4f}")
    1.2732 1.2732
    """
    if not hasattr(pressure, "dims"):
        return _torque_over_load(np.asarray(angle), np.asarray(pressure))
    from xarray import apply_ufunc  # at use, because the models load without it

    dim = angle.dims[-1] if hasattr(angle, "dims") else pressure.dims[-1]
    return apply_ufunc(_torque_over_load, angle, pressure, input_core_dims=[[dim], [dim]])


def _torque_over_load(angles: Array, pressures: Array) -> Values:
    """Torque ratio of samples along the last axis."""
    if not angles.ndim or not pressures.ndim or angles.shape[-1] != pressures.shape[-1]:
        raise ModelError(
            "angle and pressure must hold the same number of samples along their last axis, got "
            f"shapes {angles.shape} and {pressures.shape}."
        )
    if np.any(np.less_equal(np.diff(angles, axis=-1), 0)):
        raise ModelError("angle must rise along its last axis.")

    # only the component along the line of load carries, the whole pressure rubs
    carried = np.trapezoid(pressures * np.cos(angles), angles, axis=-1)
    if np.any(np.less_equal(carried, 0)):
        raise ModelError(
            "pressure must carry a load along the line at angle 0, got an integral of "
            f"{float(np.nanmin(carried)):g}."
        )
    return np.trapezoid(pressures, angles, axis=-1) / carried


@dataclass(frozen=True)
class ReversalFriction:
    """Friction from a motion in both directions.

    Attributes
    ----------
    friction : float
        Apparent coefficient mu', the mean of the two directions. [1]
    offset : float
        Torque over load and radius that does not reverse: a misaligned load cell. [1]
    standard_error : float
        Standard error of `friction`, from the scatter of samples taken as independent. [1]
    """

    friction: float
    offset: float
    standard_error: float


@formula(torque="signed number", radius="length")
def average_reversals(
    torque: Values, *, load: Values, radius: float, direction: Values
) -> ReversalFriction:
    """Compute a friction coefficient, free of offset, from torques in both directions.

    Colbert et al. (2009), section 2: a small angle between load cell and contact adds a torque that
    keeps its sign on reversal; half of the difference of the two directions is free of it.

    Parameters
    ----------
    torque : array, (n,)
        Signed torque about the shaft. [N m]
    load : float or array, (n,)
        Magnitude of the load, the vector sum of its components. [N]
    radius : float
        Radius of the shaft. [m]
    direction : array, (n,)
        Sign of the rotation; samples at 0 are left out. [1]

    Returns
    -------
    ReversalFriction
        Friction coefficient, offset and standard error; NaN where a sample is NaN. [1]

    Raises
    ------
    ModelError
        Fewer than two samples in a direction, columns of different length, or a load or radius not
        positive.

    Examples
    --------
    A torque of 0.2 N m that reverses on an offset of 0.05 N m, at 100 N on a radius of 10 mm:

    >>> found = average_reversals(
    ...     [0.25, 0.25, -0.15, -0.15], load=100.0, radius=0.01, direction=[1, 1, -1, -1]
    ... )
    >>> print(f"{found.friction:.2f} {found.offset:.2f} {found.standard_error:.2f}")
    0.20 0.05 0.00
    """
    ratio = np.asarray(friction_coefficient(torque, load=load, radius=radius), float)
    sense = np.asarray(direction)
    if sense.ndim != 1 or ratio.shape != sense.shape:
        raise ModelError(
            f"torque and direction must be columns of one length, got shapes {ratio.shape} and "
            f"{sense.shape}."
        )

    # friction reverses with the motion and an offset does not
    forward, backward = ratio[sense > 0], ratio[sense < 0]
    if forward.size < 2 or backward.size < 2:
        raise ModelError(
            f"direction must hold at least two samples each way, got {forward.size} forward and "
            f"{backward.size} backward."
        )
    return ReversalFriction(
        friction=float(forward.mean() - backward.mean()) / 2,
        offset=float(forward.mean() + backward.mean()) / 2,
        standard_error=float(np.hypot(scipy.stats.sem(forward), scipy.stats.sem(backward))) / 2,
    )


def _sinc(x: Values) -> Values:
    """sin(x)/x, 1 at zero."""
    safe = x + (x == 0)  # 1 in the place of 0, whose quotient is then replaced
    return np.sin(safe) / safe * (x != 0) + (x == 0)
