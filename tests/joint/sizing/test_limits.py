"""The limits of a joint of single numbers: the worked case, unsound joints, the old names."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scipy.optimize import brentq

import erlif.models.bearing
from erlif.core.errors import ModelError, UnitWarning
from erlif.joint.sizing import limits
from erlif.joint.sizing.limits import JointDesign, design_report

JOINT = JointDesign(
    load=1e5,
    pin_diameter=0.08,
    bushing_width=0.1,
    seat_width=0.04,
    play=0.16e-3,
    housing_bore=0.09,
    housing_diameter=0.2,
    pin_yield=600e6,
    bushing_yield=300e6,
    housing_yield=350e6,
    bushing_hardness=1.2e9,
    seat_hardness=1.2e9,
    youngs_modulus=206e9,
    safety=2.0,
    lateral_play=0.02,
)


def test_report_walks_through_every_limit():
    report = design_report(JOINT)
    used = {check.equation: check.utilisation for check in report.checks}
    npt.assert_allclose(used["eq. 1"], 19.17166 / 80, rtol=1e-6)
    npt.assert_allclose(used["eq. 2"], 37.06722 / 80, rtol=1e-6)
    npt.assert_allclose(used["eq. 10"], 5.305165 / 100, rtol=1e-6)
    npt.assert_allclose(used["eq. 12"], 2.652582 / 40, rtol=1e-6)
    npt.assert_allclose(used["eq. 5"], 2e5 / 300e6 / 8e-3, rtol=1e-6)
    npt.assert_allclose(used["eq. 23"], 2.0 / 5.0)
    assert [check.utilisation for check in report.checks] == sorted(used.values(), reverse=True)
    assert report.sound
    assert report.governing.equation == "eq. 14"
    assert "housing eye governs (eq. 14)" in report.as_text()


def test_hole_and_thin_pin_change_what_governs():
    report = design_report(replace(JOINT, pin_diameter=0.045, hole_diameter=0.006, play=0.09e-3))
    assert report.governing.name == "pin in bending at its hole"
    assert not report.sound
    assert "exceeds a limit" in report.as_text()

    def excess(d):  # eq. 4 for a hole that keeps its 6 mm
        x = 6e-3 / d
        concentration = 3 - 11.3 * x + 51.6 * x**2 - 114.6 * x**3 + 76.4 * x**4
        stress = 4 * 1e5 * 0.12 * concentration / (np.pi * d**3 * (1 - 16 * x / (3 * np.pi)))
        return stress - 300e6

    npt.assert_allclose(report.governing.utilisation, brentq(excess, 0.03, 0.1) / 0.045)
    assert "Outside the recommended range" in report.as_text()  # width over diameter 2.2


def test_pv_and_heat_are_reported_when_the_motion_is_known():
    moving = replace(
        JOINT, half_swing=0.2132, period=0.526, friction=0.15, lock_lever=0.06, pv_limit=0.5e6
    )
    report = design_report(moving)
    speed = 2 * 0.08 * 0.2132 / 0.526
    npt.assert_allclose(report.governing.utilisation, 12.5e6 * speed / 0.5e6)
    assert report.governing.name == "pv"
    # 0.15 x 100 kN x 64.85 mm/s
    assert any("friction heat 973 W" in figure for figure in report.figures)
    assert any("lock force at worst 66.7 kN" in figure for figure in report.figures)


def test_no_play_interference_and_overload_are_reported():
    """Unsound joints have a report, too."""
    for play in (0.0, -20e-6, -500e-6):
        report = design_report(replace(JOINT, play=play))
        angle = {0.0: "170 degrees", -500e-6: "360 degrees"}.get(play, "degrees")
        assert any(angle in check.statement for check in report.checks)
    text = design_report(replace(JOINT, load=20e6, youngs_modulus=1e9)).as_text()
    assert "exceeds a limit" in text
    assert "diameter of no size enough" in text
    assert "the pin folds under its load" in text


@pytest.mark.parametrize(
    ("slip", "message"),
    [
        ({"load": 1e10}, "load = 1e.10 N"),
        ({"housing_diameter": 200.0}, "housing_diameter = 200 m"),
        ({"pin_yield": 600.0}, "pin_yield = 600 Pa"),
        ({"youngs_modulus": 206.0}, "youngs_modulus = 206 Pa"),
        ({"half_swing": 12.2}, "half_swing = 12.2 rad .* degrees"),
    ],
)
def test_slip_of_units_in_a_joint_warns_with_its_field(slip, message):
    with pytest.warns(UnitWarning, match=message):
        replace(JOINT, **slip)


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: replace(JOINT, play=np.inf), "play must be finite"),
        (lambda: replace(JOINT, lateral_play=-1e-4), "lateral_play must not be negative"),
        (lambda: replace(JOINT, hole_diameter=0.017), "^hole_diameter must be at most 0.2 pin"),
        (lambda: replace(JOINT, load=np.inf), "^load must be finite"),
        (
            lambda: replace(JOINT, play=np.nan),
            "^play must be a number, got nan; give it in SI units",
        ),
        (lambda: replace(JOINT, play="0.16 mm"), "^play must be a number, got '0.16 mm'"),
        (lambda: replace(JOINT, hole_diameter=np.zeros(2)), "^hole_diameter must be one number"),
        (lambda: replace(JOINT, housing_bore=0.07), "^housing_bore must exceed pin_diameter"),
    ],
)
def test_bad_values_are_named(call, named):
    with pytest.raises(ModelError, match=named):
        call()


@pytest.mark.parametrize("name", ["DesignCheck", "DesignReport", "JointDesign", "design_report"])
def test_old_names_warn_and_are_the_same(name):
    with pytest.warns(DeprecationWarning, match=f"is now erlif.sizing.limits.{name}"):
        old = getattr(erlif.models.bearing, name)
    assert old is getattr(limits, name)
