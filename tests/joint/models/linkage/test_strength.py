"""Stresses of the links: published tables, other fits, and the numbers of the thesis."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError, RangeWarning
from erlif.joint.models.linkage import (
    beam_bending_stress,
    fatigue_safety,
    hole_stress,
    open_hole_concentration,
    pin_hole_concentration,
    thread_stress_area,
)
from erlif.joint.models.reaction import rod_stress

FORCE = 8.2e3  # N, Farzaneh (2002), appendix A.3


def test_open_hole_is_that_of_howland():
    """Howland (1930): gross 3.03, 3.14, 3.36, 3.74, 4.32 for d/w of 0.1 to 0.5."""
    ratio = np.arange(1, 6) / 10
    gross = np.array([3.03, 3.14, 3.36, 3.74, 4.32])
    npt.assert_allclose(open_hole_concentration(ratio), gross * (1 - ratio), rtol=5e-3)
    npt.assert_allclose(open_hole_concentration([1e-9, 1 - 1e-9]), [3, 2], rtol=2e-3)


def test_pin_in_a_hole_agrees_with_the_fit_of_the_bearing_stress():
    """Pilkey (2005) has a second cubic, of the peak over F / (d t), fitted to the same test.

    A cubic follows neither curve better than to a few per cent.
    """
    ratio = np.linspace(0.15, 0.75, 13)
    bearing = 0.288 + 8.820 * ratio - 23.196 * ratio**2 + 29.167 * ratio**3
    npt.assert_allclose(pin_hole_concentration(ratio), bearing * (1 - ratio) / ratio, rtol=0.04)


def test_a_hole_outside_the_fit_warns_and_one_as_wide_as_the_link_is_refused():
    with pytest.warns(RangeWarning, match=r"hole_ratio = 0\.15 to 0\.75"):
        pin_hole_concentration(0.05)
    for function in (pin_hole_concentration, open_hole_concentration):
        with pytest.raises(ModelError):
            function(1.0)


def test_bending_of_a_beam():
    """Moment over section modulus, 8.2 kN on 0.2 m, 20 mm x 60 mm: 1640 N m over 12 cm3."""
    stress = beam_bending_stress(FORCE, arm=0.2, thickness=0.02, depth=0.06)
    npt.assert_allclose(stress, 1640 / 12e-6)


def test_stress_area_of_metric_threads():  # ISO 898-1, table of stress areas, mm2
    diameter = np.array([6, 8, 10, 12, 16, 20]) * 1e-3
    pitch = np.array([1, 1.25, 1.5, 1.75, 2, 2.5]) * 1e-3
    table = [20.1, 36.6, 58.0, 84.3, 157, 245]
    npt.assert_allclose(thread_stress_area(diameter, pitch=pitch) * 1e6, table, rtol=3e-3)


def test_goodman_line():
    npt.assert_allclose(fatigue_safety(25e6, fatigue_strength=50e6), 2)
    safety = fatigue_safety(25e6, fatigue_strength=50e6, mean=200e6, tensile_strength=400e6)
    npt.assert_allclose(safety, 1)
    assert fatigue_safety(0.0, fatigue_strength=50e6) == np.inf
    with pytest.raises(ModelError, match="tensile_strength must be finite"):
        fatigue_safety(25e6, fatigue_strength=50e6, mean=1e6)


def test_factors_of_safety_of_the_thesis():
    """Printed: 60 MPa at a hole, and 3.1 at 16 of 50 MPa in the rod."""
    stress = hole_stress(FORCE, width=0.045, thickness=0.02, hole=27.917e-3, concentration=2.5)
    npt.assert_allclose(stress, 60e6, rtol=1e-4)

    # the rod: the diameter in the place of the radius is printed
    half_inch = 0.0127
    printed = FORCE / (np.pi * half_inch**2)
    npt.assert_allclose(fatigue_safety(printed, fatigue_strength=50e6), 3.1, atol=0.05)
    npt.assert_allclose(rod_stress(FORCE, diameter=half_inch), 4 * printed)
    # 1/2-13 UNC has 0.1419 square inches in tables
    area = thread_stress_area(half_inch, pitch=0.0254 / 13)
    npt.assert_allclose(area, 0.1419 * 0.0254**2, rtol=0.015)
