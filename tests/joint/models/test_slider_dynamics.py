"""Forward dynamics of the slider-crank: balances, inverse dynamics, closed forms of impacts."""

import csv
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
from scenes.slider_crank import CRANK_INERTIA, MASSES, linkage
from scipy.optimize import brentq

from erlif.core.errors import RangeWarning
from erlif.joint.models.reaction import SliderCrankBodies
from erlif.joint.models.slider_dynamics import ContactLaw, simulate_slider_crank

PULL = 20.0
MASS = 0.8175 + 5.5487
GAP = 0.05  # far above the penetration, so that the pull does little while the pin touches
DROPPED = {
    "bodies": SliderCrankBodies(**MASSES, spring_preload=PULL),
    "crank_speed": 0.0,
    "eccentricity": (0.0, 0.0),
}
"""Rod in line with the slider and the crank held: rod and slider fall by the gap under a pull."""


def test_elastic_bounce_has_the_closed_form_of_hertz():
    fall = np.sqrt(2 * GAP * MASS / PULL)
    law = ContactLaw(1e8, restitution=1.0)
    found = simulate_slider_crank(
        linkage(GAP), **DROPPED, contact=law, duration=fall + 1e-2, samples=4001
    )
    falling = found.time < fall
    npt.assert_allclose(
        -found.eccentricity_x[falling], (PULL / MASS * found.time**2 / 2)[falling], atol=1e-12
    )

    # the work of the pull and the motion are in the spring 2 K d^2.5 / 5 where the rod turns back
    deepest = brentq(lambda d: PULL * (GAP + d) - 0.4 * 1e8 * d**2.5, 1e-6, 1e-2, xtol=1e-15)
    # the deepest sample is half a step from the turn at most, where d'' = -K d^1.5 / m
    step = float(found.time[1])
    missed = 1e8 * deepest**1.5 / MASS * (step / 2) ** 2 / 2
    assert deepest - missed < found.penetration.max() <= deepest * (1 + 1e-9)

    # Hertz: the contact lasts 2.9432 d/v less the share of the pull in the force, within two steps
    speed = np.sqrt(2 * PULL * GAP / MASS)
    touching = found.time[found.penetration > 0]
    lasts = 2.9432 * deepest / speed
    shorter = PULL / (1e8 * deepest**1.5) * lasts
    assert abs(touching[-1] - touching[0] - lasts) < 2 * step + shorter


@pytest.mark.parametrize("restitution", [0.5, 0.8, 0.95])
def test_rebound_has_the_closed_form_of_the_law(restitution):
    """One integral of m v dv/dd = -K d^1.5 (1 + a v): a v - ln(1 + a v) is equal at both ends."""
    fall = np.sqrt(2 * GAP * MASS / PULL)
    law = ContactLaw(1e12, restitution=restitution, slowest_impact=1e-6)
    found = simulate_slider_crank(
        linkage(GAP), **DROPPED, contact=law, duration=1.5 * fall, samples=31
    )
    assert found.touches == 1
    touch = np.sqrt(2 * PULL * GAP / MASS)
    a = 0.75 * (1 - restitution**2) / touch
    start = a * touch - np.log1p(a * touch)
    rebound = brentq(lambda v: -a * v - np.log1p(-a * v) - start, 0.1 * touch, touch)
    # beside the impact the pull works over the penetration, a share of it over the gap
    share = (PULL * GAP / 0.4e12) ** 0.4 / GAP
    loss = MASS * (touch**2 - rebound**2) / 2
    npt.assert_allclose(found.impact_loss[-1], loss, rtol=2 * share)

    # the law is meant for restitutions near 1; Lankarani and Nikravesh (1994)
    npt.assert_allclose(rebound / touch, restitution, atol=0.5 * (1 - restitution))


DRIVEN = {
    "bodies": SliderCrankBodies(**MASSES, spring_stiffness=525.4, spring_preload=20.0),
    "crank_speed": 20.0,
    "crank_angle": 0.3,
    "torque": lambda time, _angle: 2 * np.cos(30 * time),
    "crank_inertia": CRANK_INERTIA,
    "eccentricity": (-1e-4, 0.0),
}
REFERENCE = Path(__file__).parents[2] / "reference" / "slider_crank_exudyn.csv"


@pytest.mark.parametrize(
    ("joint", "clearance", "contact", "bounds"),
    [
        ("perfect", 0.0, None, (2e-9, 2e-8, 2e-10, 2e-3)),
        ("general", 2e-4, ContactLaw(1e7, restitution=1.0), (2e-7, 2e-4, 1e-8, 3e-3)),
    ],
)
def test_motion_under_a_torque_is_that_of_exudyn(joint, clearance, contact, bounds):
    """Flight and elastic contact; bounds in rad, rad/s, m and N.

    benchmarks/slider_crank_exudyn.py wrote the reference; halving its step changes it by as much.
    """
    with REFERENCE.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["joint"] == joint]
    found = simulate_slider_crank(
        linkage(clearance), **DRIVEN, duration=0.12, contact=contact, samples=25
    )
    assert found.touches >= 5 or joint == "perfect"
    for name, bound in zip(
        ("crank_angle", "crank_speed", "slider_position", "force"), bounds, strict=True
    ):
        npt.assert_allclose(found[name], [float(row[name]) for row in rows], atol=bound)


def test_flights_shorter_than_a_step_are_followed():
    """Stiff contact on a light crank: touches follow each other within a millisecond."""
    law = ContactLaw(1e8, restitution=1.0)
    found = simulate_slider_crank(linkage(2e-4), **DRIVEN, duration=0.04, contact=law, samples=201)
    assert found.touches >= 8
    assert found.penetration.max() < 3e-4


def test_tension_of_the_simplified_joint_is_checked():
    fast = SliderCrankBodies(**MASSES, spring_stiffness=525.4)
    case = {"bodies": fast, "crank_speed": 25.0}
    with pytest.warns(RangeWarning, match="compression at crank angles of 77 to 283 degrees"):
        simulate_slider_crank(linkage(1e-4), **case, duration=2 * np.pi / 25)
