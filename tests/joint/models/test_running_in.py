"""Running-in of a bushing against closed forms and balances."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.integrate import quad

from erlif.joint.models.friction import STEADY_WEAR_TORQUE_RATIO, truncated_cosine_torque_ratio
from erlif.joint.models.running_in import run_in_bushing, thin_wall_torque_ratio
from erlif.models.contact import winkler_contact

PTFE = {
    "shaft_radius": 5e-3,
    "bushing_radius": 5.175e-3,
    "width": 10e-3,
    "thickness": 3e-3,
    "modulus": 1e9,
    "specific_wear": 5e-13,
}


@pytest.mark.parametrize("load", [30.0, 400.0])
def test_the_unworn_wall_is_that_of_the_source(load):
    found = run_in_bushing(load, sliding_distance=0.0, **PTFE)
    wall = {name: PTFE[name] for name in ("shaft_radius", "bushing_radius", "thickness", "modulus")}
    exact = winkler_contact(load / PTFE["width"], **wall)
    npt.assert_allclose(found.torque_ratio[0], exact.torque_ratio, rtol=2e-5)
    npt.assert_allclose(found.peak_pressure[0], exact.pressure, rtol=1e-3)
    npt.assert_allclose(found.half_angle[0], exact.half_angle, rtol=2e-3)


def test_worn_volume_is_that_of_archard():
    """dV/ds = k mu* F: the wall wears by the pressure of the whole arc."""
    distance = np.linspace(0, 70, 141)
    found = run_in_bushing(100.0, sliding_distance=distance, **PTFE)
    worn = 5e-13 * 100.0 * np.trapezoid(found.torque_ratio, distance)
    npt.assert_allclose(found.worn_volume[-1], worn, rtol=1e-4)


def test_a_stiff_wall_wears_as_the_circle_that_sinks():
    """The rigid limit in closed form, for a clearance that is thin against the radius.

    The shaft touches where e cos a = c, and sinks at k p0 with p = p0 cos theta, so that
    F = p0 w R (a + sin a cos a) and ds = w R (a + sin a cos a) de / (k F).
    """
    clearance, load = 2e-7, 400.0
    stiff = {**PTFE, "bushing_radius": 5e-3 + clearance, "modulus": 5e12, "thickness": 1e-5}

    def path(half_angle):
        to = clearance / np.cos(half_angle)
        arc = lambda e: (a := np.arccos(clearance / e)) + np.sin(a) * np.cos(a)  # noqa: E731
        return PTFE["width"] * 5e-3 / (5e-13 * load) * quad(arc, clearance, to)[0]

    angles = np.array([0.6, 0.9, 1.2, 1.4])
    found = run_in_bushing(load, sliding_distance=[path(a) for a in angles], cells=640, **stiff)
    npt.assert_allclose(found.torque_ratio, truncated_cosine_torque_ratio(angles), rtol=5e-4)
    npt.assert_allclose(found.half_angle, angles, rtol=5e-3)


@pytest.mark.parametrize("clearance", [20e-6, -20e-6])
def test_clearance_and_interference_end_at_four_over_pi(clearance):
    """Colbert et al. (2009), figure 8: from below and from above."""
    case = {**PTFE, "bushing_radius": 5e-3 + clearance}
    ratio = run_in_bushing(100.0, sliding_distance=[0.0, 20.0, 200.0], **case).torque_ratio.values
    assert (ratio[0] < STEADY_WEAR_TORQUE_RATIO) == (clearance > 0)
    assert abs(ratio[1] / STEADY_WEAR_TORQUE_RATIO - 1) < abs(
        ratio[0] / STEADY_WEAR_TORQUE_RATIO - 1
    )
    npt.assert_allclose(ratio[2], STEADY_WEAR_TORQUE_RATIO, rtol=0.01)


@pytest.mark.parametrize("group", [-1.0, -0.32, -0.1, 0.0, 0.3, 30.0])
def test_thin_wall_is_the_integral_of_its_pressure(group):
    """c E' R/(q t) = group; e from the balance of e cos t - c by bisection."""
    low, high = 0.0, 1e3
    arc = np.linspace(0, np.pi, 20_001)

    def pressed(e):
        return np.maximum(e * np.cos(arc) - group, 0)

    for _ in range(50):
        e = (low + high) / 2
        carried = 2 * np.trapezoid(pressed(e) * np.cos(arc), arc)
        low, high = (e, high) if carried < 1 else (low, e)
    true = np.trapezoid(pressed(e), arc) / np.trapezoid(pressed(e) * np.cos(arc), arc)
    case = {"shaft_radius": 0.01, "thickness": 1e-3, "modulus": 1e9}
    q = 1e5
    clearance = group * q * 1e-3 / (1e9 * 0.01)
    npt.assert_allclose(thin_wall_torque_ratio(q, clearance=clearance, **case), true, rtol=1e-6)
