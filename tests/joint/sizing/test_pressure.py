"""Pressures over the arc: the table of the appendix, equilibrium, play and interference."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from erlif.joint.sizing import JointState, example_joint, walk_guide


def joint_with(play, *, force=100e3, modulus=206e9):
    """A joint of one material without press fit, in plane stress."""
    joint = example_joint()
    alike = replace(joint.pin, youngs_modulus=modulus, poissons_ratio=0.3)
    ring = replace(joint.bushing, youngs_modulus=modulus, poissons_ratio=0.3)
    return replace(joint, pin=alike, bushing=ring, interference=0.0, play=play, force=force)


@pytest.mark.parametrize(
    ("angle", "group", "peak"),
    [(22.62, 14.98, 1.645), (53.13, 1.683, 0.7749), (90, -0.1103, 0.5904)],
)
def test_the_table_of_the_appendix(angle, group, peak):
    """Strand (2005), appendix: half contact angle, E Delta / 2q and d p / 2q."""
    q = 100e3 / 0.1
    contact = JointState(joint_with(group * 2 * q / 206e9)).contact
    assert math.degrees(contact.half_angle) == pytest.approx(angle, abs=0.02)
    assert contact.peak * 0.08 / (2 * q) == pytest.approx(peak, rel=4e-4)


@pytest.mark.parametrize("play", [300e-6, 20e-6, 0.0, -6e-6, -40e-6])
def test_the_pressure_over_the_arc_carries_the_load(play):
    """Pressed all around, from about -6 um on, too."""
    joint = joint_with(play)
    angle = np.linspace(-math.pi, math.pi, 40_001)
    pressure = JointState(joint).pressure_over_arc(angle)
    load = trapezoid(pressure * np.cos(angle), angle) * 0.08 / 2 * 0.1
    assert load == pytest.approx(100e3, rel=1e-4)
    assert pressure.max() == pytest.approx(JointState(joint).contact.peak, rel=1e-6)
    assert pressure.min() >= 0


def test_the_peak_has_no_jump_where_the_contact_closes():
    closing = -4 * (100e3 / 0.1) / (math.pi * 206e9)
    states = (JointState(joint_with(closing * (1 + e))) for e in (-1e-6, 1e-6))
    before, after = (state.contact.peak for state in states)
    assert before == pytest.approx(after, rel=1e-5)


def test_validity_of_the_simple_pressures():
    """Hertz below 20 degrees, the cosine from 72.9 degrees, eq. 5 up to 0.02 m/s."""
    loose, tight = walk_guide(joint_with(3e-3)), walk_guide(joint_with(0.0))
    assert loose.step("pressure_hertz").valid
    assert not loose.step("pressure_cosine").valid
    assert tight.step("pressure_hertz").missing == "a play above 0"
    assert tight.step("pressure_cosine").valid
    # the cosine is then above the peak of eq. 9
    assert tight.step("pressure_cosine").present > tight.step("pressure_peak").present

    slow, fast = (replace(joint_with(1e-4), period=period) for period in (6.0, 3.0))
    assert walk_guide(slow).step("seizure").valid
    assert not walk_guide(fast).step("seizure").valid
    assert "0.0279 m/s" in walk_guide(fast).step("seizure").validity
    assert not walk_guide(replace(slow, period=None)).step("seizure").valid


def test_hertz_needs_the_ratios_of_poisson():
    joint = joint_with(1e-4)
    found = walk_guide(replace(joint, bushing=replace(joint.bushing, poissons_ratio=None)))
    assert found.step("pressure_hertz").missing == "poissons_ratio of [pin] and [bushing]"
    assert found.step("pressure_peak").state == "holds"  # plane stress needs none


def test_unlike_moduli_are_marked():
    joint = example_joint()
    polymer = replace(joint.bushing, youngs_modulus=2.8e9)
    assert walk_guide(joint).step("pressure_peak").valid  # steel and bronze
    assert not walk_guide(replace(joint, bushing=polymer)).step("pressure_peak").valid


def test_the_pin_is_100_brinell_harder():
    joint = example_joint()
    soft = replace(joint.pin, hardness_low=300.0)
    found = walk_guide(replace(joint, pin=soft)).step("hardness_difference")
    assert (found.present, found.state) == (70.0, "outside")
