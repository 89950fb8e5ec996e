"""Dry contact of pin and bushing: Hertz, Persson, Winkler."""

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, require_poisson, require_positive


def conformal_radius(pin_radius: Values, *, bushing_radius: Values) -> Values:
    """Reduced radius [m] of a pin in a bushing: R = R1 R2 / (R1 - R2). Farzaneh (2002), eq. 2.8.

    Parameters
    ----------
    pin_radius, bushing_radius : float or array
        Radii R2 of the pin and R1 of the bore. [m]

    Raises
    ------
    ModelError
        A radius not positive, or a bushing not larger than its pin.
    """
    require_positive(pin_radius=pin_radius, bushing_radius=bushing_radius)
    if np.any(np.less_equal(bushing_radius - pin_radius, 0)):
        raise ModelError(
            f"bushing_radius must exceed pin_radius for a clearance fit, got {np.min(np.asarray(bushing_radius)):g} m "
            f"and {np.max(np.asarray(pin_radius)):g} m."
        )
    return pin_radius * bushing_radius / (bushing_radius - pin_radius)


def contact_modulus(youngs_1: Values, *, poisson_1: Values, youngs_2: Values, poisson_2: Values) -> Values:
    """Contact modulus E* [Pa]: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2. Farzaneh (2002), eq. B.1.

    The E' of Strand (2005) is this E*; the E' of the film formulas of Dowson, Higginson and Hamrock is 2 E*.

    Parameters
    ----------
    youngs_1, youngs_2 : float or array
        Young's moduli. [Pa]
    poisson_1, poisson_2 : float or array
        Poisson's ratios. [1]
    """
    require_positive(youngs_1=youngs_1, youngs_2=youngs_2)
    require_poisson(poisson_1=poisson_1, poisson_2=poisson_2)
    return 1 / ((1 - poisson_1**2) / youngs_1 + (1 - poisson_2**2) / youngs_2)


def hertz_line(load_per_length: Values, *, radius: Values, contact_modulus: Values) -> tuple[Values, Values]:
    """Half width [m] and greatest pressure [Pa] of a Hertzian line contact.

    b = sqrt(4 q R / (pi E*)),  p0 = sqrt(q E* / (pi R)). Strand (2005), eq. 8.

    Parameters
    ----------
    load_per_length : float or array
        Line load q. [N/m]
    radius : float or array
        Reduced radius R, see `conformal_radius`. [m]
    contact_modulus : float or array
        E*. [Pa]

    Notes
    -----
    The contact must be narrow against the pin: in a conformal joint Hertz is 0.3 % low in pressure at a half contact
    angle of 5 degrees, 1.2 % at 10, 4.8 % at 20 and 19 % at 40; use `persson_contact` there.
    """
    require_positive(load_per_length=load_per_length, radius=radius, contact_modulus=contact_modulus)
    half_width = np.sqrt(4 * load_per_length * radius / (np.pi * contact_modulus))
    return half_width, np.sqrt(load_per_length * contact_modulus / (np.pi * radius))
