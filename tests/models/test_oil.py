"""Laws of viscosity: their defining points, their limits and each other."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from erlif.models.oil import (
    barus_viscosity,
    density_at_pressure,
    density_at_temperature,
    fit_vogel,
    kinematic_viscosity,
    roelands_viscosity,
    vogel_viscosity,
)


@pytest.mark.filterwarnings("ignore::erlif.core.errors.UnitWarning")  # oils thicker than any
@given(st.floats(1e-5, 1e-3), st.floats(500, 1500), st.floats(140, 200))
def test_vogel_constants_come_back_from_three_points(a, b, c):
    T = np.array([373.15, 298.15, 313.15])
    eta = a * np.exp(b / (T - c))  # Farzaneh (2002), eq. 2.5
    npt.assert_allclose(vogel_viscosity(T, a=a, b=b, c=c), eta)
    npt.assert_allclose(fit_vogel(T, viscosities=eta), (a, b, c), rtol=1e-6)


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


def test_kinematic_viscosity_of_the_thesis():  # Farzaneh (2002): 0.12 Pa s, 1.4e-4 m2/s
    npt.assert_allclose(kinematic_viscosity(0.12, density=857.1), 1.4e-4, rtol=1e-4)
