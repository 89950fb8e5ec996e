"""The table of refusals of images and of their registration."""

from erlif.core.errors import RegistrationError
from erlif.registration import RegistrationSettings
from erlif.registration.refusals import refusal


def test_a_refusal_names_the_offset_that_was_found():
    error = refusal("distant", settings=RegistrationSettings(), dx=412.3, dy=-3.6)
    assert type(error) is RegistrationError
    assert str(error) == (
        "Camera 2 is searched within 27% of the frame, but its image fits at an offset of "
        "(412, -4) px. Move its region of interest by that much, or raise search (at most 0.4)."
    )
