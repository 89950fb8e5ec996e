"""Stresses in the links: bending, holes, threads, alternating loads, and factors of safety.

The machine of Farzaneh (2002), appendix A.4.1. `erlif.joint.models.reaction` has the force in the
coupler and the life of its rolling bearings. Stress concentrations at holes are the fits of Pilkey
(2005) to the measurements of Frocht and Hill (1940) and the solution of Howland (1930).
"""

import numpy as np

from erlif.models.arguments import (
    Values,
    formula,
    require_increasing,
    require_positive,
    warn_of_range,
)

# Coefficients of the powers of d/w at a closely fitting pin. Pilkey (2005), table 6-1.
#
# They are quoted; the print was not at hand. Finite elements of a rigid pin without friction give 5
# to 13 % less for d/w of 0.15 to 0.5 (docs/linkage.md).
PIN_LOADED = (12.882, -52.714, 89.762, -51.667)

# Coefficients of the powers of 1 - d/w at an open hole in tension. Pilkey (2005), table 6-1.
#
# They give the values of Howland (1930) within 0.5 %.
OPEN_HOLE = (2.0, 0.284, -0.600, 1.32)

# Hole over width, d/w, over which the first of these was fitted. [1]
PIN_RANGE = (0.15, 0.75)

# Diameter less that of the stress area, in pitches, of a 60 degree thread. ISO 898-1.
THREAD_DEPTH = 0.9382


@formula(depth="length")
def beam_bending_stress(force: Values, *, arm: Values, thickness: Values, depth: Values) -> Values:
    """Compute the bending stress in a link of rectangular section: 6 F L / (t h^2).

    Parameters
    ----------
    force, arm, thickness, depth : float or array
        Force F across the link [N], distance L of the force from the section [m], side t of the
        section across the force [m], side h of the section along the force [m].

    Returns
    -------
    float or array
        Stress at the edge, of the sign of the force. [Pa]

    Raises
    ------
    ModelError
        A length not positive, or an infinite force.

    Notes
    -----
    Farzaneh (2002) has 37 MPa in the rocker and prints no section. At a force of 8.2 kN and an arm
    of 26 cm this takes a section modulus t h^2/6 of 57.6 cm3.

    Examples
    --------
    >>> stress = beam_bending_stress(8.2e3, arm=0.26, thickness=0.05, depth=0.0831)
    >>> print(f"{stress / 1e6:.1f} MPa")
    37.0 MPa
    """
    return 6 * force * arm / (thickness * depth**2)


@formula(hole_ratio="hole_ratio")
def pin_hole_concentration(hole_ratio: Values) -> Values:
    """Compute the stress concentration at a hole that is loaded by a closely fitting pin.

    Peak stress over the mean stress of the section beside the hole, F / ((w - d) t). Fit of Pilkey
    (2005), table 6-1, to Frocht and Hill (1940), for an end at least one width beyond the hole.

    Parameters
    ----------
    hole_ratio : float or array
        Diameter of the hole over width of the link, 0.15 to 0.75. [1]

    Returns
    -------
    float or array
        Stress concentration. [1]

    Warns
    -----
    RangeWarning
        A ratio outside the fit.

    Notes
    -----
    A pin with play raises it by 35 to 50 %.

    Examples
    --------
    Farzaneh (2002) takes 2.5 from a chart, which is that of a hole of half the width:

    >>> print(f"{pin_hole_concentration(0.5):.2f}")
    2.51
    """
    warn_of_range("The stress concentration at a pin", "hole_ratio", hole_ratio, *PIN_RANGE)
    a, b, c, d = PIN_LOADED
    return a + hole_ratio * (b + hole_ratio * (c + hole_ratio * d))


@formula(hole_ratio="hole_ratio")
def open_hole_concentration(hole_ratio: Values) -> Values:
    """Compute the stress concentration at an open hole in a link under tension.

    Peak stress over the mean stress of the section beside the hole, F / ((w - d) t). Fit of Pilkey
    (2005), table 6-1, to Howland (1930).

    Parameters
    ----------
    hole_ratio : float or array
        Diameter of the hole over width of the link, 0 to 1. [1]

    Returns
    -------
    float or array
        Stress concentration, 3 at a small hole and 2 at a large one. [1]

    Examples
    --------
    >>> print(f"{open_hole_concentration(0.5):.2f}")
    2.16
    """
    a, b, c, d = OPEN_HOLE
    left = 1 - hole_ratio
    return a + left * (b + left * (c + left * d))


@formula()
def hole_stress(
    force: Values, *, width: Values, thickness: Values, hole: Values, concentration: Values
) -> Values:
    """Compute the peak stress beside a hole in a link: K F / ((w - d) t).

    Parameters
    ----------
    force, width, thickness, hole, concentration : float or array
        Force F along the link [N], width w of the link across the hole [m], thickness t of the link
        along the hole [m], diameter d of the hole, below the width [m], stress concentration K of
        the section beside the hole [1].

    Returns
    -------
    float or array
        Stress, of the sign of the force. [Pa]

    Raises
    ------
    ModelError
        A length not positive, a hole as wide as the link, or an infinite force.

    Notes
    -----
    Farzaneh (2002) has 60 MPa at K = 2.5 in a beam of 45 mm x 20 mm and prints no diameter. A hole
    of 27.9 mm gives it.

    Examples
    --------
    >>> stress = hole_stress(8.2e3, width=0.045, thickness=0.02, hole=0.0279, concentration=2.5)
    >>> print(f"{stress / 1e6:.0f} MPa")
    60 MPa
    """
    require_increasing(hole=hole, width=width)
    return concentration * force / ((width - hole) * thickness)


@formula()
def thread_stress_area(diameter: Values, *, pitch: Values) -> Values:
    """Compute the stress area of a 60 degree thread: pi/4 (d - 0.9382 p)^2. ISO 898-1.

    Parameters
    ----------
    diameter, pitch : float or array
        Nominal diameter d [m], pitch p [m].

    Returns
    -------
    float or array
        Area of the circle that is as strong as the thread. [m2]

    Raises
    ------
    ModelError
        A length not positive, or a pitch too large for the diameter.

    Notes
    -----
    Threads in inches use 0.9743 in place of 0.9382, which changes the area by 1 %.

    Examples
    --------
    Half an inch with 13 threads to the inch; tables have 0.1419 square inches, 91.5 mm2:

    >>> print(f"{1e6 * thread_stress_area(0.0127, pitch=0.0254 / 13):.1f} mm2")
    92.7 mm2
    """
    core = diameter - THREAD_DEPTH * pitch
    require_positive(core_diameter=core)
    return np.pi / 4 * core**2


@formula()
def fatigue_safety(
    amplitude: Values,
    *,
    fatigue_strength: Values,
    mean: Values = 0.0,
    tensile_strength: Values = np.inf,
) -> Values:
    """Compute the factor of safety against fatigue: 1 / (Sa/Se + Sm/Su). Goodman (1899).

    Parameters
    ----------
    amplitude, fatigue_strength : float or array
        Amplitude Sa of the stress [Pa], amplitude Se that the part bears at no mean stress, notches
        and surface included [Pa].
    mean : float or array
        Mean stress Sm, not negative: a mean compression is left out. [Pa]
    tensile_strength : float or array
        Tensile strength Su; needed with a mean stress. [Pa]

    Returns
    -------
    float or array
        Factor of safety; below 1 the part fails, infinite without stress. [1]

    Examples
    --------
    The rod of Farzaneh (2002): 16 of 50 MPa are printed, a factor of 3.1. The shank has 64.7 MPa
    and the thread 88.4 MPa:

    >>> for stress in (16e6, 64.7e6, 88.4e6):
    ...     print(f"{fatigue_safety(stress, fatigue_strength=50e6):.2f}")
    3.12
    0.77
    0.57
    """
    if np.any(np.not_equal(mean, 0)):
        require_positive(tensile_strength=tensile_strength)
    with np.errstate(divide="ignore"):
        return np.divide(1.0, amplitude / fatigue_strength + mean / tensile_strength)
