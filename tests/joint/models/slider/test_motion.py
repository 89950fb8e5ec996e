"""Equations of motion of the slider-crank: balances of energy and inverse dynamics."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.slider_crank import BODIES, CRANK_INERTIA, PTFE, RUBBED, linkage, slowed
from scipy.interpolate import CubicSpline

from erlif.joint.models.reaction import SliderCrankBodies, joint_reaction
from erlif.joint.models.slider_dynamics import ContactLaw, simulate_slider_crank

ANGLE = (np.arange(72) - 36) * 2 * np.pi / 72
PROFILES = xr.Dataset(
    {
        "depth": ("angle", np.maximum(2e-4 * np.cos(ANGLE - 0.2) - 1e-5, 0.0)),
        "pin_depth": ("angle", 2e-5 * (1 + np.cos(2 * ANGLE))),
    },
    {"angle": ANGLE},
)
WORN = {"contact": PTFE, "worn": PROFILES}


def wall_energy(found, worn):
    """Springs all round the bushing, of the eccentricity and both profiles."""
    x, y = found.eccentricity_x, found.eccentricity_y
    along = -(x * np.cos(found.rod_angle) + y * np.sin(found.rod_angle))
    across = x * np.sin(found.rod_angle) - y * np.cos(found.rod_angle)
    seen = worn.angle - found.crank_angle + found.rod_angle
    pin = CubicSpline(*around(worn.angle.values, worn.pin_depth.values), bc_type="periodic")
    depth = along * np.cos(worn.angle) + across * np.sin(worn.angle) - 1e-4 - worn.depth
    depth = depth - xr.apply_ufunc(pin, seen)
    per_angle = 3 / (4 * np.sqrt(2)) * 6.523e8 * np.sqrt(1e-4)
    return per_angle / 2 * (depth.clip(min=0) ** 2).sum("angle") * 2 * np.pi / worn.sizes["angle"]


def around(angle, depth):
    return np.append(angle, angle[0] + 2 * np.pi), np.append(depth, depth[0])


def stored_energy(found, worn=None):
    """Kinetic and elastic energy from the motion alone."""
    rod_x = found.slider_speed + 0.1016 * np.sin(found.rod_angle) * found.rod_speed
    rod_y = -0.1016 * np.cos(found.rod_angle) * found.rod_speed
    stretch = 0.0762 + 0.2032 - found.slider_position
    kinetic = (
        CRANK_INERTIA * found.crank_speed**2
        + 0.8175 * (rod_x**2 + rod_y**2)
        + 5500e-6 * found.rod_speed**2
        + 5.5487 * found.slider_speed**2
    ) / 2
    if worn is None:
        elastic = 0.4 * 6.523e8 * found.penetration.clip(min=0) ** 2.5
    else:
        elastic = wall_energy(found, worn)
    return kinetic + 68.354 * stretch + 525.4 * stretch**2 / 2 + elastic


@pytest.mark.parametrize(
    "joint", [{}, {"contact": PTFE}, WORN], ids=["simplified", "general", "worn"]
)
@pytest.mark.parametrize("torque", [None, slowed], ids=["speed", "torque"])
@pytest.mark.filterwarnings("ignore::erlif.core.errors.RangeWarning")
def test_drive_supplies_what_motion_spring_and_losses_take(joint, torque):
    """A hundred steps of a relative error of 1e-9."""
    found = simulate_slider_crank(
        linkage(1e-4),
        bodies=RUBBED,
        crank_speed=25.0,
        crank_angle=1.0 if "worn" in joint else 0.0,
        duration=0.02 if "worn" in joint else 0.1,
        torque=torque,
        crank_inertia=CRANK_INERTIA,
        tolerance=1e-9,
        samples=61,
        **joint,
    )
    energy = stored_energy(found, joint.get("worn"))
    losses = found.friction_loss + found.impact_loss
    scale = float(energy.max() - energy.min())
    npt.assert_allclose(energy - energy[0] + losses, found.drive_work, atol=1e-7 * scale)
    assert np.all(np.diff(found.friction_loss) >= 0)
    assert np.all(np.diff(found.impact_loss) >= 0)
    assert found.friction_loss[-1] > 0.01 * scale
    assert found.penetration.max() < 1e-4
    npt.assert_allclose(found.friction_loss, 0.15 * found.rubbing, rtol=1e-9)  # always slides


def test_work_of_the_drive_is_the_integral_of_its_torque():
    found = simulate_slider_crank(linkage(), bodies=RUBBED, crank_speed=np.pi, duration=2.0)
    turn = found.crank_torque[:-1]  # the last sample is the first one again
    npt.assert_allclose(found.drive_work[-1], 2 * np.pi * turn.mean(), rtol=1e-9)
    npt.assert_allclose(found.friction_loss[-1], found.drive_work[-1], rtol=1e-9)


@pytest.mark.parametrize("clearance", [0.0, 1e-3])
def test_simplified_joint_is_that_of_inverse_dynamics(clearance):
    found = simulate_slider_crank(
        linkage(clearance), bodies=RUBBED, crank_speed=np.pi, duration=2.0, samples=73
    )
    inverse = joint_reaction(
        linkage(clearance), crank_angle=found.crank_angle.values, crank_speed=np.pi, bodies=RUBBED
    )
    for name in ("force_x", "force_y", "force", "normal", "crank_torque"):
        npt.assert_allclose(found[name], getattr(inverse, name), atol=1e-9)


def test_general_joint_becomes_the_perfect_one_as_it_stiffens():
    """Without clearance the joint differs by its penetration, (F/K)^(2/3)."""
    case = {"bodies": SliderCrankBodies(**BODIES), "crank_speed": 12.0, "duration": 0.05}
    perfect = simulate_slider_crank(linkage(), **case, samples=21)
    error, sunk = [], []
    for stiffness in (1e9, 1e11):
        law = ContactLaw(stiffness, restitution=0.5)
        found = simulate_slider_crank(linkage(), **case, contact=law, samples=21)
        error.append(float(abs(found.force - perfect.force).max() / perfect.force.max()))
        depth = (found.force / stiffness) ** (2 / 3)
        sunk.append(float(depth.max() / 0.0762))

        # the damping takes its share of the force, of which the depth has two thirds
        rate = float(abs(found.penetration.differentiate("time")).max())
        share = 2 / 3 * 0.75 * (1 - 0.5**2) * rate / law.slowest_impact
        eccentricity = np.hypot(found.eccentricity_x, found.eccentricity_y)
        npt.assert_allclose(eccentricity, depth, rtol=1.2 * share)  # differences of samples

    # links that are shorter or longer by the penetration change the force in its share
    assert error[0] < sunk[0]
    npt.assert_allclose(error[0] / error[1], sunk[0] / sunk[1], rtol=0.05)
