"""Settings of the registration and the eight orientations of camera 2."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import RegistrationError
from erlif.registration import RegistrationSettings, orient
from erlif.registration.settings import ORIENTATIONS

IMAGE = np.array([[1, 2, 3], [4, 5, 6]])

# drawn by hand: the image of camera 2 as it looks after the turn
SEEN = {
    "normal": [[1, 2, 3], [4, 5, 6]],
    "mirrored_x": [[3, 2, 1], [6, 5, 4]],
    "mirrored_y": [[4, 5, 6], [1, 2, 3]],
    "rotated_90": [[3, 6], [2, 5], [1, 4]],
    "rotated_180": [[6, 5, 4], [3, 2, 1]],
    "rotated_270": [[4, 1], [5, 2], [6, 3]],
    "transposed": [[1, 4], [2, 5], [3, 6]],
    "antitransposed": [[6, 3], [5, 2], [4, 1]],
}

INVERSE = {"rotated_90": "rotated_270", "rotated_270": "rotated_90"}


def test_each_orientation_turns_the_image_as_its_name_says_without_a_copy():
    for orientation in ORIENTATIONS:
        turned = orient(IMAGE, orientation)
        npt.assert_array_equal(turned, SEEN[orientation], err_msg=orientation)
        assert np.shares_memory(turned, IMAGE)
        back = orient(turned, INVERSE.get(orientation, orientation))
        npt.assert_array_equal(back, IMAGE, err_msg=orientation)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"orientation": "upside_down"}, "orientation must be one of normal, mirrored_x"),
        ({"model": "spline"}, "model must be one of auto, surface, local; got 'spline'"),
        ({"step": 2}, "window must lie between .* got window 32 and step 2"),
        ({"search": 0.41}, "at most at 0.4 of the frame; got 0.41"),
        ({"threads": 0}, "must be at least 1; got 3, 32 and 0"),
    ],
)
def test_values_out_of_range_are_refused_with_what_came(wrong, message):
    with pytest.raises(RegistrationError, match=message):
        RegistrationSettings(**wrong)
