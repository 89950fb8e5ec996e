"""Settings of the registration and the eight orientations of camera 2."""

from dataclasses import FrozenInstanceError

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


def test_all_eight_orientations_of_a_rectangle_exist():
    assert set(ORIENTATIONS) == set(SEEN)
    assert ORIENTATIONS[0] == "normal"  # later ones are tried after a failure


def test_each_orientation_turns_the_image_as_its_name_says_without_a_copy():
    for orientation in ORIENTATIONS:
        turned = orient(IMAGE, orientation)
        npt.assert_array_equal(turned, SEEN[orientation], err_msg=orientation)
        assert np.shares_memory(turned, IMAGE)
        back = orient(turned, INVERSE.get(orientation, orientation))
        npt.assert_array_equal(back, IMAGE, err_msg=orientation)


def test_defaults_are_the_documented_ones():
    defaults = RegistrationSettings()
    assert (defaults.window, defaults.step, defaults.passes) == (32, 8, 3)
    assert (defaults.model, defaults.orientation, defaults.whiten) == ("auto", "normal", True)
    assert (defaults.search, defaults.frames_for_map) == (0.27, 32)


@pytest.mark.parametrize(
    "limits",
    [
        {"step": 4, "window": 8},
        {"step": 16, "window": 32},
        {"window": 256},
        {"search": 0.4},
        {"search": 1e-3},
        {"passes": 1, "frames_for_map": 1, "threads": 1},
        {"model": "surface"},
        {"model": "local"},
    ],
)
def test_values_at_the_limits_are_allowed(limits):
    chosen = RegistrationSettings(**limits)
    assert {name: getattr(chosen, name) for name in limits} == limits


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"orientation": "upside_down"}, "orientation must be one of normal, mirrored_x"),
        ({"model": "spline"}, "model must be auto, surface or local; got 'spline'"),
        ({"step": 2}, "window must lie between .* got window 32 and step 2"),
        ({"step": 7}, "step must be even"),
        ({"step": 18}, "got window 32 and step 18"),
        ({"window": 15}, "got window 15 and step 8"),
        ({"window": 257}, "256 px.* got window 257"),
        ({"search": 0.0}, "search must lie above 0"),
        ({"search": 0.41}, "at most at 0.4 of the frame; got 0.41"),
        ({"passes": 0}, "must be at least 1; got 0, 32 and 2"),
        ({"frames_for_map": 0}, "must be at least 1; got 3, 0 and 2"),
        ({"threads": 0}, "must be at least 1; got 3, 32 and 0"),
    ],
)
def test_values_out_of_range_are_refused_with_what_came(wrong, message):
    with pytest.raises(RegistrationError, match=message):
        RegistrationSettings(**wrong)


def test_settings_do_not_change_after_they_are_made():
    settings = RegistrationSettings()
    with pytest.raises(FrozenInstanceError):
        settings.window = 64  # type: ignore[misc]
