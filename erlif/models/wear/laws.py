"""Wear after Archard (1953): adhesion, abrasion, fatigue, and depth by pressure."""

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula


@formula(load="load or zero")
def adhesive_wear(
    load: Values, *, sliding_distance: Values, hardness: Values, coefficient: Values
) -> Values:
    """Compute the volume worn by adhesion. Archard (1953); Strand (2005), eq. 31.

    V = K F s / H; also Farzaneh (2002), eq. 2.1.

    Parameters
    ----------
    coefficient : float or array
        Wear coefficient K, from a test of the same pair and lubricant. [1]

    Returns
    -------
    float or array
        Worn volume V. [m3]

    Examples
    --------
    1 kN over 100 m on 2 GPa with a coefficient of 1e-4:

    >>> volume = adhesive_wear(1e3, sliding_distance=100.0, hardness=2e9, coefficient=1e-4)
    >>> print(f"{volume * 1e9:.1f} mm3")
    5.0 mm3
    """
    return coefficient * load * sliding_distance / hardness


@formula(load="load or zero")
def abrasive_wear(
    load: Values, *, sliding_distance: Values, hardness: Values, asperity_slope: Values
) -> Values:
    """Compute the volume worn by abrasion. Farzaneh (2002), eq. 2.2.

    V = (2/pi) tan(Theta) F s / H.

    Parameters
    ----------
    asperity_slope : float or array
        Angle Theta of the hard asperities to the surface, 0 to below pi/2. [rad]

    Returns
    -------
    float or array
        Worn volume V. [m3]

    Examples
    --------
    Asperities of 45 degrees are Archard's law with a coefficient of 2/pi:

    >>> from erlif.models.wear import adhesive_wear
    >>> case = {"sliding_distance": 1.0, "hardness": 2e9}
    >>> ratio = abrasive_wear(1e3, asperity_slope=np.pi / 4, **case)
    >>> ratio /= adhesive_wear(1e3, coefficient=2 / np.pi, **case)
    >>> print(f"{ratio:.6f}")
    1.000000
    """
    if np.any(np.less(asperity_slope, 0) | np.greater_equal(asperity_slope, np.pi / 2)):
        lowest, highest = (
            float(pick(np.asarray(asperity_slope))) for pick in (np.nanmin, np.nanmax)
        )
        raise ModelError(
            "asperity_slope must lie from 0 to below pi/2, got "
            f"{lowest if lowest < 0 else highest:g} rad."
        )
    # a cone of radius r ploughs an area r^2 tan(Theta) and bears with its front half, H pi r^2 / 2
    slope = np.tan(asperity_slope)
    return adhesive_wear(
        load, sliding_distance=sliding_distance, hardness=hardness, coefficient=2 / np.pi * slope
    )


@formula(load="load or zero")
def fatigue_wear(
    load: Values,
    *,
    sliding_distance: Values,
    hardness: Values,
    asperity_distribution: Values,
    particle_size: Values,
    failure_strain: Values,
    coefficient: Values,
) -> Values:
    """Compute the volume worn by fatigue. Farzaneh (2002), eq. 2.3.

    V = C eta gamma F s / (eps^2 H).

    Parameters
    ----------
    asperity_distribution, particle_size, failure_strain, coefficient : float or array
        Constant eta of the distribution of asperity heights [1], constant gamma of the particle
        size [1], strain eps to failure in one cycle [1], wear coefficient C [1].

    Returns
    -------
    float or array
        Worn volume V. [m3]

    Examples
    --------
    Half the strain to failure wears four times as much:

    >>> case = {"sliding_distance": 1.0, "hardness": 2e9, "coefficient": 0.1}
    >>> case |= {"asperity_distribution": 1.0, "particle_size": 1.0}
    >>> ratio = fatigue_wear(1e3, failure_strain=0.1, **case)
    >>> ratio /= fatigue_wear(1e3, failure_strain=0.2, **case)
    >>> print(f"{ratio:.3f}")
    4.000
    """
    # the three constants and the strain make one coefficient of Archard's law
    share = coefficient * asperity_distribution * particle_size / failure_strain**2
    return adhesive_wear(
        load, sliding_distance=sliding_distance, hardness=hardness, coefficient=share
    )


@formula()
def wear_depth(pressure: Values, *, sliding_distance: Values, specific_wear: Values) -> Values:
    """Compute the depth worn under a pressure. Strand (2005), eq. 32; Mukras et al. (2008), eq. 4.

    h = k p s.

    Parameters
    ----------
    pressure, sliding_distance, specific_wear : float or array
        Pressure p [Pa], sliding distance s, speed times time [m], specific wear rate k, the K/H of
        `adhesive_wear` [1/Pa].

    Returns
    -------
    float or array
        Worn depth h. [m]

    Examples
    --------
    10 MPa over 90 m with the wear rate of Mukras et al. (2008), 5.05e-4 mm3/(N m):

    >>> depth = wear_depth(10e6, sliding_distance=90.0, specific_wear=5.05e-13)
    >>> print(f"{depth * 1e6:.1f} um")
    454.5 um
    """
    return specific_wear * pressure * sliding_distance
