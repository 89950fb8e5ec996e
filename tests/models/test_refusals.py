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
from erlif.models import bearing, contact, film, friction, linkage, oil, wear
from erlif.models import edges as e
from erlif.models import reynolds as r
from erlif.models.clearance_fit import fit_clearances
from erlif.models.linkage.domain import find_domain
from erlif.models.mechanism import CrankRocker, SliderCrank, crank_for_swing
from erlif.models.oil_fit import fit_viscosity, sae_oil
from erlif.models.reaction import SliderCrankBodies
from erlif.models.reynolds.full_film import FullFilm, follow_full_film
from erlif.models.reynolds.journal import as_mount
from erlif.models.running_in import run_in_bushing
from erlif.models.slider.contact import ContactLaw, WornBore
from erlif.models.slider_dynamics import simulate_slider_crank
from erlif.models.slider_wear import WearingJoint, bound_extrapolation, wear_slider_crank

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
BUSHING = e.Joint(0.03336, 0.03359, 0.0533, length=0.06, pin_length=0.12)
CELLS = (np.arange(36) - 18) * 2 * np.pi / 36


def profile(depth=0.0, cells=CELLS):
    both = dict.fromkeys(("depth", "pin_depth"), ("angle", depth + 0 * cells))
    return xr.Dataset(both, {"angle": cells})


def fit_bushings(clearance=FIVE, friction=0.12 + 0 * FIVE, **changes):
    errors = {"friction_std": 0.002, "clearance_std": 3e-6}
    wall = {"load_per_length": 4e4, "shaft_radius": 5e-3, "thickness": 3e-3}
    return fit_clearances(clearance, friction=friction, **errors | wall | changes)


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


def undercut(depth, width, lip):
    return replace(BUSHING, undercut=e.Undercut(depth, width, lip))


def vogel(temperatures, viscosities):
    return oil.fit_vogel(temperatures, viscosities=viscosities)


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
    "oil": (
        lambda law, *first, **rest: getattr(oil, law)(*first, **rest),
        (("vogel_viscosity", 150.0), {"a": 1e-4, "b": 900.0, "c": 170.0}, "above the Vogel"),
        (
            ("roelands_viscosity", 1e8),
            {"viscosity": 1e-5, "pressure_viscosity": 2e-8},
            "viscosity must exceed",
        ),
        (
            ("roelands_viscosity", -3e8),
            {"viscosity": 0.1, "pressure_viscosity": 2e-8},
            "pressure must exceed",
        ),
    ),
    "measured viscosities": (
        fit_oil,
        ({"temperatures": TEMPERATURES[:3], "viscosities": LAW[:3]}, "4 or more different"),
        ({"viscosities": LAW * NONE}, "must not be NaN"),
        ({"law": "andrade"}, "got 'andrade'"),
        ({"viscosities": LAW[::-1], "relative_std": 0.01}, "do not determine c"),
        ({"viscosities": 1e-6 + 0 * LAW, "law": "walther"}, "at least 2e-6"),
        ({"viscosities": 1e-7 * TEMPERATURES, "law": "walther"}, "must fall with temperature"),
        ({"relative_std": [0.01, 0.01]}, "one for each of 6"),
    ),
    "fitted law": (
        lambda name, *first, **rest: getattr(fit_oil(), name)(*first, **rest),
        (("interval", 303.0), {"probability": 95}, "between 0 and 1, got 95"),
        (("viscosity", 150.0), "above the Vogel constant c"),
    ),
    "SAE grade": (sae_oil, ((35,), "10, 20.* of SAE, got 35")),
    "running in": (
        wear_bushing,
        ({"sliding_distance": [1.0, 0.5]}, "rising distances"),
        ({"sliding_distance": [1e5]}, "worn through"),
        ({"cells": 40}, "Choose more cells"),
        ({"modulus": 1e5}, "presses the shaft through the wall"),
    ),
    "bearing": (
        lambda name, *first, **rest: getattr(bearing, name)(*first, **rest),
        (("hole_stress_concentration", 0.3), "hole_ratio"),
        (
            ("lateral_shift", 1e9),
            {"length": 0.18, "diameter": 0.01, "youngs_modulus": 206e9},
            "^load must stay below 24 E I",
        ),
    ),
    "crank-rocker": (
        CrankRocker,
        (RIG | {"crank": 0.3}, "shortest link"),
    ),
    "slider-crank": (
        SliderCrank,
        ((0.2, 0.1), "coupler must be longer"),
    ),
    "encoder of the slider": (
        lambda x: CRANK.crank_angle_from_slider(x, rising=True),
        ((0.3,), "slider_position must lie in the reach"),
    ),
    "swing": (
        crank_for_swing,
        ((3.0,), {"coupler": 0.44, "rocker": 0.26, "ground": 0.51}, "swing must be less than"),
        ((0.1,), {"coupler": 0.44, "rocker": 0.26, "ground": 0.8}, "close no triangle"),
    ),
    "domain of linkages": (
        lambda given: find_domain(given, None),
        (({"crank": 0.3, "rocker": 0.26},), r"no crank-rocker has crank 0\.3 m, rocker 0\.26 m"),
    ),
    "synthesis": (
        linkage.synthesise_crank_rocker,
        ({"crank": 0.1, "swing": 1.0}, "rocker and ground at least must be given, got crank"),
        ({"crank": 0.1, "ground": 1.0}, "two unknown lengths need a target"),
        (RIG | {"swing": 4.0}, "swing must be below half a turn"),
        (RIG | {"time_ratio": 0.9}, "time_ratio must be at least 1"),
        (RIG | {"largest_size": (0.0, 1.0)}, "largest_size must be positive"),
        (RIG | {"crank_speed": 1.0, "rocker_speed": 1.0, "speed_ratio": 1.0}, "two of the three"),
        (RIG | {"crank": 0.3}, "are no crank-rocker"),
    ),
    "drive": (
        lambda **changes: linkage.drive_power(
            CrankRocker(**RIG), **{"crank_speed": 12.0, "torque": 1.0} | changes
        ),
        ({"efficiency": 1.2}, "efficiency must be at most 1"),
        ({"points": 3}, "points must be 8 at least"),
    ),
    "motor": (
        linkage.choose_motor,
        ((1e7,), "the largest rating"),
        ((1e3,), {"series": "PS"}, "series must be hp or kW"),
    ),
    "hole in a link": (
        lambda hole: linkage.hole_stress(
            1e3, width=0.02, thickness=0.01, hole=hole, concentration=2.5
        ),
        ((0.02,), "width must exceed hole"),
    ),
    "wear of the slider-crank": (
        wear_crank,
        ({"bodies": replace(BODIES, pin_radius=0.0)}, "pin_radius must be positive"),
        ({"cycles": 500_000, "extrapolation": 20_000}, "worn through"),
        ({"contact": ContactLaw(6.523e8), "steps_per_cycle": 3}, "impacts"),
        ({"bodies": SliderCrankBodies(0.0, 0.0, 0.0, pin_radius=9.5e-3)}, "carries no force"),
    ),
    "halvings": (
        lambda factor: bound_extrapolation(factor, wear=print),
        ((2,), "halvings must be 2 or more"),
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
    "coupled wear": (
        lambda cycles: wear.coupled_wear(
            CRANK,
            crank_speed=np.pi,
            bodies=BODIES,
            bushing_radius=9.5e-3,
            bushing_width=8e-3,
            specific_wear=5e-13,
            cycles=cycles,
            extrapolation=cycles,
        ),
        ((10**7,), "extrapolation must be smaller"),
    ),
    "asperities": (
        lambda slope: wear.abrasive_wear(
            1.0, sliding_distance=1.0, hardness=1e9, asperity_slope=slope
        ),
        ((2.0,), r"^asperity_slope must lie .* got 2 rad"),
    ),
    "radii": (
        lambda pin, bore: contact.conformal_radius(pin, bushing_radius=bore),
        ((0.0336, 0.0336), "bushing_radius must exceed pin_radius"),
    ),
    "Persson": (
        lambda name, *first, **rest: getattr(contact, f"persson_{name}")(*first, **rest),
        (("half_angle", -1.0), "must exceed -2/pi"),
        (
            ("load", 2.0),
            {"play": 1e-4, "youngs_modulus": 2e11},
            "half_angle must be below 84.8",
        ),
        (("load", 1.0), {"play": 0.0, "youngs_modulus": 2e11}, "^play must not be zero"),
        (
            ("contact", 1e5),
            {"play": -1e-4, "pin_diameter": 0.08, "youngs_modulus": 2e11},
            "^play must keep .* above -2/pi",
        ),
    ),
    "closed contact": (
        lambda interference: contact.closed_contact_pressure(
            1e6, interference=interference, pin_diameter=0.08, youngs_modulus=2e11
        ),
        ((1e-7,), "interference must be at least"),
    ),
    "Hertz": (
        lambda radius: contact.hertz_ellipse(
            1.0, radius=radius, radius_across=2.0, contact_modulus=1e11
        ),
        ((1.0,), "larger reduced radius"),
    ),
    "curved bodies": (
        lambda one, two: contact.relative_radii(
            one, radius_1_across=0.1, radius_2=two, radius_2_across=0.2
        ),
        ((0.1, [0.2, 0.0]), "^radius_2 must not be zero"),
        (([0.1, -0.1], 0.2), "gap all round"),
    ),
    "Winkler": (
        lambda load, shaft: contact.winkler_contact(
            load, shaft_radius=shaft, bushing_radius=0.01, thickness=1e-3, modulus=1e9
        ),
        ((1.0, 0.011), "bushing_radius must exceed shaft_radius"),
        ((1e9, 0.009), "wraps the contact to 90 degrees"),
    ),
    "confined layer": (
        lambda poisson: contact.winkler_modulus(1e9, poisson=poisson),
        ((0.5,), r"below 0\.5"),
    ),
    "film": (
        lambda stroke: film.line_contact_film(
            0.04,
            load_per_length=1e6,
            viscosity=0.12,
            pressure_viscosity=2e-8,
            radius=4.87,
            contact_modulus=1.1e11,
            stroke=stroke,
        ),
        (([0.007, 0.008],), "stroke must be one number"),
        ((-0.007,), "stroke must not be negative"),
    ),
    "film parameter": (
        lambda one, two: film.film_parameter(1e-6, roughness_a=one, roughness_b=two),
        ((0.0, 0.0), "roughness"),
    ),
    "sampled pressure": (
        lambda angle, pressure: friction.torque_ratio(angle, pressure=pressure),
        (([0.5, 0.0], [1.0, 1.0]), "^angle must rise"),
        (([2.0, 2.5], [1.0, 1.0]), "^pressure must carry a load .* got an integral of -0"),
        (([0.0, 0.5], [1.0, 1.0, 1.0]), "^angle and pressure must hold the same number"),
    ),
    "reversals": (
        lambda torque, direction: friction.average_reversals(
            torque, load=1.0, radius=1.0, direction=direction
        ),
        ((np.ones(5), np.ones(5)), "0 backward"),
        ((np.ones(4), [1, 1, -1]), "^torque and direction must be columns of one length"),
    ),
    "thin clearance": (friction.thin_winkler_load, (([0.5, np.pi / 2],), "below pi/2")),
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
    "motion of a crank": (
        lambda speed: r.crank_motion(CrankRocker(**RIG), crank_speed=speed, load=5.0),
        ((0.0,), "crank at rest"),
    ),
    "mount": (
        lambda sideways: as_mount(sideways).direction_for(TURNING),
        (("guided",), "needs a direction"),
        (("loose",), "'loose'"),
        ((-1.0,), "not be negative"),
    ),
    "rest of a mount": (r.Mount, ({"rest": NONE}, "rest of a mount must be finite")),
    "transient film": (
        solve_journal,
        ({"start": (2.4e-4, 0.0)}, "start lies outside the clearance"),
        ({"start": (NONE, 0.0)}, "two displacements"),
        ({"cells": (63, 4)}, "even number"),
        ({"frame": "crank"}, 'frame must be "half-angle" or "laboratory"'),
        ({"maps": [99]}, "steps from 0 to 4"),
        ({"motion": r.Motion([0.0, 1.0, 2.0], np.zeros(3), load=1e8)}, "No film"),
    ),
    "steady film": (
        lambda speed, load: r.steady_journal(PIN, speed=speed, load=load, cells=(64, 2)),
        ((0.0, 1.0), "speed must not be zero"),
        ((1.0, 1e9), "No film carries"),
    ),
    "full film": (
        FullFilm.of,
        ((replace(PIN, roughness=1e-6),), "roughness"),
    ),
    "orbit": (
        lambda start: follow_full_film(PIN, REST, start=np.array([[start, 0.0]])),
        ((231e-6,), "outside the clearance"),
    ),
    "film of given shape": (
        solve_film,
        ({"thickness": [1e-6, 1e-6, -1e-6, 1e-6]}, "positive and finite"),
        ({"thickness": 1e-6}, "array"),
        ({"thickness": np.full((4, 4), 1e-6)}, "needs a width"),
        ({"thickness": np.full(5, 1e-6), "closed": True}, "even number of cells"),
        ({"entrainment": 0.0}, "needs an entrainment"),
        ({"entrainment": [1.0, 2.0]}, "one for each of 1 "),
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
    "stress of a plane contact": (
        lambda pressure: e.subsurface_stress(xr.Dataset({"pressure": ("x", pressure)}), depth=1.0),
        (([1.0, 2.0],), r"over \(x, z\)"),
    ),
    "ends of a roller": (
        lambda axial: e.lundberg_profile(axial, load=1.0, length=0.02, contact_modulus=1e11),
        ((0.01,), "infinite"),
    ),
    "edge": (
        lambda ratio: e.edge_exponent(1.0, modulus_ratio=ratio),
        ((0.0,), "modulus_ratio"),
    ),
    "joint of finite length": (
        lambda **changes: replace(BUSHING, **changes),
        ({"bushing_radius": 0.03}, "pin_radius"),
        ({"pin_length": 0.05}, "pin_length"),
    ),
    "undercut": (undercut, ((0.02, 0.015, 0.01), "does not fit")),
    "cells of a joint": (
        lambda joint=BUSHING, **changes: e.prepare_joint(joint, **changes),
        ({"joint": replace(BUSHING, pin_length=0.06)}, "load_span"),
        ({"refine": [0.2]}, "refine"),
        ({"growth": 0.5}, "growth"),
    ),
}


@pytest.mark.filterwarnings("ignore::erlif.core.errors.UnitWarning")
@pytest.mark.parametrize("name", DOORS)
def test_what_has_no_meaning_is_refused_by_name(name):
    door, *rows = DOORS[name]
    for *given, words in rows:
        first = [value for part in given if isinstance(part, tuple) for value in part]
        named = next((part for part in given if isinstance(part, dict)), {})
        with pytest.raises(ModelError, match=words):
            door(*first, **named)
