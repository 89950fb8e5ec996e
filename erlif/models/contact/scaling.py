"""Geometry and material of a contact, and the scaling of loads between materials."""

from erlif.models.arguments import Values, formula, require_increasing


@formula()
def conformal_radius(pin_radius: Values, *, bushing_radius: Values) -> Values:
    """Compute the reduced radius of a pin in a bushing. Farzaneh (2002), eq. 2.8.

    R = R1 R2 / (R1 - R2).

    Parameters
    ----------
    pin_radius, bushing_radius : float or array
        Radii R2 of the pin and R1 of the bore. [m]

    Returns
    -------
    float or array
        Reduced radius R. [m]

    Raises
    ------
    ModelError
        A radius not positive or not finite, or a bushing not larger than its pin.

    Examples
    --------
    The joint of Farzaneh (2002); the source gives 4.872 m.

    >>> print(f"{conformal_radius(0.03336, bushing_radius=0.03359):.3f} m")
    4.872 m
    """
    require_increasing(pin_radius=pin_radius, bushing_radius=bushing_radius)
    return pin_radius * bushing_radius / (bushing_radius - pin_radius)


@formula()
def contact_modulus(
    youngs_1: Values, *, poisson_1: Values, youngs_2: Values, poisson_2: Values
) -> Values:
    """Compute the contact modulus E* of two bodies. Farzaneh (2002), eq. B.1.

    1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.

    Parameters
    ----------
    youngs_1, youngs_2, poisson_1, poisson_2 : float or array
        Young's moduli [Pa], Poisson's ratios [1].

    Returns
    -------
    float or array
        Contact modulus E*. [Pa]

    Notes
    -----
    The E' of Strand (2005) is this E*. The E' of the film formulas of Dowson, Higginson and Hamrock
    is 2 E*.

    Examples
    --------
    Steel on steel, 200 GPa and 0.3: half of 200 / 0.91 GPa.

    >>> modulus = contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)
    >>> print(f"{modulus / 1e9:.2f} GPa")
    109.89 GPa
    """
    return 1 / ((1 - poisson_1**2) / youngs_1 + (1 - poisson_2**2) / youngs_2)


@formula(load="signed load")
def scale_load(
    load: Values,
    *,
    youngs_modulus: Values,
    model_youngs_modulus: Values,
    length_ratio: Values = 1.0,
) -> Values:
    """Compute the load that strains a model joint like the full one. Farzaneh (2002), eq. 3.13.

    The group F / (E D l) is kept.

    Parameters
    ----------
    load, youngs_modulus, model_youngs_modulus, length_ratio : float or array
        Load F on the full joint [N], Young's moduli of the full joint and of the model [Pa],
        lengths of the model over those of the full joint [1].

    Returns
    -------
    float or array
        Load on the model. [N]

    Notes
    -----
    Complete similarity also keeps D/l, d/l and Poisson's ratio. Steel (0.3) and acrylic (0.37)
    differ in the last. Stresses then scale as the moduli, see `scale_stress`.

    Examples
    --------
    An acrylic joint has 1/75 of the modulus of steel: 100,000 lbf become 1333 lbf, as the source
    states. The load keeps its unit.

    >>> load = scale_load(100e3, youngs_modulus=202.5e9, model_youngs_modulus=2.7e9)
    >>> print(f"{load:.0f} lbf")
    1333 lbf
    """
    # area and modulus both scale the load of a given strain
    return load * model_youngs_modulus / youngs_modulus * length_ratio**2


@formula()
def scale_stress(stress: Values, *, youngs_modulus: Values, model_youngs_modulus: Values) -> Values:
    """Compute the stress in a model joint. Farzaneh (2002), eq. 3.13.

    Under the load of `scale_load` the ratio sigma / E is kept.

    Parameters
    ----------
    stress, youngs_modulus, model_youngs_modulus : float or array
        Stress in the full joint [Pa], Young's moduli of the full joint and of the model [Pa].

    Returns
    -------
    float or array
        Stress in the model. [Pa]

    Examples
    --------
    >>> stress = scale_stress(7.5e6, youngs_modulus=202.5e9, model_youngs_modulus=2.7e9)
    >>> print(f"{stress / 1e6:.2f} MPa")
    0.10 MPa
    """
    return stress * model_youngs_modulus / youngs_modulus
