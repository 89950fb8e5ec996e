"""Shear of an oil film: friction of a round journal and of a patch of film.

Full film without slip: the shear stress at the walls is eta U / h +- (h/2) dp/dx, with the upper
sign at the surface that moves (Hamrock, Schmid and Jacobson 2004). Its first term is
that of Couette. Over a whole journal the second one follows from the forces that balance the film,
whatever its pressure is like: int h dp = -int p dh, and h = c - ex cos phi - ey sin phi.
"""

import numpy as np

from erlif.models.arguments import Values, formula
from erlif.models.reynolds.journal import Journal


@formula(eccentricity="share")
def journal_shear_torque(
    eccentricity: Values, journal: Journal, *, viscosity: Values, speed: Values
) -> Values:
    """Compute the Couette part of the torque of a full film round a journal.

    T = 2 pi eta U R^2 L / (c sqrt(1 - eps^2)), the same on both surfaces. Petroff (1883) at
    eps = 0, Sommerfeld (1904).

    Parameters
    ----------
    eccentricity : float or array
        Displacement of the pin over the radial clearance, eps, below 1. [1]
    journal : Journal
        Radius R and length L of the film, radial clearance c.
    viscosity, speed : float or array
        Dynamic viscosity eta [Pa s], sliding speed U [m/s].

    Returns
    -------
    float or array
        Torque with the sign of the speed. [N m]

    Examples
    --------
    The joint of Farzaneh (2002) at its top speed, centred and at a film of 6 um:

    >>> from erlif.models.reynolds import Journal
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    >>> journal_shear_torque([0.0, 0.974], joint, viscosity=0.12, speed=0.0842).round(4)
    array([0.0733, 0.3236])
    """
    film = journal.clearance * np.sqrt(1 - eccentricity**2)  # of which 1/film is the mean inverse
    return 2 * np.pi * viscosity * speed * journal.radius**2 * journal.length / film


@formula(
    displacement_load="signed number",
    displacement_side="signed number",
    load="signed load",
    side="signed load",
)
def journal_pressure_torque(
    displacement_load: Values, displacement_side: Values, *, load: Values, side: Values = 0.0
) -> Values:
    """Compute the pressure part of the torque on the moving bushing of a round journal.

    T = (ey W - ex S) / 2, half of the moment of both forces about the axis of the bore: int h/2 dp
    over all the film, in parts. The torque on the pin at rest has it with the other sign. It holds
    for wedge and squeeze, with or without cavities, as these have one pressure.

    Parameters
    ----------
    displacement_load, displacement_side : float or array
        Displacement of the pin towards the load ex, and sideways ey, positive in the direction in
        which the surface of the bushing moves. [m]
    load, side : float or array
        Forces of the film that hold the load W, and a sideways support S: the integrals of
        p cos phi and p sin phi over the film. [N]

    Returns
    -------
    float or array
        Torque against the motion. [N m]

    Examples
    --------
    The full film of a long journal carries 12 pi eps / ((2 + eps^2) sqrt(1 - eps^2)) across its
    line of centres. Sommerfeld's torque is 4 pi (1 + 2 eps^2) / ((2 + eps^2) sqrt(1 - eps^2)):

    >>> eps = 0.6
    >>> load = 12 * np.pi * eps / ((2 + eps**2) * np.sqrt(1 - eps**2))
    >>> couette = 2 * np.pi / np.sqrt(1 - eps**2)
    >>> print(f"{couette + journal_pressure_torque(0.0, eps, load=load):.4f}")
    11.4482
    >>> print(f"{4 * np.pi * (1 + 2 * eps**2) / ((2 + eps**2) * np.sqrt(1 - eps**2)):.4f}")
    11.4482
    """
    return (displacement_side * load - displacement_load * side) / 2


@formula(eccentricity="share")
def void_share(eccentricity: Values) -> Values:
    """Bound the share of the Couette torque that cavities take off: eps / (2 (1 + eps)).

    The whole diverging half of the gap has cavities, between which runs the oil that has passed
    the thinnest film: an oil share h_min / h, less than that of Jakobsson and Floberg (1957), whose
    cavities begin behind the thinnest film.

    Parameters
    ----------
    eccentricity : float or array
        Displacement of the pin over the radial clearance, eps. [1]

    Returns
    -------
    float or array
        [1]

    Examples
    --------
    >>> void_share([0.0, 0.5, 1.0]).round(3)
    array([0.   , 0.167, 0.25 ])
    """
    return eccentricity / (2 * (1 + eccentricity))


@formula(tilt="number or zero", length="length", film="film")
def tilt_factor(tilt: Values, *, length: Values, film: Values) -> Values:
    """Compute the Couette torque of a tilted pin over that of a parallel one.

    (sqrt(1 + a) - sqrt(1 - a)) / a, with the change a of the thinnest film from the middle to the
    end over that in the middle: the mean of 1 / sqrt(film) along the axis, for a film that is thin
    against the clearance. It ends at a = 1, where pin and bushing touch.

    Parameters
    ----------
    tilt : float or array
        Change of the displacement along the axis, without sign. [m/m]
    length, film : float or array
        Length of the joint, thinnest film in its middle. [m]

    Returns
    -------
    float or array
        [1]

    Examples
    --------
    >>> tilt_factor([0.0, 20e-6, 1.0], length=0.1, film=2e-6).round(3)
    array([1.   , 1.035, 1.414])
    """
    change = np.clip(tilt * length / (2 * film), 1e-6, 1)  # of zero the limit
    return (np.sqrt(1 + change) - np.sqrt(1 - change)) / change


@formula()
def shear_heating(speed: Values, *, viscosity: Values, conductivity: Values) -> Values:
    """Compute the highest temperature of a sheared film over its walls: eta U^2 / (8 k).

    Couette flow between walls of one temperature, heat by conduction alone.

    Parameters
    ----------
    speed : float or array
        Sliding speed U. [m/s]
    viscosity, conductivity : float or array
        Dynamic viscosity eta [Pa s], thermal conductivity k of the oil [W/(m K)].

    Returns
    -------
    float or array
        [K]

    Examples
    --------
    >>> f"{shear_heating(0.0842, viscosity=0.12, conductivity=0.13):.1g} K"
    '0.0008 K'
    """
    return viscosity * speed**2 / (8 * conductivity)
