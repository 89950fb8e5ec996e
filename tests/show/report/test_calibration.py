"""Lines of a calibration: parameters, range and errors."""

from dataclasses import replace

import numpy as np
import pytest
from scenes.fixture import walled
from scenes.terminal import line_of

from erlif.calibration.departure import Departure
from erlif.show import plots
from erlif.show.report import describe_calibration


@pytest.fixture
def calibration():
    return plots.example_calibration()


def test_calibration_is_described_with_its_errors_and_the_range_of_a_spline(calibration):
    """A constant spline of 1 % of the logarithm lifts the ratio by 1.01 %."""
    text = describe_calibration(calibration)
    assert line_of(text, "q, attenuation camera 2 [1/um]") == "0.24500 ± 0.00100"
    assert line_of(text, "calibrated range") == "0.30 to 16.00 um"
    thin, middle = line_of(text, "error shared by all pixels").split(", ")
    assert (thin.split(" at ")[1], middle.split(" at ")[1]) == ("1.9 um", "8.2 um")
    expected = 100 * float(calibration.thickness_std(8.15)) / 8.15
    assert float(middle.split()[0]) == pytest.approx(expected, abs=0.006)

    knots = np.array([0.0] * 4 + [20.0] * 4)
    departure = Departure(knots, np.full(4, 0.01), 1e-8 * np.eye(4))
    text = describe_calibration(replace(calibration, departure=departure))
    assert line_of(text, "departure from the model").startswith("+1.01 to +1.01 % of the ratio")
    assert "departure from the model" not in describe_calibration(calibration)


def test_wall_that_reflects_is_described_with_the_calibration(calibration):
    text = describe_calibration(walled(calibration))
    assert line_of(text, "a, attenuation laser [1/um]") == "0.20000 ± 0.00316"
    assert line_of(text, "R, reflectance of the wall") == "0.30000 ± 0.01000"
    assert "reflectance" not in describe_calibration(calibration)
