"""What the models refuse beside the kinds of their arguments: one table for each of them.

Kinds are declared, and `test_numbers` and `test_arguments` hold what is refused of them. Here stand
conditions between arguments, of one row for each: the change of a case that is accepted, and a part
of the message that names what is wrong.
"""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from erlif.core.errors import ModelError
from erlif.joint.models import bearing, friction, linkage, wear
from erlif.joint.models import edges as e
from erlif.joint.models.clearance_fit import fit_clearances
from erlif.joint.models.linkage.domain import find_domain
from erlif.joint.models.reaction import SliderCrankBodies
from erlif.joint.models.running_in import run_in_bushing
from erlif.joint.models.slider.contact import ContactLaw, WornBore
from erlif.joint.models.slider_dynamics import simulate_slider_crank
from erlif.joint.models.slider_wear import WearingJoint, bound_extrapolation, wear_slider_crank
from erlif.models import contact, film, oil
from erlif.models import reynolds as r
from erlif.models.mechanism import CrankRocker, SliderCrank, crank_for_swing
from erlif.models.oil_fit import fit_viscosity, sae_oil
from erlif.models.reynolds.full_film import FullFilm, follow_full_film
from erlif.models.reynolds.journal import as_mount

pytestmark = pytest.mark.filterwarnings("ignore::erlif.core.errors.UnitWarning")

NONE = np.nan
FIVE = np.array([200e-6, 100e-6, 50e-6, 25e-6, 15e-6])
RIG = {"crank": 0.055, "coupler": 0.44, "rocker": 0.26, "ground": 0.51}
CRANK = SliderCrank(0.0762, 0.2032, clearance=10e-6)
BODIES = SliderCrankBodies(0.8175, 5.5e-3, 5.5487, 525.4, 47.248, 0.15, 9.525e-3)
JOINT = WearingJoint(8.551e-3, thickness=3e-3, modulus=0.26e9, specific_wear=5.05e-13)
TEMPERATURES = np.array([283.15, 298.15, 313.15, 333.15, 353.15, 373.15])
LAW = oil.vogel_viscosity(TEMPERATURES, a=6e-5, b=950.0, c=178.0)
PIN = r.Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
TIME = np.linspace(0.0, 1.0, 5)
TURNING = r.Motion(TIME, 0 * TIME, load=222.4, load_direction=TIME)
REST = r.Motion(TIME, 0 * TIME, load=222.4)
BUSHING = e.EdgeJoint(0.03336, 0.03359, 0.0533, length=0.06, pin_length=0.12)
CELLS = (np.arange(36) - 18) * 2 * np.pi / 36


def profile(depth=0.0, cells=CELLS):
    both = dict.fromkeys(("depth", "pin_depth"), ("angle", depth + 0 * cells))
    return xr.Dataset(both, {"angle": cells})


def fit_bushings(clearance=FIVE, friction=0.12 + 0 * FIVE, **changes):
    errors = {"friction_std": 0.002, "clearance_std": 3e-6}
    wall = {"load_per_length": 4e4, "shaft_radius": 5e-3, "thickness": 3e-3}
    return fit_clearances(clearance, friction=friction, **errors | wall | changes)


def walther(temperature_2=373.15, viscosity_1=1e-4):
    points = {"viscosity_1": viscosity_1, "temperature_1": 313.15, "viscosity_2": 1e-5}
    return oil.walther_viscosity(300.0, **points, temperature_2=temperature_2)


def fit_oil(temperatures=TEMPERATURES, viscosities=LAW, **changes):
    return fit_viscosity(temperatures, viscosities=viscosities, **changes)


def wear_bushing(**changes):
    wall = {"bushing_radius": 5.175e-3, "width": 10e-3, "thickness": 3e-3, "modulus": 1e9}
    case = {"shaft_radius": 5e-3, "specific_wear": 5e-13, "sliding_distance": [0.0]}
    return run_in_bushing(100.0, **case | wall | changes)


def wear_crank(**changes):
    case = {"crank_speed": np.pi, "bodies": BODIES, "joint": JOINT, "cycles": 10, "cells": 90}
    return wear_slider_crank(CRANK, **case | changes)


def simulate(**changes):
    case = {"bodies": BODIES, "crank_speed": 3.0, "duration": 1.0}
    return simulate_slider_crank(CRANK, **case | changes)


THIN, FLAT = np.full(4, 1e-6), np.zeros((4, 4))


def solve_film(thickness=THIN, **changes):
    case = {"length": 0.01, "viscosity": 0.1, "entrainment": 1.0}
    return r.solve_film(thickness, **case | changes)


def solve_journal(motion=REST, **changes):
    return r.solve_journal(PIN, motion, **{"cells": (64, 2)} | changes)


def press(gap=FLAT, **changes):
    return e.solve_contact(gap, **{"spacing": 1e-3, "contact_modulus": 1e9} | changes)


def drive(**changes):
    case = {"crank_speed": 12.0, "torque": 1.0}
    return linkage.drive_power(CrankRocker(**RIG), **case | changes)


def curve(one, two):
    return contact.relative_radii(one, radius_1_across=0.1, radius_2=two, radius_2_across=0.2)


def press_shaft(load, shaft):
    wall = {"bushing_radius": 0.01, "thickness": 1e-3, "modulus": 1e9}
    return contact.winkler_contact(load, shaft_radius=shaft, **wall)


def sweep(stroke):
    oil = {"viscosity": 0.12, "pressure_viscosity": 2e-8}
    bodies = {"load_per_length": 1e6, "radius": 4.87, "contact_modulus": 1.1e11}
    return film.line_contact_film(0.04, stroke=stroke, **oil, **bodies)


def average(torque, direction):
    return friction.average_reversals(torque, load=1.0, radius=1.0, direction=direction)


def vogel(temperatures, viscosities):
    return oil.fit_vogel(temperatures, viscosities=viscosities)


# one condition of a function each
CALLS = {
    "above the Vogel": lambda: oil.vogel_viscosity(150.0, a=1e-4, b=900.0, c=170.0),
    "viscosity must exceed": lambda: oil.roelands_viscosity(
        1e8, viscosity=1e-5, pressure_viscosity=2e-8
    ),
    "pressure must exceed": lambda: oil.roelands_viscosity(
        -3e8, viscosity=0.1, pressure_viscosity=2e-8
    ),
    "between 0 and 1, got 95": lambda: fit_oil().interval(303.0, probability=95),
    "above the Vogel constant c": lambda: fit_oil().viscosity(150.0),
    "10, 20.* of SAE, got 35": lambda: sae_oil(35),
    "hole_ratio": lambda: bearing.hole_stress_concentration(0.3),
    "^load must stay below 24 E I": lambda: bearing.lateral_shift(
        1e9, length=0.18, diameter=0.01, youngs_modulus=206e9
    ),
    "shortest link, and crank plus": lambda: CrankRocker(**RIG | {"crank": 0.3}),
    "coupler must be longer": lambda: SliderCrank(0.2, 0.1),
    "slider_position must lie in the reach": lambda: CRANK.crank_angle_from_slider(
        0.3, rising=True
    ),
    "swing must be less than": lambda: crank_for_swing(3.0, coupler=0.44, rocker=0.26, ground=0.51),
    "close no triangle": lambda: crank_for_swing(0.1, coupler=0.44, rocker=0.26, ground=0.8),
    r"no crank-rocker has crank 0\.3 m, rocker 0\.26 m": lambda: find_domain(
        {"crank": 0.3, "rocker": 0.26}, None
    ),
    "efficiency must be at most 1": lambda: drive(efficiency=1.2),
    "points must be 8 at least": lambda: drive(points=3),
    "the largest rating": lambda: linkage.choose_motor(1e7),
    "series must be hp or kW": lambda: linkage.choose_motor(1e3, series="PS"),
    "width must exceed hole": lambda: linkage.hole_stress(
        1e3, width=0.02, thickness=0.01, hole=0.02, concentration=2.5
    ),
    "halvings must be 2 or more": lambda: bound_extrapolation(2, wear=print),
    "extrapolation must be smaller": lambda: wear.coupled_wear(
        CRANK,
        crank_speed=np.pi,
        bodies=BODIES,
        bushing_radius=9.5e-3,
        bushing_width=8e-3,
        specific_wear=5e-13,
        cycles=10**7,
        extrapolation=10**7,
    ),
    r"^asperity_slope must lie .* got 2 rad": lambda: wear.abrasive_wear(
        1.0, sliding_distance=1.0, hardness=1e9, asperity_slope=2.0
    ),
    "bushing_radius must exceed pin_radius": lambda: contact.conformal_radius(
        0.0336, bushing_radius=0.0336
    ),
    "interference must be at least": lambda: contact.closed_contact_pressure(
        1e6, interference=1e-7, pin_diameter=0.08, youngs_modulus=2e11
    ),
    "larger reduced radius": lambda: contact.hertz_ellipse(
        1.0, radius=1.0, radius_across=2.0, contact_modulus=1e11
    ),
    "^radius_2 must not be zero": lambda: curve(0.1, [0.2, 0.0]),
    "gap all round": lambda: curve([0.1, -0.1], 0.2),
    "bushing_radius must exceed shaft_radius": lambda: press_shaft(1.0, 0.011),
    "wraps the contact to 90 degrees": lambda: press_shaft(1e9, 0.009),
    r"below 0\.5": lambda: contact.winkler_modulus(1e9, poisson=0.5),
    "stroke must be one number": lambda: sweep([0.007, 0.008]),
    "stroke must not be negative": lambda: sweep(-0.007),
    "roughness_a and": lambda: film.film_parameter(1e-6, roughness_a=0.0, roughness_b=0.0),
    "0 backward": lambda: average(np.ones(5), np.ones(5)),
    "^torque and direction must be columns of one length": lambda: average(np.ones(4), [1, 1, -1]),
    "below pi/2": lambda: friction.thin_winkler_load([0.5, np.pi / 2]),
    "crank at rest": lambda: r.crank_motion(CrankRocker(**RIG), crank_speed=0.0, load=5.0),
    "rest of a mount must be finite": lambda: r.Mount(rest=NONE),
    "speed must not be zero": lambda: r.steady_journal(PIN, speed=0.0, load=1.0),
    "No film carries": lambda: r.steady_journal(PIN, speed=1.0, load=1e9, cells=(64, 2)),
    "has an elastic liner": lambda: FullFilm.of(replace(PIN, foundation=1e12)),
    "outside the clearance": lambda: follow_full_film(PIN, REST, start=np.array([[231e-6, 0.0]])),
    r"over \(x, z\)": lambda: e.subsurface_stress(
        xr.Dataset({"pressure": ("x", [1.0, 2.0])}), depth=1.0
    ),
    "infinite": lambda: e.lundberg_profile(0.01, load=1.0, length=0.02, contact_modulus=1e11),
    "modulus_ratio": lambda: e.edge_exponent(1.0, modulus_ratio=0.0),
    "does not fit": lambda: replace(BUSHING, undercut=e.Undercut(0.02, 0.015, 0.01)),
}


DOORS = {
    "series of bushings": (
        fit_bushings,
        ({"clearance": FIVE[:2], "friction": [0.1, 0.1]}, "3 or more bushings"),
        ({"clearance": 0 * FIVE}, "must differ"),
        ({"friction": FIVE * NONE}, "must not be NaN"),
        ({"friction_std": NONE}, "friction_std must be one number"),
        ({"known_modulus": (1e15, 0.1)}, "known_modulus must lie in"),
    ),
    "Vogel's law": (
        vogel,
        (([300.0, 300.0, 310.0], [1.0, 0.5, 0.3]), "temperatures must differ"),
        ((300.0, 0.5), r"three each, got shapes \(\) and \(\)"),
        (([300.0, 310.0, NONE], [1.0, 0.5, 0.3]), "must be a number"),
        (([300.0, 310.0, 320.0], [1.0, 0.8, 0.2]), "Vogel curve"),
    ),
    "Walther's law": (
        walther,
        ({"viscosity_1": 1e-6}, "viscosity_1 must be at least 2e-6"),
        ({"temperature_2": 313.15}, "must differ"),
    ),
    "measured viscosities": (
        fit_oil,
        ({"temperatures": TEMPERATURES[:3], "viscosities": LAW[:3]}, "4 or more different"),
        ({"viscosities": LAW * NONE}, "must not be NaN"),
        ({"law": "andrade"}, "got 'andrade'"),
        ({"viscosities": LAW[::-1], "relative_std": 0.01}, "do not determine c"),
        ({"viscosities": 1e-6 + 0 * LAW, "law": "walther"}, "at least 2e-6"),
        ({"viscosities": 1e-7 * TEMPERATURES, "law": "walther"}, "must fall with temperature"),
        ({"relative_std": [0.01, 0.01]}, "one for each viscosity .* or 6"),
    ),
    "running in": (
        wear_bushing,
        ({"sliding_distance": [1.0, 0.5]}, "rising distances"),
        ({"sliding_distance": [1e5]}, "worn through"),
        ({"cells": 40}, "Choose more cells"),
        ({"modulus": 1e5}, "presses the shaft through the wall"),
    ),
    "synthesis": (
        linkage.synthesise_crank_rocker,
        (
            {"crank": 0.1, "swing": 1.0},
            "or one with two of swing, speed ratio and time ratio; got crank",
        ),
        ({"crank": 0.1, "ground": 1.0}, "two unknown lengths need a target"),
        (RIG | {"swing": 4.0}, "swing must be below half a turn"),
        (RIG | {"time_ratio": 0.9}, "time_ratio must be at least 1"),
        (RIG | {"largest_size": (0.0, 1.0)}, "largest_size must be positive"),
        (RIG | {"crank_speed": 1.0, "rocker_speed": 1.0, "speed_ratio": 1.0}, "two of the three"),
        (RIG | {"crank": 0.3}, "are no crank-rocker"),
    ),
    "wear of the slider-crank": (
        wear_crank,
        ({"bodies": replace(BODIES, pin_radius=0.0)}, "pin_radius must be positive"),
        ({"cycles": 500_000, "extrapolation": 20_000}, "worn through"),
        ({"contact": ContactLaw(1e7), "steps_per_cycle": 3}, "impacts"),
        ({"bodies": SliderCrankBodies(0.0, 0.0, 0.0, pin_radius=9.5e-3)}, "carries no force"),
    ),
    "motion of the slider-crank": (
        simulate,
        (
            {"contact": ContactLaw(1e9), "eccentricity": (NONE, 0.0)},
            "eccentricity must be two finite",
        ),
        (
            {"contact": ContactLaw(1e9), "torque": lambda time, angle: 2.0},
            "crank_inertia must be positive",
        ),
        ({"bodies": replace(BODIES, slider_mass=0.0)}, "slider_mass"),
        ({"worn": profile()}, "contact must be given"),
    ),
    "worn bore": (
        lambda clearance, worn: WornBore(ContactLaw(6.523e8), clearance, worn),
        ((0.0, profile()), "clearance must be positive where the joint is worn"),
        ((1e-4, profile().expand_dims(cycle=2)), "isel"),
        ((1e-4, profile(cells=CELLS[:12])), "24 cells or more"),
        ((1e-4, profile(-1e-6)), "numbers and not negative"),
    ),
    "Persson": (
        lambda name, *first, **rest: getattr(contact, f"persson_{name}")(*first, **rest),
        (("half_angle", -1.0), "must exceed -2/pi"),
        (("load", 2.0), {"play": 1e-4, "youngs_modulus": 2e11}, "half_angle must be below 84.8"),
        (("load", 1.0), {"play": 0.0, "youngs_modulus": 2e11}, "^play must not be zero"),
        (
            ("contact", 1e5),
            {"play": -1e-4, "pin_diameter": 0.08, "youngs_modulus": 2e11},
            "^play must keep .* above -2/pi",
        ),
    ),
    "sampled pressure": (
        lambda angle, pressure: friction.torque_ratio(angle, pressure=pressure),
        (([0.5, 0.0], [1.0, 1.0]), "^angle must rise"),
        (([2.0, 2.5], [1.0, 1.0]), "^pressure must carry a load .* got an integral of -0"),
        (([0.0, 0.5], [1.0, 1.0, 1.0]), "^angle and pressure must hold the same number"),
    ),
    "journal": (
        lambda **changes: replace(PIN, **changes),
        ({"bushing_radius": 0.033}, "bushing_radius must exceed pin_radius"),
        ({"cavitation_pressure": 1e5}, "at most 0"),
        ({"axial_shape": [0.0, 1e-6], "long": True}, "has no axial shape"),
        ({"axial_shape": [0.0]}, "two or more finite heights"),
    ),
    "motion": (
        lambda **changes: r.Motion(
            **{"time": [0.0, 1.0, 2.0], "angle": [0.0, 0.0, 0.0], "load": 1.0} | changes
        ),
        ({"time": [0.0, 1.0, 1.0]}, "two or more increasing"),
        ({"angle": [0.0, 1.0]}, "angle must have one value for each of the 3 times"),
        ({"load": NONE}, "load must be finite"),
    ),
    "mount": (
        lambda sideways: as_mount(sideways).direction_for(TURNING),
        (("guided",), "needs a direction"),
        (("loose",), "'loose'"),
        ((-1.0,), "not be negative"),
    ),
    "transient film": (
        solve_journal,
        ({"start": (2.4e-4, 0.0)}, "start lies outside the clearance"),
        ({"start": (NONE, 0.0)}, "two displacements"),
        ({"cells": (63, 4)}, "even number"),
        ({"frame": "crank"}, 'frame must be "half-angle" or "laboratory"'),
        ({"maps": [99]}, "steps from 0 to 4"),
        ({"motion": r.Motion([0.0, 1.0, 2.0], np.zeros(3), load=1e8)}, "No film"),
    ),
    "film of given shape": (
        solve_film,
        ({"thickness": [1e-6, 1e-6, -1e-6, 1e-6]}, "positive and finite"),
        ({"thickness": 1e-6}, "array"),
        ({"thickness": np.full((4, 4), 1e-6)}, "needs a width"),
        ({"thickness": np.full(5, 1e-6), "closed": True}, "even number of cells"),
        ({"entrainment": 0.0}, "needs an entrainment"),
        ({"entrainment": [1.0, 2.0]}, "one for each film .* or 1"),
        ({"time": [0.0, 1.0]}, "with time"),
        ({"thickness": np.full((2, 4), 1e-6), "time": [1, 0]}, "2 increasing values"),
        ({"film_rate": np.zeros(4), "load": 5.0}, "give no load"),
        ({"cavitation_pressure": 1.0}, "at most 0"),
        ({"film_rate": np.zeros(4), "void_fraction": np.full(4, 1.5)}, "from 0 to 1 for 4 cells"),
        (
            {"thickness": np.full((2, 4), 1e-6), "time": [0, 1], "void_fraction": np.zeros(4)},
            "give them without time",
        ),
    ),
    "half spaces": (
        press,
        ({"load": 1.0, "approach": 1.0}, "either a load or an approach"),
        ({"load": 1.0, "free_tilt": True, "load_position": (0.0, 9.0)}, "outside the grid"),
        ({"gap": [0.0, NONE], "load": 1.0}, "not finite"),
        ({"gap": np.zeros((2, 2, 2)), "load": 1.0}, "got the shape"),
        ({"gap": np.zeros(9), "load": 1.0, "mirror": 1.0}, "neither ends nor tilt"),
    ),
    "joint of finite length": (
        lambda **changes: replace(BUSHING, **changes),
        ({"bushing_radius": 0.03}, "pin_radius"),
        ({"pin_length": 0.05}, "pin_length"),
    ),
    "cells of a joint": (
        lambda joint=BUSHING, **changes: e.prepare_joint(joint, **changes),
        ({"joint": replace(BUSHING, pin_length=0.06)}, "load_span"),
        ({"refine": [0.2]}, "refine"),
        ({"growth": 0.5}, "growth"),
    ),
}


@pytest.mark.parametrize("name", DOORS)
def test_what_has_no_meaning_is_refused_by_name(name):
    door, *rows = DOORS[name]
    for *given, words in rows:
        first = [value for part in given if isinstance(part, tuple) for value in part]
        named = next((part for part in given if isinstance(part, dict)), {})
        with pytest.raises(ModelError, match=words):
            door(*first, **named)


@pytest.mark.parametrize("words", CALLS)
def test_a_condition_that_does_not_hold_is_named(words):
    with pytest.raises(ModelError, match=words):
        CALLS[words]()
