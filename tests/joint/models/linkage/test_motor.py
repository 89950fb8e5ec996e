"""Power of the drive: energy over a turn, the thesis, standard ratings."""

import numpy as np
import numpy.testing as npt
from scenes.orbits import RIG, SPEED

from erlif.joint.models.linkage import choose_motor, drive_power

HP = 745.7  # W
TORQUE = 0.15 * 1e5 * 4.4482216152605 * 1.25 * 0.0254  # Farzaneh (2002), appendix A.3


def test_mean_power_is_the_friction_work_of_both_strokes():
    found = drive_power(RIG, crank_speed=SPEED, torque=TORQUE)
    # 24.4260 degrees each way in every turn
    work = 2 * TORQUE * np.radians(24.425985)
    npt.assert_allclose(found.mean_power, work * SPEED / (2 * np.pi), rtol=1e-6)
    npt.assert_allclose(found.mean_power, np.mean(found.crank_torque) * SPEED, rtol=2e-3)


def test_friction_changes_its_sign_with_the_rocker_and_never_drives():
    found = drive_power(RIG, crank_speed=SPEED, torque=TORQUE)
    assert set(np.unique(found.rocker_torque)) == {-TORQUE, TORQUE}
    assert (found.power >= -1e-9 * found.peak_power).all()


def test_inertia_takes_and_gives_the_same_energy():
    still = drive_power(RIG, crank_speed=SPEED, torque=0.0, inertia=2.0)
    npt.assert_allclose(still.mean_power, 0, atol=1e-6 * still.peak_power)
    # kinetic energy of the rocker at its greatest speed
    steps = np.diff(still.crank_angle) / SPEED
    gained = np.sum(np.maximum((still.power[1:] + still.power[:-1]) / 2, 0) * steps)
    npt.assert_allclose(gained, (2.552104**2 + 2.540492**2) * 2.0 / 2, rtol=1e-3)


def test_losses_raise_the_power_and_what_comes_back_is_less():
    found = drive_power(RIG, crank_speed=SPEED, torque=TORQUE, efficiency=0.8)
    npt.assert_allclose(found.peak_power, TORQUE * 2.552104 / 0.8, rtol=1e-5)
    still = drive_power(RIG, crank_speed=SPEED, torque=0.0, inertia=2.0, efficiency=0.8)
    assert still.mean_power > 0


def test_standard_ratings():
    npt.assert_allclose(choose_motor(5.5e3), 5.5e3)
    npt.assert_allclose(choose_motor(5.51e3), 7.5e3)
    npt.assert_allclose(choose_motor(7.1 * HP, series="hp"), 7.5 * HP)
