"""Laws of viscosity: their defining points, their limits and each other."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from erlif.models.oil import (
    THESIS_80W90,
    barus_viscosity,
    density_at_pressure,
    density_at_temperature,
    fit_vogel,
    kinematic_viscosity,
    roelands_viscosity,
    vogel_viscosity,
    walther_viscosity,
)


def test_the_gear_oil_of_the_thesis():  # Farzaneh (2002), eq. 2.4 and section 2.2.2
    npt.assert_allclose(THESIS_80W90.density, 857.1, atol=0.05)
    npt.assert_allclose(kinematic_viscosity(0.12, density=THESIS_80W90.density), 1.4e-4)


@pytest.mark.parametrize(("at_100", "at_25"), [(13.5e-6, 360e-6), (16e-6, 327e-6)])
def test_walther_at_room_temperature(at_100, at_25):  # 140 cSt taken as the value at 40 C
    found = walther_viscosity(
        298.15, viscosity_1=140e-6, temperature_1=313.15, viscosity_2=at_100, temperature_2=373.15
    )
    npt.assert_allclose(found, at_25, rtol=2e-3)


@given(st.floats(5e-6, 1e-3), st.floats(1.5, 20.0), st.floats(275, 400))
def test_walther_passes_its_points_and_falls_between(nu, ratio, temperature):
    points = {
        "viscosity_1": nu * ratio,
        "temperature_1": 313.15,
        "viscosity_2": nu,
        "temperature_2": 373.15,
    }
    npt.assert_allclose(
        walther_viscosity(np.array([313.15, 373.15]), **points), [nu * ratio, nu], rtol=1e-9
    )
    assert walther_viscosity(temperature, **points) > walther_viscosity(temperature + 1, **points)
    # ASTM D341 in its own variables: W is linear in log T
    T = np.array([300.0, 330.0, 363.0])
    w = np.log10(np.log10(walther_viscosity(T, **points) * 1e6 + 0.7))
    npt.assert_allclose(w[0] - w[1], w[1] - w[2], rtol=1e-6)


@pytest.mark.filterwarnings("ignore::erlif.core.errors.UnitWarning")  # oils thicker than any
@given(st.floats(1e-5, 1e-3), st.floats(500, 1500), st.floats(140, 200))
def test_vogel_constants_come_back_from_three_points(a, b, c):
    T = np.array([373.15, 298.15, 313.15])
    eta = a * np.exp(b / (T - c))  # Farzaneh (2002), eq. 2.5
    npt.assert_allclose(vogel_viscosity(T, a=a, b=b, c=c), eta)
    npt.assert_allclose(fit_vogel(T, viscosities=eta), (a, b, c), rtol=1e-6)


def test_vogel_and_walther_agree_between_their_points():
    T = np.array([298.15, 313.15, 373.15])
    points = {
        "viscosity_1": 140e-6,
        "temperature_1": 313.15,
        "viscosity_2": 14.7e-6,
        "temperature_2": 373.15,
    }
    a, b, c = fit_vogel(T, viscosities=walther_viscosity(T, **points))
    between = np.linspace(298.15, 373.15, 20)
    npt.assert_allclose(
        vogel_viscosity(between, a=a, b=b, c=c), walther_viscosity(between, **points), rtol=0.01
    )


@given(st.floats(1e-3, 10.0), st.floats(1e-8, 3e-8))
def test_roelands_starts_like_barus_and_stays_below(viscosity, alpha):
    oil = {"viscosity": viscosity, "pressure_viscosity": alpha}
    assert roelands_viscosity(0.0, **oil) == viscosity
    step = 1e3
    slope = np.log(roelands_viscosity(step, **oil) / viscosity) / step
    npt.assert_allclose(slope, alpha, rtol=1e-4)
    exponent = alpha * 1.96e8 / (np.log(viscosity) + 9.67)
    if exponent < 1:
        assert roelands_viscosity(5e8, **oil) < barus_viscosity(5e8, **oil)


def test_density_under_pressure_and_heat():
    npt.assert_allclose(density_at_pressure(1e9, density=1000.0), 1000 * (1 + 0.6 / 2.7))
    npt.assert_allclose(
        density_at_pressure(1e15, density=1000.0), 1000 * (1 + 0.6 / 1.7), rtol=1e-5
    )  # the largest density of the law
    npt.assert_allclose(
        density_at_temperature(323.15, density=860.0, reference_temperature=313.15, expansion=7e-4),
        860 * 0.993,
    )
