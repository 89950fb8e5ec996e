"""Pressures of a pin in a bushing that are prescribed, not computed (Strand, 2005)."""

import numpy as np

from erlif.models.arguments import Values, formula


@formula(load_per_length="signed line_load")
def projected_pressure(load_per_length: Values, *, pin_diameter: Values) -> Values:
    """Compute the load over the projected area of a pin: p = q / d. Strand (2005), eq. 6.

    Returns: Projected pressure p. [Pa]

    Examples
    --------
    400 N on a bushing of 10 mm by 10 mm; Colbert et al. (2009) give 4 MPa.

    >>> print(f"{projected_pressure(400 / 0.010, pin_diameter=0.010) / 1e6:.1f} MPa")
    4.0 MPa
    """
    return load_per_length / pin_diameter


@formula(load_per_length="signed line_load")
def sinusoidal_pressure(load_per_length: Values, *, pin_diameter: Values) -> Values:
    """Compute the maximum of a cosine pressure over half the pin. Strand (2005), eq. 7.

    p = 4q / (pi d).

    Returns: Maximum pressure p, on the line of load. [Pa]

    Notes
    -----
    Against Persson's law this pressure is safe from a half contact angle of 72.9 degrees (printed:
    72), and 2q/d from 38.8 degrees (printed: 38).

    Examples
    --------
    4/pi times the projected pressure of 4 MPa:

    >>> print(f"{sinusoidal_pressure(400 / 0.010, pin_diameter=0.010) / 1e6:.3f} MPa")
    5.093 MPa
    """
    # the load is int p cos^2(theta) d/2 over half the pin: p pi d / 4
    return 4 * load_per_length / (np.pi * pin_diameter)
