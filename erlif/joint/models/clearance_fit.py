"""Friction coefficient and stiffness of a wall, fitted to bushings of several clearances.

The torque of a bushing is more than mu F R, and the more the smaller its clearance (Colbert et al.
2009, figure 7). A series of clearances therefore holds both the true friction coefficient and the
stiffness of the wall that spreads the contact.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.joint.models.running_in import thin_wall_torque_ratio
from erlif.models.arguments import Values, for_each, formula, require_between, require_positive

# Moduli among which the best is sought, from soft rubber to stiffer than any wall. [Pa]
_RANGE = (4e5, 9e12)

# Moduli that are tried: 4 % apart, well within their error.
_TRIALS = 401

# Of modulus and friction: median and interval of one standard deviation, and that of 95 %.
_QUANTILES = (0.158655, 0.5, 0.841345)
_WIDE = (0.025, 0.975)
_NORMAL = 1.959964  # standard deviations of 95 %, for the errors that all bushings share

# Weight of the last modulus over the largest, from which on an end is not determined.
_OPEN = 0.1

# Of the friction coefficient, on which the weight of the clearances depends, and of the clearances
# at which the torque ratio is taken as linear; these move by three standard deviations at most.
_ROUNDS = 4
_PLACES = 3
_FARTHEST = 3.0

# Step of the slope by clearance, over the range of the clearances.
_SLOPE = 1e-4

# Bushings: one more than there are unknowns.
_FEWEST = 3


@dataclass(frozen=True)
class ClearanceFit:
    """Friction and stiffness from a series of clearances.

    Attributes
    ----------
    friction : float
        True friction coefficient mu, the median. [1]
    friction_std : float
        Its standard deviation, half the width of its interval of 68 %. [1]
    friction_interval : tuple[float, float]
        Its interval of 95 %; not 1.96 standard deviations to each side where the moduli that fit
        have different friction. [1]
    modulus : float
        E' of the wall, the median. [Pa]
    modulus_low : float
        Lower end of its interval of 68 %; 0 where it is not determined. [Pa]
    modulus_high : float
        Upper end of its interval of 68 %; infinite where it is not determined. [Pa]
    chi_square : float
        Of the residuals at the best fit; errors of the clearances are in their weights. [1]
    degrees_of_freedom : int
        Bushings less the two unknowns.
    budget : dict[str, float]
        Standard deviation of mu from each cause alone: torque, clearance, load, shaft radius. [1]
    """

    friction: float
    friction_std: float
    friction_interval: tuple[float, float]
    modulus: float
    modulus_low: float
    modulus_high: float
    chi_square: float
    degrees_of_freedom: int
    budget: dict[str, float]


@formula(friction="number")
def fit_clearances(
    clearance: Values,
    *,
    friction: Values,
    friction_std: Values,
    clearance_std: Values,
    load_per_length: float,
    shaft_radius: float,
    thickness: float,
    load_std: float = 0.0,
    radius_std: float = 0.0,
    known_modulus: tuple[float, float] | None = None,
) -> ClearanceFit:
    """Fit mu and E' to apparent friction coefficients of bushings with several clearances.

    mu' = mu mu*(c), with `erlif.joint.models.running_in.thin_wall_torque_ratio` as mu*. For each of
    many moduli the friction follows in closed form; an error of a clearance counts as that of the
    torque which it makes at the clearance that fits best. The moduli are weighed by their
    likelihood, evenly over their logarithm: a stiff wall with much friction and a soft one with
    less often fit equally well.

    Parameters
    ----------
    clearance : array of shape (n,)
        Radial clearances, negative for an interference. [m]
    friction : array of shape (n,)
        Apparent coefficients mu' = T / (F R). [1]
    friction_std, clearance_std : float or array of shape (n,)
        Their standard deviations; a `clearance_std` of 0 takes the clearances as exact. [1, m]
    load_per_length : float
        Load over width. [N/m]
    shaft_radius, thickness : float
        Radius of the shaft and thickness of the wall. [m]
    load_std, radius_std : float
        Relative standard deviations of load and shaft radius, shared by all bushings. [1]
    known_modulus : tuple[float, float], optional
        E' of the wall and its relative standard deviation, where it is known. [Pa, 1]

    Returns
    -------
    ClearanceFit
        Friction coefficient, modulus, and the standard deviation of the former by cause.

    Raises
    ------
    ModelError
        Fewer than three bushings, clearances that are all equal, or values that are not positive.

    Notes
    -----
    Wear during the test is not in the model, see `erlif.joint.models.running_in.run_in_bushing`. A
    relative error of load or radius changes all torques alike and therefore mu by as much.

    Examples
    --------
    Four bushings with torques that follow the model for mu = 0.12 and E' = 1 GPa:

    >>> from erlif.joint.models.running_in import thin_wall_torque_ratio
    >>> wall = {"load_per_length": 4e4, "shaft_radius": 5e-3, "thickness": 3e-3}
    >>> clearance = np.array([100e-6, 40e-6, 20e-6, 5e-6])
    >>> torque = 0.12 * thin_wall_torque_ratio(clearance=clearance, modulus=1e9, **wall)
    >>> found = fit_clearances(
    ...     clearance, friction=torque, friction_std=0.002, clearance_std=5e-6, **wall
    ... )
    >>> print(f"{found.friction:.3f} ± {found.friction_std:.3f}, {found.modulus / 1e9:.1f} GPa")
    0.120 ± 0.005, 1.0 GPa
    """
    measured = np.atleast_1d(np.asarray(friction, float))
    places = np.atleast_1d(np.asarray(clearance, float))
    if places.shape != measured.shape or places.ndim != 1 or places.size < _FEWEST:
        raise ModelError(
            f"Expected clearance and friction of {_FEWEST} or more bushings, got {places.size} and "
            f"{measured.size}. Measure more bushings."
        )
    if np.any(np.isnan(places)) or np.any(np.isnan(measured)):
        raise ModelError("clearance and friction must not be NaN. Leave those bushings out.")
    if np.ptp(places) == 0:
        raise ModelError(
            "clearance must differ between bushings: equal ones do not separate friction and "
            "stiffness. Measure bushings of other clearances."
        )
    torque_std = for_each(measured.size, "bushing", friction_std=friction_std)
    place_std = for_each(measured.size, "bushing", clearance_std=clearance_std)
    wall = {
        "load_per_length": load_per_length,
        "shaft_radius": shaft_radius,
        "thickness": thickness,
    }

    # evenly over the logarithm; a known modulus weighs as one more measurement
    moduli = np.geomspace(*_RANGE, _TRIALS)
    prior = np.zeros(_TRIALS)
    if known_modulus is not None:
        value, std = known_modulus
        require_positive(known_modulus=value, std_of_modulus=std)
        require_between(*_RANGE, known_modulus=value)
        prior = (np.log(moduli / value) / std) ** 2
    series = moduli, places, measured, torque_std
    fitted, fitted_std, chi_square = _fit_friction(*series, place_std, wall)
    _, torque_std_alone, _ = _fit_friction(*series, 0 * places, wall)

    # what the moduli leave open adds to the error of the friction at each of them
    weight = np.exp(-(chi_square + prior - np.min(chi_square + prior)) / 2)
    weight /= weight.sum()
    start, friction_found, end = _quantiles(weight, fitted, fitted_std, _QUANTILES)
    half = (end - start) / 2
    sharp = _quantiles(weight, fitted, torque_std_alone, _QUANTILES)
    scatter = min((sharp[2] - sharp[0]) / 2, half)

    # load and radius are shared by all bushings, so that more of them do not help
    budget = {
        "torque": scatter,
        "clearance": float(np.sqrt(half**2 - scatter**2)),
        "load": friction_found * float(load_std),
        "shaft radius": friction_found * float(radius_std),
    }
    shared = _NORMAL * float(np.hypot(budget["load"], budget["shaft radius"]))
    wide = [
        friction_found + float(np.copysign(np.hypot(end - friction_found, shared), side))
        for end, side in zip(_quantiles(weight, fitted, fitted_std, _WIDE), (-1, 1), strict=True)
    ]
    low, middle, high = np.searchsorted(np.cumsum(weight), _QUANTILES)
    return ClearanceFit(
        friction=friction_found,
        friction_std=float(np.sqrt(sum(part**2 for part in budget.values()))),
        friction_interval=(wide[0], wide[1]),
        modulus=float(moduli[middle]),
        modulus_low=float(moduli[low]) if weight[0] < _OPEN * weight.max() else 0.0,
        modulus_high=float(moduli[high]) if weight[-1] < _OPEN * weight.max() else float("inf"),
        chi_square=float(chi_square.min()),
        degrees_of_freedom=measured.size - 2,
        budget=budget,
    )


def _fit_friction(
    moduli: Array,
    places: Array,
    measured: Array,
    torque_std: Array,
    place_std: Array,
    wall: dict[str, float],
) -> tuple[Array, Array, Array]:
    """Friction that fits best at each modulus, its error there, and the chi square that remains.

    Weighted lines through the origin: measured torque over that of the model.
    """
    near = _SLOPE * float(np.ptp(places))
    trials = moduli[:, None]
    at = np.broadcast_to(places, (moduli.size, places.size))
    friction = np.full(moduli.shape, float(np.median(measured)))
    for _ in range(_PLACES):
        # a line through the ratio at the clearances that fitted best
        ratio = thin_wall_torque_ratio(clearance=at, modulus=trials, **wall)
        beside = thin_wall_torque_ratio(clearance=at + near, modulus=trials, **wall)
        slope = (beside - ratio) / near
        shape = ratio + slope * (places - at)
        for _ in range(_ROUNDS):
            variance = torque_std**2 + (friction[:, None] * slope * place_std) ** 2
            weight = np.sum(shape**2 / variance, axis=1)
            friction = np.sum(shape * measured / variance, axis=1) / weight
        left = measured - friction[:, None] * shape
        moved = place_std**2 * friction[:, None] * slope * left / variance
        at = places + np.clip(moved, -_FARTHEST * place_std, _FARTHEST * place_std)
    return friction, weight**-0.5, np.sum(left**2 / variance, axis=1)


def _quantiles(
    weight: Array, middle: Array, std: Array, shares: tuple[float, ...]
) -> tuple[float, ...]:
    """Values below which a sum of normal distributions has these shares."""
    used = weight > 1e-9 * weight.max()
    weight, middle, std = weight[used] / weight[used].sum(), middle[used], std[used]
    ends = float(np.min(middle - 8 * std)), float(np.max(middle + 8 * std))

    def find(share: float) -> float:
        return float(brentq(lambda at: float(weight @ ndtr((at - middle) / std)) - share, *ends))

    return tuple(find(share) for share in shares)
