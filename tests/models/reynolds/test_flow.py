"""Viscosity under pressure and rough walls."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.models.reynolds.flow import Fluid


def test_reduced_pressure_is_the_integral_of_the_fluidity():
    fluid = Fluid(0.1, pressure_viscosity=2e-8)
    pressure = np.linspace(0.0, 8e7, 4001)
    fluidity = np.exp(-2e-8 * pressure)  # eta0 / eta of Barus
    area = np.sum((fluidity[1:] + fluidity[:-1]) / 2) * (pressure[1] - pressure[0])
    npt.assert_allclose(fluid.reduced(8e7), area, rtol=1e-6)
    found, slope = fluid.pressure(np.array([fluid.reduced(8e7)]))
    npt.assert_allclose(found, 8e7, rtol=1e-12)
    npt.assert_allclose(slope, np.exp(2e-8 * 8e7), rtol=1e-12)


@pytest.mark.parametrize(("ratio", "factor"), [(1.0, 0.486), (3.0, 0.832), (6.0, 0.969)])
def test_pressure_flow_factor_of_patir_and_cheng(ratio, factor):
    """The isotropic fit of Patir and Cheng (1978), 1 - 0.9 exp(-0.56 H)."""
    rough, _ = Fluid(0.1, roughness=1e-6).mobility(np.array([ratio * 1e-6]))
    smooth, _ = Fluid(0.1).mobility(np.array([ratio * 1e-6]))
    npt.assert_allclose(rough / smooth, factor, atol=6e-4)


def test_slope_of_the_rough_mobility_is_its_derivative():
    fluid, film, step = Fluid(0.1, roughness=1e-6), 3e-6, 1e-11
    ends, _ = fluid.mobility(np.array([film - step, film + step]))
    _, slope = fluid.mobility(np.array([film]))
    npt.assert_allclose(slope, np.diff(ends) / (2 * step), rtol=1e-6)
