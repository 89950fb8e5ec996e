"""Pictures of disc, slider and static film, and the settings written for them."""

import tomllib

import numpy as np
import numpy.testing as npt
import pytest

from erlif.io.settings.tables import RotationSettings, SinusoidalSettings
from erlif.rig import RigSettings
from erlif.rig.film import list_triggers
from erlif.rig.motion import cycle_time, list_pictures
from erlif.rig.run import run_toml


def test_a_linkage_has_its_triggers():
    rig = RigSettings()
    npt.assert_array_equal(list_pictures(rig).reading, list_triggers(rig).reading)
    assert cycle_time(rig) == pytest.approx(60 / 114)


def test_a_disc_turns_evenly():
    """60 rpm at 20 mm is 0.1257 m/s; 8 pictures in a second are 45 degrees apart."""
    rig = RigSettings(mechanism="rotation", pictures=8, load_swing=0.0)
    found = list_pictures(rig)
    npt.assert_allclose(found.speed, 0.125664, rtol=1e-5)
    npt.assert_allclose(np.diff(found.reading), 45.0)
    npt.assert_allclose(np.diff(found.time), 0.125)
    npt.assert_allclose(found.film_min, 6.0)


def test_a_slider_follows_a_cosine():
    """10 mm at 5 Hz: at most 0.1571 m/s; the speed is the derivative of 5 mm sin."""
    rig = RigSettings(mechanism="sinusoidal", pictures=400)
    found = list_pictures(rig)
    position = 5e-3 * np.sin(2 * np.pi * 5 * found.time)
    npt.assert_allclose(found.speed, np.gradient(position, found.time), atol=1e-4)
    assert np.abs(found.speed).max() == pytest.approx(0.15708, rel=1e-4)
    assert cycle_time(rig) == 0.2


def test_a_thicker_film_follows_a_lower_load_on_a_disc():
    """At constant speed the film is the load to the power of -0.62."""
    found = list_pictures(RigSettings(mechanism="rotation", load_swing=0.5))
    slope = np.polyfit(np.log(found.load), np.log(found.film_min), 1)[0]
    assert slope == pytest.approx(-0.62)


def test_a_static_film_is_the_same_in_all_pictures():
    found = list_pictures(RigSettings(mechanism="static", pictures=5))
    npt.assert_allclose(found.film_min, 6.0)
    assert not found.speed.any()


def test_settings_of_the_motion_are_those_of_the_rig():
    rigs = [RigSettings(mechanism=name) for name in ("rotation", "sinusoidal", "static")]
    disc, slider, static = (tomllib.loads(run_toml(rig, list_pictures(rig))) for rig in rigs)
    motion = RotationSettings.model_validate(disc["mechanism"])
    assert (motion.radius, motion.speed) == (0.02, pytest.approx(2 * np.pi))
    motion = SinusoidalSettings.model_validate(slider["mechanism"])
    assert (motion.stroke, motion.frequency) == (0.01, 5.0)
    assert "mechanism" not in static
