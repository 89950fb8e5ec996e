"""Pressures over the arc: the table of the appendix, equilibrium, play and interference."""

import math

import numpy as np
import pytest
from scenes.joints import altered, assessed
from scipy.integrate import trapezoid

from erlif.joint.sizing import JointState

ELASTIC = {"youngs_modulus": 206e9, "poissons_ratio": 0.3}
ONE_MATERIAL = altered(pin=ELASTIC, bushing=ELASTIC, interference=0.0)  # plane stress


@pytest.mark.parametrize("play", [300e-6, 20e-6, 0.0, -6e-6, -40e-6])
def test_the_pressure_over_the_arc_carries_the_load(play):
    """Pressed all around, from about -6 um on, too."""
    state = JointState(altered(ONE_MATERIAL, play=play))
    angle = np.linspace(-math.pi, math.pi, 40_001)
    pressure = state.pressure_over_arc(angle)
    load = trapezoid(pressure * np.cos(angle), angle) * 0.08 / 2 * 0.1
    assert load == pytest.approx(100e3, rel=1e-4)
    assert pressure.max() == pytest.approx(state.contact.peak, rel=1e-6)
    assert pressure.min() >= 0


def test_validity_of_the_simple_pressures():
    """Hertz below 20 degrees, the cosine from 72.9 degrees, eq. 5 up to 0.02 m/s."""
    loose, tight = assessed(ONE_MATERIAL, play=3e-3), assessed(ONE_MATERIAL, play=0.0)
    assert loose.step("pressure_hertz").valid
    assert not loose.step("pressure_cosine").valid
    assert tight.step("pressure_hertz").missing == "a play above 0"
    assert tight.step("pressure_cosine").valid
    # the cosine is then above the peak of eq. 9
    assert tight.step("pressure_cosine").present > tight.step("pressure_peak").present

    slow, fast, still = (assessed(period=period).step("seizure") for period in (6.0, 3.0, None))
    assert [step.valid for step in (slow, fast, still)] == [True, False, False]
    assert "0.0279 m/s" in fast.validity


def test_moduli_that_are_not_known_or_unlike_are_reported():
    unknown = assessed(ONE_MATERIAL, bushing={"poissons_ratio": None})
    assert unknown.step("pressure_hertz").missing == "poissons_ratio of [pin] and [bushing]"
    assert unknown.step("pressure_peak").state == "holds"  # plane stress needs none
    assert assessed().step("pressure_peak").valid  # steel and bronze
    assert not assessed(bushing={"youngs_modulus": 2.8e9}).step("pressure_peak").valid
