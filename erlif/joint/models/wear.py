"""Wear after Archard (1953), worn bushings, and the heat and pv of a sliding joint.

The wear laws are those of Farzaneh (2002) and Strand (2005), who also gives the heat. The worn
bushing is that of Colbert et al. (2009), appendix A. The wear that changes its own forces is that
of Mukras et al. (2008). Arguments that are off by orders of magnitude raise
`erlif.core.errors.UnitWarning`.
"""

from dataclasses import dataclass, replace

import numpy as np

from erlif.core.errors import ModelError
from erlif.joint.models.reaction import SliderCrankBodies, joint_reaction
from erlif.models.arguments import Values, formula
from erlif.models.mechanism import SliderCrank


@formula(load="load or zero")
def adhesive_wear(
    load: Values, *, sliding_distance: Values, hardness: Values, coefficient: Values
) -> Values:
    """Compute the volume worn by adhesion. Archard (1953); Strand (2005), eq. 31.

    V = K F s / H; also Farzaneh (2002), eq. 2.1.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    sliding_distance : float or array
        Sliding distance s. [m]
    hardness : float or array
        Hardness H of the softer body. [Pa]
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
    load : float or array
        Load F. [N]
    sliding_distance : float or array
        Sliding distance s. [m]
    hardness : float or array
        Hardness H of the softer body. [Pa]
    asperity_slope : float or array
        Angle Theta of the hard asperities to the surface, 0 to below pi/2. [rad]

    Returns
    -------
    float or array
        Worn volume V. [m3]

    Examples
    --------
    Asperities of 45 degrees are Archard's law with a coefficient of 2/pi:

    >>> from erlif.joint.models.wear import adhesive_wear
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
    load : float or array
        Load F. [N]
    sliding_distance : float or array
        Sliding distance s. [m]
    hardness : float or array
        Hardness H of the softer body. [Pa]
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


@dataclass(frozen=True)
class WornBushing:
    """A bushing into which the shaft has worn to its steady state.

    Attributes
    ----------
    depth, pressure : Values
        Worn depth [m] and pressure [Pa] on the line of load, which fall off as the cosine.
    volume : Values
        Worn volume. [m3]
    """

    depth: Values
    pressure: Values
    volume: Values


@formula(load="load or zero")
def steady_bushing_wear(
    load: Values,
    *,
    shaft_radius: Values,
    width: Values,
    sliding_distance: Values,
    specific_wear: Values,
) -> WornBushing:
    """Compute the steady wear of a bushing by a rigid shaft. Colbert et al. (2009), appendix A.

    The shaft sinks straight in, so depth and pressure are cosines: P0 = 2F / (pi R w),
    depth0 = k P0 s, V = 2 R w depth0. The torque ratio is
    `erlif.joint.models.friction.cosine_torque_ratio` at 90 degrees.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    sliding_distance : float or array
        Sliding distance s. [m]
    shaft_radius, width, specific_wear : float or array
        Radius R of the shaft [m], width w of the bushing [m], specific wear rate k [1/Pa].

    Returns
    -------
    WornBushing
        Depth [m] and pressure [Pa] on the line of load, and worn volume [m3].

    Notes
    -----
    The middle of eq. A4 should read k P0 D cos(theta); the text that inserts "(A1)" means (A5).

    Examples
    --------
    The volume is that of Archard for the friction path of the whole arc, k (4/pi) F s:

    >>> worn = steady_bushing_wear(
    ...     400.0, shaft_radius=0.005, width=0.01, sliding_distance=1e3, specific_wear=5e-13
    ... )
    >>> print(f"{worn.volume * 1e9:.4f} mm3, {5e-13 * 4 / np.pi * 400.0 * 1e3 * 1e9:.4f} mm3")
    254.6479 mm3, 254.6479 mm3
    """

    # a rigid shaft that sinks along the load wears as cos(theta), so the pressure is a cosine too
    pressure = 2 * load / (np.pi * shaft_radius * width)
    depth = wear_depth(pressure, sliding_distance=sliding_distance, specific_wear=specific_wear)
    return WornBushing(depth, pressure, 2 * shaft_radius * width * depth)


@formula()
def mean_sliding_speed(half_swing: Values, *, diameter: Values, period: Values) -> Values:
    """Compute the mean sliding speed of a swinging joint. Strand (2005), eq. 26.

    v = 2 d beta / t.

    Parameters
    ----------
    half_swing, diameter, period : float or array
        Half of the angle from end to end, beta [rad], diameter d of the pin [m], time t of a swing
        forth and back [s].

    Returns
    -------
    float or array
        Mean sliding speed v. [m/s]

    Notes
    -----
    The nomenclature of the source lists beta in degrees; the equation needs radians.

    Examples
    --------
    The rig of Farzaneh (2002): 24.426 degrees from end to end at 114 rpm.

    >>> speed = mean_sliding_speed(np.radians(24.426) / 2, diameter=0.06672, period=60 / 114)
    >>> print(f"{speed * 1e3:.2f} mm/s")
    54.04 mm/s
    """
    # four times the half swing per period, on half the diameter
    return 2 * diameter * half_swing / period


@formula(load="signed load")
def pressure_velocity(load: Values, *, diameter: Values, width: Values, speed: Values) -> Values:
    """Compute the product pv of projected pressure and speed. Strand (2005), section 2.1.13.

    F v / (d w).

    Parameters
    ----------
    load : float or array
        Load F. [N]
    diameter, width : float or array
        Diameter d and width w of the joint. [m]
    speed : float or array
        Sliding speed v; its sign is kept. [m/s]

    Returns
    -------
    float or array
        pv. [W/m2]

    Examples
    --------
    12.5 MPa at 50 mm/s:

    >>> pv = pressure_velocity(100e3, diameter=0.08, width=0.1, speed=0.05)
    >>> print(f"{pv / 1e6:.3f} W/mm2")
    0.625 W/mm2
    """
    return load * speed / (diameter * width)


@formula(load="load or zero")
def friction_heat(load: Values, *, friction: Values, speed: Values) -> Values:
    """Compute the heat of a sliding joint: Q = mu F |v|. Strand (2005), eqs. 27 and 28.

    Parameters
    ----------
    load : float or array
        Load F. [N]
    friction, speed : float or array
        Friction coefficient mu [1], sliding speed v, in either direction [m/s].

    Returns
    -------
    float or array
        Heat Q. [W]

    Examples
    --------
    >>> print(f"{friction_heat(100e3, friction=0.1, speed=-0.05):.0f} W")
    500 W
    """
    return friction * load * np.abs(speed)  # both directions of motion heat the joint


@formula()
def bushing_heat_share(pin_conductivity: Values, *, bushing_conductivity: Values) -> Values:
    """Compute the share of the friction heat that enters the bushing. Strand (2005), eq. 28.

    1 / (1 + lambda_pin / lambda_bush): slow sliding, both bodies count as at rest.

    Parameters
    ----------
    pin_conductivity, bushing_conductivity : float or array
        Thermal conductivities. [W/(m K)]

    Returns
    -------
    float or array
        Share of the heat. [1]

    Examples
    --------
    4/7 for a steel pin in a bronze bushing:

    >>> print(f"{bushing_heat_share(45.0, bushing_conductivity=60.0):.4f} {4 / 7:.4f}")
    0.5714 0.5714
    """
    # both bodies have the temperature of the contact, so the heat divides as they conduct
    return 1 / (1 + pin_conductivity / bushing_conductivity)


@formula()
def surface_temperature(
    measured_temperature: Values,
    *,
    heat: Values,
    pin_diameter: Values,
    wall: Values,
    width: Values,
    conductivity: Values,
    arc: Values = 2 * np.pi,
) -> Values:
    """Compute the temperature of the sliding surface from one behind it. Strand (2005), eq. 29.

    T_s = T_m + Q ln((d + 2t)/d) / (arc w lambda).

    Parameters
    ----------
    pin_diameter : float or array
        Diameter d of the pin. [m]
    measured_temperature, heat, wall, width, conductivity, arc : float or array
        Temperature T_m on the outside of the bushing [K], heat Q into the bushing [W], wall
        thickness t of the bushing [m], width w of the bushing [m], thermal conductivity lambda of
        the bushing [W/(m K)], angle through which the heat flows, 2 pi for the whole ring [rad].

    Returns
    -------
    float or array
        Temperature T_s of the sliding surface. [K]

    Notes
    -----
    The source has pi in the place of the arc: heat through half of the ring, twice the rise of the
    whole one.

    Examples
    --------
    Heat that flows through half of the ring raises the temperature by twice as much:

    >>> case = {"pin_diameter": 0.08, "wall": 0.01, "width": 0.1, "conductivity": 60.0}
    >>> ring = surface_temperature(300.0, heat=500.0, **case) - 300.0
    >>> half = surface_temperature(300.0, heat=500.0, arc=np.pi, **case) - 300.0
    >>> print(f"{half / ring:.3f}")
    2.000
    """
    # conduction through a cylindrical wall
    return measured_temperature + heat * np.log((pin_diameter + 2 * wall) / pin_diameter) / (
        arc * width * conductivity
    )


@formula()
def thermal_growth(diameter: Values, *, expansion: Values, temperature_change: Values) -> Values:
    """Compute the thermal growth of a diameter: d alpha dT. Strand (2005), eq. 30.

    Parameters
    ----------
    diameter, expansion, temperature_change : float or array
        Diameter d [m], coefficient of linear thermal expansion alpha [1/K], rise of the temperature
        dT [K].

    Returns
    -------
    float or array
        Change of the diameter, positive for growth. [m]

    Examples
    --------
    Steel of 80 mm, 50 K warmer:

    >>> growth = thermal_growth(0.08, expansion=12e-6, temperature_change=50.0)
    >>> print(f"{growth * 1e6:.0f} um")
    48 um
    """
    return diameter * expansion * temperature_change


# Wear depth over bushing radius that one extrapolation of `coupled_wear` may reach. [1]
LARGEST_STEP = 0.1


@dataclass(frozen=True)
class CoupledWear:
    """Wear of a slider-crank joint over its cycles; arrays (n,), from the unworn joint on.

    Attributes
    ----------
    cycles, volume, depth : Values
        Cycles since the joint was new [1], worn volume [m3], largest worn depth [m].
    greatest_force : Values
        Largest joint force of the cycle computed with that wear. [N]
    """

    cycles: Values
    volume: Values
    depth: Values
    greatest_force: Values


@formula(crank_speed="number")
def coupled_wear(
    linkage: SliderCrank,
    *,
    crank_speed: float,
    bodies: SliderCrankBodies,
    bushing_radius: float,
    bushing_width: float,
    specific_wear: float,
    cycles: int,
    extrapolation: int = 500,
    coupled: bool = True,
    steps_per_cycle: int = 360,
) -> CoupledWear:
    """Compute the wear of a crank-pin bushing that changes its own forces. Mukras et al. (2008).

    One cycle of `erlif.joint.models.reaction.joint_reaction` gives V = k R2 int N |d(phi1 - phi2)|
    (eq. 20); it stands for the next `extrapolation` cycles (eq. 5). The depth V / (2 R2 w) then
    lengthens the rod as a clearance.

    Parameters
    ----------
    cycles : int
        Cycles to the end of the test.
    extrapolation : int
        Cycles for which one computed cycle stands, A_E of Mukras et al. (2008), eq. 5.
    steps_per_cycle : int
        Crank angles of a computed cycle.
    linkage : SliderCrank
        Lengths of the unworn linkage. [m]
    crank_speed : float
        Speed of the crank. [rad/s]
    bodies : SliderCrankBodies
        Masses, spring and friction.
    bushing_radius, bushing_width : float
        R2 and w. [m]
    specific_wear : float
        Specific wear rate k. [1/Pa]
    coupled : bool
        False keeps the joint unworn in the dynamics: the source's prediction from initial dynamics.

    Returns
    -------
    CoupledWear
        Cycles, worn volume [m3], depth [m] and largest force [N], from the unworn joint on.

    Raises
    ------
    ModelError
        A value not positive or not finite, an array where one number is needed, or an extrapolation
        that wears more than a tenth of the bushing radius in one step.

    Notes
    -----
    The depth takes the worn bushing for a cosine (`steady_bushing_wear`) in place of the source's
    finite elements. The source does not state the width; about 8.4 mm agrees with its worn mass and
    depth. Its speed "0.5 RPM" is 0.5 turns per second by its own cycles and hours.

    Examples
    --------
    The second test of the source, 21,400 cycles, with preload and width fitted to its first test;
    the source computes 0.1589 g of PTFE (2200 kg/m3).

    >>> from erlif.models.mechanism import SliderCrank
    >>> from erlif.joint.models.reaction import SliderCrankBodies
    >>> bodies = SliderCrankBodies(0.8175, 5500e-6, 5.5487, 525.4, 68.354)
    >>> worn = coupled_wear(
    ...     SliderCrank(crank=0.0762, coupler=0.2032),
    ...     crank_speed=np.pi,
    ...     bodies=bodies,
    ...     bushing_radius=9.535e-3,
    ...     bushing_width=8.468e-3,
    ...     specific_wear=5.05e-13,
    ...     cycles=21_400,
    ...     extrapolation=21_400,
    ...     coupled=False,
    ... )
    >>> print(f"{worn.volume[-1] * 2200 * 1e3:.3f} g")
    0.156 g
    """
    # the end of a cycle is the start of the next, so it is not sampled twice
    crank_angle = np.linspace(0, 2 * np.pi, steps_per_cycle, endpoint=False)
    at, volume, force = [0], [0.0], []
    while True:
        # the cosine of the worn bushing turns volume into depth, and the depth lengthens the rod
        clearance = linkage.clearance + coupled * volume[-1] / (2 * bushing_radius * bushing_width)
        worn = replace(linkage, clearance=clearance)
        reaction = joint_reaction(
            worn, crank_angle=crank_angle, crank_speed=crank_speed, bodies=bodies
        )
        force.append(float(np.max(reaction.force)))
        if at[-1] == cycles:
            break

        # the forces of this cycle stand for the whole step, so the step must not change the joint
        # the mean over equal steps of a periodic function is its integral to the last digit
        turning = np.abs(worn.joint_speed(crank_angle, crank_speed=crank_speed)) / crank_speed
        path = float(np.mean(reaction.normal * turning))
        per_cycle = specific_wear * bushing_radius * path * 2 * np.pi
        step = min(extrapolation, cycles - at[-1])
        if step * per_cycle / (2 * bushing_radius * bushing_width) > LARGEST_STEP * bushing_radius:
            raise ModelError(
                f"extrapolation must be smaller: {step} cycles wear more than a tenth of the "
                "bushing radius."
            )
        at.append(at[-1] + step)
        volume.append(volume[-1] + step * per_cycle)

    depth = np.array(volume) / (2 * bushing_radius * bushing_width)
    return CoupledWear(np.array(at), np.array(volume), depth, np.array(force))
