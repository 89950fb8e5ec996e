"""A wall of uneven reflectance: the light of each point, and the length of its pattern."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt

from erlif.rig import RigSettings
from erlif.rig.directory import age
from erlif.rig.dyes import BANDS, THICKEST, DyedOil, filtered_light
from erlif.rig.setup import build_setup


def test_the_light_of_each_point_is_that_before_its_own_wall():
    rig = RigSettings(width=96, height=80, wall=(0.1, 0.2), wall_texture=(0.5, 2.0))
    setup = build_setup(3, rig)
    x, y = np.array([10.0, 40.5, 71.3]), np.array([7.0, 33.3, 60.0])
    joint = age(setup, 0, 2)
    waves = joint.texture.waves
    along, down, phase = waves.T[:, :, None]
    over_mean = 1 + 0.5 * np.sqrt(2 / len(waves)) * np.cos(along * x + down * y + phase).sum(axis=0)
    for film in (1.0, 6.0):
        films = np.full(3, film)
        for number, band in enumerate(BANDS, 1):
            black = filtered_light(np.array(THICKEST), band)
            expected = [
                filtered_light(np.array(film), band, oil=DyedOil(reflectance=0.2 * at)) / black
                for at in over_mean
            ]
            npt.assert_allclose(joint.texture.light(number, films, x, y), expected, rtol=1e-6)

    # the fixture has an even wall
    even = replace(setup, texture=None)
    npt.assert_array_equal(setup.light(1, films, x, y), even.light(1, films, x, y))


def test_the_reflectance_is_correlated_over_the_stated_length():
    rig = RigSettings(width=32, height=32, wall=(0.1, 0.1), wall_texture=(0.5, 3.0))
    waves, far = build_setup(0, rig).texture.waves, np.linspace(0, 1e5, 5000)
    one, two = (
        np.cos(np.multiply.outer(waves[:, 0], far + at) + waves[:, 2:]).sum(axis=0)
        for at in (0.0, 3.0 * 32 / 19.2)
    )
    assert abs(np.mean(one * two) / np.mean(one**2) - np.exp(-1)) < 0.15
