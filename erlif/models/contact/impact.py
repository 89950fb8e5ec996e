"""Impact of a pin in a bushing (Lankarani and Nikravesh, 1994; Mukras et al., 2008)."""

import numpy as np

from erlif.models.arguments import Values, formula
from erlif.models.contact.scaling import conformal_radius


@formula()
def impact_stiffness(
    pin_radius: Values, *, bushing_radius: Values, contact_modulus: Values, as_printed: bool = False
) -> Values:
    """Compute the stiffness of a pin that hits its bushing. Mukras et al. (2008), eq. 13.

    K = (4/3) E* sqrt(R), for `impact_force`.

    Parameters
    ----------
    contact_modulus : float or array
        Contact modulus E*, see `erlif.models.contact.contact_modulus`. [Pa]
    pin_radius, bushing_radius : float or array
        Radii of the pin and of the bore. [m]
    as_printed : bool
        Use the reduced radius that the source prints.

    Returns
    -------
    float or array
        Stiffness K. [N/m^1.5]

    Raises
    ------
    ModelError
        A value not positive or not finite, or a bushing not larger than its pin.

    Notes
    -----
    R is the reduced radius of a pin inside a bushing. The source prints R1 R2/(R1 + R2), two balls
    outside each other, which with its numbers is 43.7 times too soft; `as_printed` gives that
    value.

    Examples
    --------
    The joint of the source, steel in PTFE; 1.494e7 is its value.

    >>> from erlif.models.contact import contact_modulus
    >>> modulus = contact_modulus(206.8e9, poisson_1=0.29, youngs_2=0.139e9, poisson_2=0.38)
    >>> case = {"bushing_radius": 9.535e-3, "contact_modulus": modulus}
    >>> print(f"{impact_stiffness(9.525e-3, **case, as_printed=True):.3e}")
    1.494e+07
    >>> print(f"{impact_stiffness(9.525e-3, **case):.3e}")
    6.523e+08
    """
    # the bore is concave, so its curvature counts as negative; the print takes it for a ball
    inside = conformal_radius(pin_radius, bushing_radius=bushing_radius)
    outside = pin_radius * bushing_radius / (pin_radius + bushing_radius)
    return 4 / 3 * contact_modulus * np.sqrt(outside if as_printed else inside)


@formula()
def impact_force(
    penetration: Values,
    *,
    rate: Values,
    impact_speed: Values,
    stiffness: Values,
    restitution: Values,
) -> Values:
    """Compute the normal force of an impact. Lankarani and Nikravesh (1994).

    F = K delta^1.5 [1 + 3 (1 - e^2) rate / (4 impact_speed)], zero without penetration; Mukras et
    al. (2008), eq. 12.

    Parameters
    ----------
    penetration, rate, impact_speed : float or array
        delta, negative while apart [m], rate of the penetration [m/s], rate of the penetration at
        first touch [m/s].
    stiffness : float or array
        K, see `impact_stiffness`. [N/m^1.5]
    restitution : float or array
        Coefficient of restitution e, 0 to 1; the law is meant for values near 1. [1]

    Returns
    -------
    float or array
        Normal force F. [N]

    Examples
    --------
    At the first touch of an inelastic impact (e = 0) the factor of the damping is 1.75:

    >>> case = {"impact_speed": 0.1, "stiffness": 1e8}
    >>> print(f"{impact_force(1e-4, rate=0.1, restitution=1.0, **case):.1f} N")
    100.0 N
    >>> print(f"{impact_force(1e-4, rate=0.1, restitution=0.0, **case):.1f} N")
    175.0 N
    """
    # the hysteresis absorbs the kinetic energy that the restitution does not return
    damping = 1 + 0.75 * (1 - restitution**2) * rate / impact_speed
    return stiffness * np.maximum(penetration, 0.0) ** 1.5 * damping
