"""Play, and what a press fit takes of it. Strand (2005), eqs. 23 to 25."""

from erlif.models.arguments import (
    Values,
    formula,
    require_increasing,
)

RECOMMENDED_PLAY = (0.3, 5.0)
"""Play over pin diameter, eq. 23. [per mille]"""


@formula(bore="length")
def relative_play(pin_diameter: Values, *, bore: Values) -> Values:
    """Compute the relative play of a joint: (D - d) / d. Strand (2005), eq. 23.

    Parameters
    ----------
    pin_diameter : float or array
        Diameter d of the pin. [m]
    bore : float or array
        Diameter D of the bore. [m]

    Returns
    -------
    float or array
        Relative play, negative for an interference; 0.3e-3 to 5e-3 is recommended. [1]

    Raises
    ------
    ModelError
        A diameter not positive or not finite.

    Examples
    --------
    The joint of Farzaneh (2002) lies outside the recommended range:

    >>> print(f"{1e3 * relative_play(0.06672, bore=0.06718):.2f} per mille")
    6.89 per mille
    """
    return (bore - pin_diameter) / pin_diameter


@formula(
    interference="signed length",
    bore="length",
    youngs_bushing="modulus",
    youngs_housing="modulus",
    fit_diameter="signed length",
    housing_diameter="signed length",
    poisson_bushing="poisson",
    poisson_housing="poisson",
)
def press_fit_displacement(
    interference: Values,
    *,
    bore: Values,
    fit_diameter: Values,
    housing_diameter: Values,
    youngs_bushing: Values,
    poisson_bushing: Values,
    youngs_housing: Values,
    poisson_housing: Values,
) -> Values:
    """Compute the displacement of the bore of a pressed-in bushing. Strand (2005), eqs. 24 and 25.

    u = -Delta d_b D / {E_b (D^2 - d_b^2) [(k_h + nu_h)/E_h + (k_b - nu_b)/E_b]},
    k_h = (D_h^2 + D^2)/(D_h^2 - D^2), k_b = (D^2 + d_b^2)/(D^2 - d_b^2): Lame's rings in plane
    stress. With one material this is eq. 24.

    Parameters
    ----------
    interference : float or array
        Outer diameter of the bushing less bore of the housing, Delta. [m]
    bore, fit_diameter, housing_diameter : float or array
        Inner diameter d_b and outer diameter D of the bushing, outer diameter D_h of the housing.
        [m]
    youngs_bushing, youngs_housing : float or array
        Young's moduli E_b and E_h. [Pa]
    poisson_bushing, poisson_housing : float or array
        Poisson's ratios nu_b and nu_h. [1]

    Returns
    -------
    float or array
        Radial displacement u of the bore, negative where it shrinks (by 2u in diameter). [m]

    Raises
    ------
    ModelError
        A diameter or modulus not positive or not finite, a Poisson's ratio outside -1 to 0.5,
        diameters that do not grow from bore to housing, or an infinite interference.

    Notes
    -----
    Eq. 25 prints d_b D^2 (3 nu_h - 5)/4 where d_b D belongs; with equal materials the print does
    not become eq. 24. Delta is a play in the nomenclature of the source and an interference here.

    Examples
    --------
    A steel bushing in a steel housing, against eq. 24:

    >>> steel = {"youngs_bushing": 206e9, "youngs_housing": 206e9}
    >>> steel |= {"poisson_bushing": 0.3, "poisson_housing": 0.3}
    >>> u = press_fit_displacement(
    ...     60e-6, bore=0.07, fit_diameter=0.08, housing_diameter=0.16, **steel
    ... )
    >>> print(f"{u * 1e6:.3f} um, {-30 * 7 / 8 * (16**2 - 8**2) / (16**2 - 7**2):.3f} um")
    -24.348 um, -24.348 um
    """
    require_increasing(bore=bore, fit_diameter=fit_diameter, housing_diameter=housing_diameter)

    # radial displacement of each ring at the fit, over radius and pressure (Lame)
    k_h = (housing_diameter**2 + fit_diameter**2) / (housing_diameter**2 - fit_diameter**2)
    k_b = (fit_diameter**2 + bore**2) / (fit_diameter**2 - bore**2)
    compliance = (k_h + poisson_housing) / youngs_housing + (k_b - poisson_bushing) / youngs_bushing
    return (
        -interference
        * bore
        * fit_diameter
        / (youngs_bushing * (fit_diameter**2 - bore**2) * compliance)
    )
