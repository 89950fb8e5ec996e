"""Torque ratios against their integrals, friction from reversing torque."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from scipy.constants import inch, lbf
from scipy.integrate import quad

from erlif.core.errors import ModelError
from erlif.joint.models.friction import (
    STEADY_WEAR_TORQUE_RATIO,
    average_reversals,
    cosine_torque_ratio,
    elliptic_torque_ratio,
    friction_coefficient,
    friction_torque,
    thin_winkler_load,
    thin_winkler_torque_ratio,
    torque_ratio,
    truncated_cosine_torque_ratio,
    uniform_torque_ratio,
)
from erlif.models.contact import persson_pressure, winkler_contact

DISTRIBUTIONS = {
    uniform_torque_ratio: lambda t, a: 1.0,
    cosine_torque_ratio: lambda t, a: np.cos(np.pi * t / (2 * a)),
    elliptic_torque_ratio: lambda t, a: np.sqrt(max(1 - (t / a) ** 2, 0.0)),
    truncated_cosine_torque_ratio: lambda t, a: np.cos(t),
    thin_winkler_torque_ratio: lambda t, a: np.cos(t) - np.cos(a),
}


@pytest.mark.parametrize("ratio", DISTRIBUTIONS, ids=lambda ratio: ratio.__name__)
@pytest.mark.parametrize("half_angle", [0.02, 0.3, 1.0, 1.5, np.pi / 2])
def test_closed_forms_are_the_integrals_of_eq_4(ratio, half_angle):  # Colbert et al. (2009), eq. 4
    pressure = DISTRIBUTIONS[ratio]
    rubbed = quad(pressure, 0, half_angle, args=(half_angle,), epsrel=1e-11)[0]
    carried = quad(lambda t: pressure(t, half_angle) * np.cos(t), 0, half_angle, epsrel=1e-11)[0]
    npt.assert_allclose(ratio(half_angle), rubbed / carried, rtol=1e-7)


@pytest.mark.parametrize("ratio", DISTRIBUTIONS, ids=lambda ratio: ratio.__name__)
def test_torque_ratio_is_one_for_a_line_and_grows_with_the_arc(ratio):
    half_angle = np.linspace(0, np.pi / 2, 400)
    found = ratio(half_angle)
    npt.assert_allclose(found[0], 1, atol=1e-12)
    assert np.all(np.diff(found) > 0)
    with pytest.raises(ModelError, match="half_angle must lie in 0 to 1"):
        ratio(2.0)


def test_values_of_a6():  # Colbert et al. (2009), eq. A6
    npt.assert_allclose(cosine_torque_ratio(np.radians(86.61)), 1.25, atol=5e-5)
    npt.assert_allclose(cosine_torque_ratio(np.radians(60)), 10 / 9)
    npt.assert_allclose(truncated_cosine_torque_ratio(np.radians(60)), 1.170138, atol=5e-7)


def test_worn_ptfe_bushing():
    """Colbert et al. (2009), section 5.2: 0.105 on a flat, 0.131 +- 0.004 in the bushing."""
    torque = friction_torque(0.105, load=400.0, radius=0.005, torque_ratio=STEADY_WEAR_TORQUE_RATIO)
    apparent = friction_coefficient(torque, load=400.0, radius=0.005)
    npt.assert_allclose(apparent, 0.13369, atol=5e-6)


def test_contours_of_fig_b1_for_a_thin_clearance():
    """Colbert et al. (2009), Fig. B1: mu*, half angle in degrees and F* t* Rs/c."""
    ratio, degrees, load = np.transpose(
        [
            (1.01, 18.078, 0.021593),
            (1.05, 40.074, 0.270249),
            (1.10, 56.099, 0.925464),
            (1.20, 77.902, 5.50959),
            (1.25, 86.393, 22.9724),
        ]
    )
    npt.assert_allclose(thin_winkler_torque_ratio(np.radians(degrees)), ratio, rtol=1e-5)
    # five digits of the angle
    npt.assert_allclose(thin_winkler_load(np.radians(degrees)), load, rtol=3e-4)


def test_torque_of_the_thesis_machine():  # Farzaneh (2002), appendix A.3 and A.4.2
    torque = friction_torque(0.15, load=1e5 * lbf, radius=np.array([1.25 * inch, 33.36e-3]))
    npt.assert_allclose(torque, [2118.5, 2225.9], rtol=5e-5)


def test_winkler_chart_collapses_for_a_thin_clearance():
    fit = 1e5
    load = thin_winkler_load(0.7) / fit
    found = winkler_contact(
        load * 1e9, shaft_radius=fit / (1 + fit), bushing_radius=1.0, thickness=1.0, modulus=1e9
    )
    npt.assert_allclose(found.half_angle, 0.7, rtol=1e-3)
    npt.assert_allclose(found.torque_ratio, thin_winkler_torque_ratio(0.7), rtol=1e-4)


@given(st.floats(0.01, 1.5))
def test_sampled_pressure_gives_the_torque_ratio(half_angle):
    angle = np.linspace(-half_angle, half_angle, 4001)
    npt.assert_allclose(
        torque_ratio(angle, pressure=np.cos(angle)),
        truncated_cosine_torque_ratio(half_angle),
        rtol=1e-5,
    )
    persson = persson_pressure(angle, half_angle=half_angle, load_per_length=1.0, pin_diameter=1.0)
    assert 1 < torque_ratio(angle, pressure=persson) < uniform_torque_ratio(half_angle)
    npt.assert_allclose(
        torque_ratio(angle, pressure=7 * persson), torque_ratio(angle, pressure=persson)
    )


@given(st.floats(0.02, 0.5), st.floats(-0.1, 0.1), st.floats(1.0, 1e5))
def test_reversal_removes_the_offset(friction, offset, load):
    direction = np.tile([1, 1, 1, 0, -1, -1, -1], 20)
    torque = (friction * direction + offset) * load * 0.01
    found = average_reversals(torque, load=load, radius=0.01, direction=direction)
    npt.assert_allclose(found.friction, friction, rtol=1e-9)
    npt.assert_allclose(found.offset, offset, atol=1e-9)
    assert found.standard_error < 1e-9


def test_standard_error_of_reversals_matches_their_scatter():
    rng = np.random.default_rng(5)
    direction = np.repeat([1, -1], 50)
    pulls = []
    for _ in range(400):
        torque = 0.1 * direction + 0.02 + rng.normal(0, 0.01, direction.size)
        found = average_reversals(torque, load=1.0, radius=1.0, direction=direction)
        pulls.append((found.friction - 0.1) / found.standard_error)
    npt.assert_allclose(np.std(pulls), 1, atol=0.12)
    assert abs(np.mean(pulls)) < 0.2


def test_sampled_torque_ratio_keeps_the_coordinates_of_data_arrays():
    angle = xr.DataArray(np.linspace(-1, 1, 401), dims="angle")
    case = xr.DataArray([1.0, 2.0], dims="case", coords={"case": [10, 20]})
    found = torque_ratio(angle, pressure=case * np.cos(angle))
    assert found.dims == ("case",)
    assert list(found.case) == [10, 20]
    npt.assert_allclose(found, truncated_cosine_torque_ratio(1.0), rtol=1e-5)
    npt.assert_allclose(torque_ratio(angle.values, pressure=np.cos(angle)), found[0])
