"""A big end over the cycle of a four-stroke engine against Booker's mobility method, and his forms.

The engine is invented. Its bearing is seen from the rod, so that the pin turns by crank and rod
angle together; a film depends on the sum of both rotations alone. Complex numbers are places and
forces in the plane of the engine, real along the cylinder or the rod.

The mobility method (Booker 1965, 1971) takes the velocity of the pin in the frame without
entrainment from load and place alone. In a short bearing the velocity v makes the pressure
6 eta (v . n) (L^2/4 - z^2) / h^3 with n = (cos a, sin a) from the thinnest film, hence the force
eta L^3 R c^-3 times the integral of (v . n) n / (1 - eps cos a)^3 da: over the circle in a full
film, and over the half with v . n > 0 in a half film, in closed form by Sommerfeld's substitution
1 - eps cos a = (1 - eps^2) / (1 + eps cos g).
"""

from functools import cache

import numpy as np
import numpy.testing as npt
import pytest
from scipy.integrate import solve_ivp

from erlif.models.reynolds import Groove, Journal, Motion, solve_journal
from erlif.models.reynolds.full_film import follow_full_film
from erlif.rig.orbit import Mobility, RigidBearing

BORE, CRANK, ROD = 0.2, 0.135, 0.6  # m
RECIPROCATING = ROTATING = 40.0  # kg, of one cylinder
SPEED = 600 * 2 * np.pi / 60  # rad/s
COMPRESSION, CUT_OFF, AMBIENT = 17.0, 1.8, 1e5  # volume ratios, Pa
VALVE = np.radians([140, 200])  # exhaust opens, and the pressure is ambient from there on

RADIUS, CLEARANCE, VISCOSITY = 0.1, 82.5e-6, 0.015
SIDES = RADIUS - CLEARANCE / 2, RADIUS + CLEARANCE / 2
LENGTH = {"short": 1e-3, "quarter": 0.05}  # L/D = 0.005 and 0.25
UNIT = VISCOSITY * LENGTH["quarter"] ** 3 * RADIUS / CLEARANCE**2  # of the mobility [N s]
FULL = -1e13  # cavitation pressure of a film that never ruptures [Pa]
LONG = Journal(*SIDES, length=0.05, viscosity=VISCOSITY, long=True, cavitation_pressure=FULL)
START = 0.6 + 0.1j  # place of the pin over the clearance
CYCLE = np.linspace(-np.pi, 3 * np.pi, 1441)  # crank angle from firing


def volume(crank):
    """Of the cylinder over that at the dead centre: slider-crank."""
    travel = CRANK * (1 - np.cos(crank)) + ROD * (1 - np.cos(rod_angle(crank)))
    return 1 + (COMPRESSION - 1) * travel / (2 * CRANK)


def rod_angle(crank):
    return np.arcsin(CRANK / ROD * np.sin(crank))


def gas_pressure(crank):
    """Above ambient: p V^1.35 = const, constant while fuel burns, p V^1.3 = const. [Pa]"""
    crank = np.mod(crank + np.pi, 4 * np.pi) - np.pi

    def expansion(at):
        peak = AMBIENT * COMPRESSION**1.35
        return peak * np.minimum(1.0, (CUT_OFF / volume(at)) ** 1.3)

    blowdown = np.interp(crank, VALVE, [expansion(VALVE[0]), AMBIENT])
    compressed = AMBIENT * (COMPRESSION / volume(crank)) ** 1.35
    phases = [compressed, expansion(crank)]
    return np.select([crank < 0, crank < VALVE[0]], phases, blowdown) - AMBIENT


def big_end(crank):
    """Rotation of the pin [rad] and load on it [N], both seen from the rod."""
    ratio, swing = CRANK / ROD, rod_angle(crank)
    second = ratio * np.cos(2 * crank) / np.cos(swing)
    second += ratio**3 * np.sin(2 * crank) ** 2 / (4 * np.cos(swing) ** 3)
    piston = -CRANK * SPEED**2 * (np.cos(crank) + second)
    thrust = np.pi / 4 * BORE**2 * gas_pressure(crank) + RECIPROCATING * piston
    turned = crank + swing
    return turned, thrust / np.cos(swing) - ROTATING * CRANK * SPEED**2 * np.exp(1j * turned)


def short_film(eccentricity, direction=None):
    """Force over velocity, as a matrix; a half film is that of a direction of motion."""
    eps, rest = eccentricity, 1 - eccentricity**2
    ends = np.array([0.0, 2 * np.pi])
    if direction is not None:
        ends = direction + np.pi * np.array([-0.5, 0.5])
        turns = 2 * np.pi * np.round(ends / (2 * np.pi))
        ends = 2 * np.arctan(np.sqrt((1 + eps) / (1 - eps)) * np.tan((ends - turns) / 2)) + turns
    sine = np.sin(ends)
    even = (0.5 + eps**2) * ends + np.sin(2 * ends) / 4 + 2 * eps * sine
    mixed = sine**2 / 2 - eps * np.cos(ends)
    odd = ends / 2 - np.sin(2 * ends) / 4
    even, mixed, odd = np.diff([even, mixed, odd]).ravel() * rest ** np.array([-2.5, -2, -1.5])
    return np.array([[even, mixed], [mixed, odd]])


def half_velocity(eccentricity, force):
    """The potential of the force is convex and of second degree in v: Newton's steps find v."""
    velocity = np.linalg.solve(short_film(eccentricity), force)
    for _ in range(50):
        direction = np.arctan2(velocity[1], velocity[0])
        last, velocity = velocity, np.linalg.solve(short_film(eccentricity, direction), force)
        if np.hypot(*(velocity - last)) < 1e-11 * np.hypot(*velocity):
            return velocity
    raise AssertionError(eccentricity)


def full_velocity(eccentricity, force):
    return np.linalg.solve(short_film(eccentricity), force)


@cache
def mobility_orbit(velocity, unit=UNIT):
    """Places of the pin over the clearance, to 1e-5; the unit is force over velocity. [N s]"""

    def rate(now, place):
        eccentricity, line = np.hypot(*place), complex(*place) / np.hypot(*place)
        force = complex(big_end(np.array(now))[1]) / line
        swing = CRANK / ROD * np.cos(now) / np.cos(rod_angle(now))
        moved = complex(*velocity(eccentricity, np.array([force.real, force.imag])))
        moved = line * (moved / (unit * SPEED) + 0.5j * (1 + swing) * eccentricity)
        return moved.real, moved.imag

    span, start = CYCLE[[0, -1]], [START.real, START.imag]
    case = {"t_eval": CYCLE, "rtol": 1e-6, "atol": 1e-8, "max_step": 0.1}
    along, side = solve_ivp(rate, span, start, method="DOP853", **case).y
    return along + 1j * side


def bearing(kind, **changes):
    """The bearing, and its motion under the load or the share of it that a shorter one carries."""
    joint = Journal(*SIDES, length=LENGTH[kind], viscosity=VISCOSITY, **changes)
    turned, load = big_end(CYCLE)
    share = (LENGTH[kind] / LENGTH["quarter"]) ** 3
    direction = np.unwrap(np.angle(load))
    motion = Motion((CYCLE - CYCLE[0]) / SPEED, turned, share * abs(load), direction)
    return joint, motion


def solved_orbit(kind, cells, grooves, pressure):
    joint, motion = bearing(kind, cavitation_pressure=pressure)
    start = (START.real * CLEARANCE, START.imag * CLEARANCE)
    found = solve_journal(joint, motion, start=start, cells=cells, grooves=grooves, compiled=True)
    return (found.displacement_load.values + 1j * found.displacement_side.values) / CLEARANCE


def lines(count):
    """Lines of supply in the shell, the first two at its joints."""
    return [Groove(np.pi / 2 + k * 2 * np.pi / count) for k in range(count)]


def thinnest(orbit):
    return 1 - abs(orbit).max()


def test_full_film_follows_the_mobility_of_a_short_bearing():
    exact = mobility_orbit(full_velocity)
    joint, motion = bearing("short")
    start = CLEARANCE * np.array([[START.real, START.imag]])
    orbit = follow_full_film(joint, motion, start=start)[0] @ [1, 1j] / CLEARANCE
    npt.assert_allclose(orbit, exact, atol=5e-4)
    npt.assert_allclose(1 - abs(orbit), 1 - abs(exact), rtol=5e-4)


def test_full_film_with_ends_follows_the_mobility_of_chebyshev_collocation():
    rig = Mobility(RigidBearing(RADIUS, CLEARANCE, LENGTH["quarter"], VISCOSITY))
    exact = mobility_orbit(lambda eccentricity, force: force / rig.damping(eccentricity), CLEARANCE)
    found = solved_orbit("quarter", (192, 8), [], FULL)
    npt.assert_allclose(found, exact, atol=1e-3)
    npt.assert_allclose(1 - abs(found), 1 - abs(exact), rtol=1e-3)

    # a third below the form of a short bearing
    share = thinnest(found) / thinnest(mobility_orbit(full_velocity))
    npt.assert_allclose(share, 0.67, atol=0.01)


def test_half_film_is_approached_as_cavities_are_refilled():
    """A half film has full gaps where it closes; conserved oil has them where a line supplied it.

    The thinnest film is that of the expansion stroke, where the film in front was full; at light
    loads orbits differ by the oil that is lacking. The lines cost some of the pressure.
    """
    half = mobility_orbit(half_velocity)
    apart = []
    for count in (2, 16):
        orbit = solved_orbit("short", (1024, 3), lines(count), 0.0)
        npt.assert_allclose(thinnest(orbit), thinnest(half), rtol=0.005 if count == 2 else 0.02)
        assert thinnest(orbit) < thinnest(half)  # as in Yu and Sawicki (2002)
        apart.append(abs(orbit - half).max())
    assert apart[0] > 0.2
    assert apart[1] < apart[0] / 4


@pytest.mark.parametrize("turning", [0.5, 1.0])
def test_load_that_turns_is_one_at_rest_at_another_speed(turning):
    """A load that turns at w is one at rest at the speed W - 2 w (Booker 1965).

    At half speed the film has no capacity, and the pin sinks as without rotation,
    eps / sqrt(1 - eps^2) = t W / K; at the speed of the bushing it stays where a resting load holds
    it at the speed -W (Sommerfeld 1904).
    """
    joint, time = LONG, np.linspace(0.0, 0.1, 401)
    angle = SPEED * time
    if turning == 0.5:
        load, start = 20 * joint.squeeze_constant, 0j
        exact = 20 * time / np.hypot(1, 20 * time) + 0j
    else:
        load = joint.squeeze_constant * SPEED * 0.5 / (2.25 * np.sqrt(0.75))
        start = -0.5j
        exact = np.full(time.size, start)
    motion = Motion(time, angle, load, turning * angle)
    place = (start.real * CLEARANCE, start.imag * CLEARANCE)
    found = solve_journal(joint, motion, start=place, cells=(256, 1))
    orbit = (found.displacement_load + 1j * found.displacement_side).values / CLEARANCE
    npt.assert_allclose(orbit * np.exp(-1j * turning * angle), exact, atol=5e-4)


def test_reciprocating_load_moves_the_pin_as_its_impulse():
    """eps / sqrt(1 - eps^2) = I / K, I the impulse of W cos(w t); no rotation (Booker 1965)."""
    joint, time = LONG, np.linspace(0.0, 0.2, 401)
    impulse = 3 * joint.squeeze_constant * np.sin(SPEED * time)
    load = 3 * joint.squeeze_constant * SPEED * np.cos(SPEED * time)
    found = solve_journal(joint, Motion(time, 0 * time, load), cells=(256, 1))
    size = impulse / joint.squeeze_constant
    npt.assert_allclose(found.displacement_load / CLEARANCE, size / np.hypot(1, size), atol=1e-3)
