"""The table of refusals of darks, flats and frames."""

from erlif.core.errors import FrameError
from erlif.correction.refusals import refusal


def test_a_refusal_names_the_camera_and_its_saturation():
    error = refusal("no_flats", camera="camera2", saturation=4095)
    assert type(error) is FrameError
    assert str(error) == (
        "Expected flats of camera2 well above dark and below saturation (4095); none is. Record "
        "flats with the light at a quarter to three quarters of full scale."
    )
