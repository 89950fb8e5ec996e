"""One photograph: both cameras receive the same pulse of the same object."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt

from erlif.rig import RigSettings
from erlif.rig.camera import displacement, seen_from_camera_2
from erlif.rig.film import Bubbles
from erlif.rig.scene import Grains, beam
from erlif.rig.setup import STREAMS, Shot, build_setup, photograph, random_stream

NO_BUBBLES = Bubbles(*np.empty((3, 0)))


def test_one_bright_grain_appears_displaced_in_camera_2():
    rig = RigSettings(
        width=96, height=80, bubbles=0, speckle_size=2.0, dust=0, response_spread=0, hot_fraction=0
    )
    setup = build_setup(0, rig)
    brightness = np.zeros_like(setup.grains.brightness)
    margin = setup.grains.margin
    dark = Grains(setup.grains.x, setup.grains.y, brightness.copy(), margin)
    brightness[margin + 25, margin + 60] = 4.0
    bright = Grains(setup.grains.x, setup.grains.y, brightness, margin)
    at_x, at_y = setup.grains.x[margin + 25, margin + 60], setup.grains.y[margin + 25, margin + 60]
    drift = (0.4, -0.7)
    with_grain, without = (
        photograph(
            setup,
            Shot(lambda x, y: np.full(x.shape, 6.0), NO_BUBBLES, grains, 1.0, drift),
            np.random.default_rng(1),
        )
        for grains in (bright, dark)
    )
    y, x = np.indices((80, 96))
    near = np.hypot(x - at_x, y - at_y) < 14
    found = []
    for number in (0, 1):
        light = with_grain[number].astype(float) - without[number]
        light = np.where(near & (light > 0.1 * light.max()), light, 0)
        found.append(((x * light).sum() / light.sum(), (y * light).sum() / light.sum()))
    npt.assert_allclose(found[0], (at_x, at_y), atol=0.08)
    dx, dy = displacement(np.array([[at_x]]), np.array([[at_y]]), rig)
    npt.assert_allclose(
        np.subtract(found[1], found[0]), (dx[0, 0] + drift[0], dy[0, 0] + drift[1]), atol=0.12
    )


def test_streams_depend_on_seed_purpose_and_number_alone():
    first = {
        (seed, name, number): random_stream(seed, name, number).integers(2**62)
        for seed in (0, 1)
        for name in STREAMS
        for number in (0, 1)
    }
    assert len(set(first.values())) == len(first)
    assert random_stream(1, "grains").integers(2**62) == first[1, "grains", 0]


def test_light_follows_exposure_beam_and_film():
    rig = RigSettings(width=64, height=48)
    setup, brighter = build_setup(0, rig), build_setup(0, RigSettings(width=64, height=48, light=2))
    x, y = setup.x, setup.y
    film = np.full(x.shape, 500.0)  # beyond saturation
    axis_x = np.array([rig.centre[0] + 0.04 * 64])
    axis_y = np.array([rig.centre[1] - 0.03 * 48])
    for number, electrons in ((1, 11000.0), (2, 11500.0)):
        npt.assert_allclose(setup.light(number, film[0, :1], axis_x, axis_y), electrons, rtol=1e-9)
        npt.assert_allclose(
            brighter.light(number, film, x, y), 2 * setup.light(number, film, x, y), rtol=1e-12
        )


def test_grains_cover_every_object_point_of_camera_2():
    """The lattice extends beyond the largest displacement, offset and shake."""
    rig = RigSettings(width=96, height=80, shift=(15.0, -3.0), vibration=0.5)
    setup = build_setup(0, rig)
    dx, dy = displacement(setup.x, setup.y, rig)
    assert setup.grains.margin > max(np.abs(dx).max(), np.abs(dy).max()) + 6 * 0.5
    margin = setup.grains.margin
    assert setup.grains.x.shape == (80 + 2 * margin, 96 + 2 * margin)


def test_a_dry_joint_shows_the_background_times_the_pulse_energy():
    """Even light of 2 % and light with the beam's shape of 1 % of 5000 electrons, no film.

    In camera 2 the share of 2000 electrons is 2.5 times as large.
    """
    rig = RigSettings(
        width=64,
        height=48,
        hot_fraction=0.0,
        dead_pixels=0,
        background=0.02,
        background_beam=0.01,
        background_second=2.5,
    )
    setup = replace(build_setup(3, rig), typical=(5000.0, 1600.0))
    shot = Shot(lambda x, y: np.zeros(x.shape), NO_BUBBLES, setup.grains, 3.0, (0.0, 0.0))
    frames = photograph(setup, shot, np.random.default_rng(1))
    for number, camera, typical in ((1, setup.cameras[0], 5000), (2, setup.cameras[1], 4000)):
        x, y = setup.x, setup.y
        if number == 2:
            x, y = seen_from_camera_2(x, y, (0.0, 0.0), rig)
        expected = 3 * typical * (0.02 + 0.01 * beam(x, y, rig)) * camera.sensitivity
        light = (frames[number - 1] - camera.dark_level) * rig.gain
        # 3072 pixels of some 500 electrons, 9 electrons of read noise
        npt.assert_allclose(light.mean(), expected.mean(), atol=4 * 25 / np.sqrt(light.size))
