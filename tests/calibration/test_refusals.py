"""The table of refusals of fixtures and calibrations."""

from erlif.calibration.refusals import refusal
from erlif.core.errors import CalibrationError


def test_a_refusal_names_both_pairs_of_bands():
    error = refusal("other_bands", bands=(580.0, 610.0), calibrated=(590.0, 640.0))
    assert type(error) is CalibrationError
    assert str(error) == (
        "Expected a calibration of the bands of the run, 580 and 610 nm; got one of 590 and "
        "640 nm. Calibrate with the filters of the run."
    )
