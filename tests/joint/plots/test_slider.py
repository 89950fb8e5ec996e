"""Figures of the slider-crank: lines are where the dataset has them, in the units of the axes."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pictures import picture, without_texts

from erlif.joint import plots
from erlif.joint.models.slider_wear import bound_extrapolation


@pytest.fixture
def worn():
    angle = np.linspace(-np.pi, np.pi, 24, endpoint=False)
    cycle = np.arange(0, 9000, 1000)
    depth = np.maximum(np.cos(angle), 0) * cycle[:, None] * 1e-7
    return xr.Dataset(
        {"depth": (("cycle", "angle"), depth), "pin_depth": (("cycle", "angle"), 0.1 * depth)},
        {"angle": angle, "cycle": cycle},
    )


def test_profiles_of_wear_end_with_the_last_cycle_and_the_pin(worn):
    *bushing, pin = plots.joint_wear(worn)
    assert [line.get_label() for line in bushing] == [f"{n},000 cycles" for n in (2, 4, 6, 8)]
    npt.assert_allclose(max(bushing[-1].get_ydata()), 0.8)  # mm
    npt.assert_allclose(max(pin.get_ydata()), 0.08)
    npt.assert_allclose(bushing[-1].get_xdata()[12], 0.0, atol=1e-9)


def test_error_of_the_extrapolation_is_in_per_cent_below_its_bound():
    def wear(factor):
        value = ("cycle", [0.0, 2.0 + 2e-5 * factor])
        return xr.Dataset({"worn_volume": value, "greatest_depth": value})

    error, bound, _, _ = plots.extrapolation_error(bound_extrapolation(1000, wear=wear))
    npt.assert_allclose(error.get_ydata(), [1.0, 0.5, 0.25], rtol=1e-6)
    npt.assert_allclose(bound.get_ydata(), [1.25, 0.625, 0.3125], rtol=1e-6)

    # the error from a run that is known better leaves the bound
    fine = xr.Dataset({"worn_volume": 1.99, "greatest_depth": 1.99})
    error, bound, _, _ = plots.extrapolation_error(bound_extrapolation(1000, wear=wear), fine=fine)
    npt.assert_allclose(error.get_ydata(), np.array([0.03, 0.02, 0.015]) / 0.0199, rtol=1e-6)
    npt.assert_allclose(bound.get_ydata(), np.array([0.025, 0.0125, 0.00625]) / 0.0199, rtol=1e-6)


@picture
def test_picture_of_a_worn_bushing(worn):
    first, *_ = plots.joint_wear(worn)
    return without_texts(first.axes.get_figure())
