"""Ends of contacting bodies: the singularity at a sharp edge, the free face, the crowned roller."""

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula, require_between
from erlif.models.contact.roots import find_roots, like


@formula()
def edge_exponent(angle: Values, *, modulus_ratio: Values = 1.0) -> Values:
    """Compute the exponent of the pressure at the sharp edge of a body on a flat, frictionless.

    The pressure at the distance r from the edge grows as r^-n. Williams (1952), Dundurs and Lee
    (1972): with stresses r^(m - 1) in both bodies, the edge and the flat have equal normal
    displacement where they touch if D(m, angle) / E1* + D(m, pi) / E2* = 0. D is the coefficient of
    sin((m - 1) theta) in the stress function of a wedge whose outer face is free, under unit
    normal stress; n = 1 - m.

    Parameters
    ----------
    angle : float or array
        Angle within the material of the edge, from 0.001 to pi. [rad]
    modulus_ratio : float or array
        E1* of the body with the edge over E2* of the flat, in plane strain; `inf` for a rigid edge.
        [1]

    Returns
    -------
    float or array
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
    require_between(1e-3, np.pi, angle=angle)
    if np.any(np.less_equal(modulus_ratio, 0)):
        raise ModelError(f"modulus_ratio must be positive, got {float(np.nanmin(modulus_ratio))}.")

    # the flat alone closes at 1/2; a compliant edge weakens the singularity, up to none
    softness = 1 / modulus_ratio
    angles = angle + 0 * softness
    both = np.asarray(angles, float), np.asarray(0 * angle + softness, float)
    exponent = find_roots(_edge_misfit, _WEAKEST, 0.5, *both)
    exponent = np.where(_edge_misfit(_WEAKEST, *both) >= 0, 0.0, exponent)
    exponent = np.where(np.abs(_edge_misfit(0.5, *both)) < _ROUNDING, 0.5, exponent)
    return like(angles, exponent)


_WEAKEST = 1e-7  # exponents below it count as none
_ROUNDING = 1e-12


def _edge_misfit(exponent: Values, angle: Values, softness: Values) -> Values:
    """Misfit of the displacements of edge and flat, positive at 1/2, with one root below at most.

    A wedge has D = (m + 1) (m sin 2a + sin 2ma) / (4 (m^2 sin^2 a - sin^2 ma)). The sum for edge
    and flat is multiplied by both denominators, and divided by n, as m = 1 solves it for any edge.
    """
    m = 1 - exponent
    edge = (m * np.sin(2 * angle) + np.sin(2 * m * angle)) * np.sin(np.pi * m)
    flat = (m * np.sin(angle)) ** 2 - np.sin(m * angle) ** 2
    return (softness * edge - 2 * np.cos(np.pi * m) * flat) / exponent


@formula(load="load or zero")
def lundberg_profile(
    axial: Values, *, load: Values, length: Values, contact_modulus: Values
) -> Values:
    """Compute the crown that gives a roller the same pressure along its length. Lundberg (1939).

    d(z) = F / (pi E* L) ln[1 / (1 - (2 z / L)^2)]: the deflection in the middle less that at z of a
    strip of length L with the pressure of Hertz, narrow against L. At the ends it is infinite.

    Parameters
    ----------
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]
    axial, load, length : float or array
        Distance z from the middle of the roller, at most half its length [m], load F for which the
        profile is made [N], length L of the roller [m].

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
    place = 2 * axial / length
    if np.any(np.abs(place) >= 1):
        raise ModelError(
            "axial reaches the ends of the roller, where the profile of Lundberg is infinite; give "
            f"places within ±{np.max(length) / 2:g} m."
        )
    return load / (np.pi * contact_modulus * length) * -np.log1p(-(place**2))
