"""Ends of contacting bodies: the singularity at a sharp edge, the free face, the crowned roller."""

import numpy as np
import scipy.optimize

from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    broadcasting,
    check_length,
    check_load,
    check_modulus,
    require_between,
    require_finite,
    require_not_negative,
    require_positive,
    require_single,
)


def edge_exponent(angle: float, *, modulus_ratio: float = 1.0) -> float:
    """Compute the exponent of the pressure at the sharp edge of a body on a flat, frictionless.

    The pressure at the distance r from the edge grows as r^-n. Williams (1952), Dundurs and Lee
    (1972): with stresses r^(m - 1) in both bodies, the edge and the flat have equal normal
    displacement where they touch if D(m, angle) / E1* + D(m, pi) / E2* = 0. D is the coefficient of
    sin((m - 1) theta) in the stress function of a wedge whose outer face is free, under unit
    normal stress; n = 1 - m.

    Parameters
    ----------
    angle : float
        Angle within the material of the edge, from 0 to pi. [rad]
    modulus_ratio : float
        E1* of the body with the edge over E2* of the flat, in plane strain; `inf` for a rigid
        edge. [1]

    Returns
    -------
    float
        n, from 0 (no singularity) to 1/2. [1]

    Raises
    ------
    ModelError
        An angle outside its range, a ratio that is not positive.

    Examples
    --------
    A rigid punch has an inverse square root, a right angle of equal material 0.226:

    >>> print(f"{edge_exponent(np.pi / 2, modulus_ratio=np.inf):.3f}")
    0.500
    >>> print(f"{edge_exponent(np.pi / 2):.3f}")
    0.226
    """
    require_single(angle=angle, modulus_ratio=modulus_ratio)
    require_between(1e-3, np.pi, angle=angle)
    if not modulus_ratio > 0:
        raise ModelError(f"modulus_ratio must be positive, got {modulus_ratio}.")

    def misfit(power: float) -> float:
        edge = _surface_slope(power, angle) / modulus_ratio
        return edge + _surface_slope(power, np.pi)

    # the flat alone closes at 1/2; a compliant edge weakens the singularity
    powers = np.linspace(0.5, 1 - 1e-9, 400)
    values = np.array([misfit(power) for power in powers])
    (crossings,) = np.nonzero((values[:-1] <= 0) != (values[1:] <= 0))
    if abs(values[0]) < 1e-12:
        return 0.5
    for k in crossings:
        root = float(scipy.optimize.brentq(misfit, powers[k], powers[k + 1], xtol=1e-14))
        if abs(misfit(root)) < 1.0:  # a root, not a pole
            return 1 - root
    return 0.0


def _surface_slope(power: float, angle: float) -> float:
    """D of a wedge from its face in contact (theta = 0) to its free face, under unit stress.

    F = A cos((m + 1) t) + B sin((m + 1) t) + C cos((m - 1) t) + D sin((m - 1) t), with F(0) = 1,
    F'(0) = 0, F(angle) = F'(angle) = 0.
    """
    plus, minus = power + 1, power - 1
    rows = np.array(
        [
            [1, 0, 1, 0],
            [0, plus, 0, minus],
            [
                np.cos(plus * angle),
                np.sin(plus * angle),
                np.cos(minus * angle),
                np.sin(minus * angle),
            ],
            [
                -plus * np.sin(plus * angle),
                plus * np.cos(plus * angle),
                -minus * np.sin(minus * angle),
                minus * np.cos(minus * angle),
            ],
        ]
    )
    return float(np.linalg.solve(rows, np.array([1.0, 0, 0, 0]))[3])


@broadcasting
def lundberg_profile(
    axial: Values, *, load: Values, length: Values, contact_modulus: Values
) -> Values:
    """Compute the crown that gives a roller the same pressure along its length. Lundberg (1939).

    d(z) = F / (pi E* L) ln[1 / (1 - (2 z / L)^2)]: the deflection in the middle less that at z of a
    strip of length L with the pressure of Hertz, narrow against L. At the ends it is infinite.

    Parameters
    ----------
    axial : float or array
        Distance z from the middle of the roller, at most half its length. [m]
    load : float or array
        Load F for which the profile is made. [N]
    length : float or array
        Length L of the roller. [m]
    contact_modulus : float or array
        E*, see `erlif.models.contact.contact_modulus`. [Pa]

    Returns
    -------
    float or array
        Material to take off, on one of the bodies or in sum. [m]

    Raises
    ------
    ModelError
        A place beyond the ends, a length or modulus that is not positive, a negative load.

    Examples
    --------
    A steel roller of 10 mm under 10 kN, 0.05 mm from its end:

    >>> drop = lundberg_profile(4.95e-3, load=1e4, length=0.01, contact_modulus=110e9)
    >>> print(f"{drop * 1e6:.2f} um")
    11.33 um
    """
    require_positive(length=length, contact_modulus=contact_modulus)
    require_finite(axial=axial)
    require_not_negative(load=load)
    check_length(length=length)
    check_load(load=load)
    check_modulus(contact_modulus=contact_modulus)
    place = 2 * axial / length
    if np.any(np.abs(place) >= 1):
        raise ModelError(
            "axial reaches the ends of the roller, where the profile of Lundberg is infinite; "
            f"give places within ±{np.max(length) / 2:g} m."
        )
    return load / (np.pi * contact_modulus * length) * -np.log1p(-(place**2))
