"""One photograph: both cameras receive the same pulse of the same object."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
from scipy.stats import norm

from erlif.rig import RigSettings
from erlif.rig.camera import displacement, seen_from_camera_2
from erlif.rig.film import Bubbles
from erlif.rig.setup import (
    STREAMS,
    Grains,
    Shot,
    beam,
    build_setup,
    draw_grains,
    mix_grains,
    photograph,
    random_stream,
    speckle,
)

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


def test_light_of_rough_walls_is_the_mean_of_normal_heights():
    """Over 2001 quantiles, to a ten-thousandth; that of the mean film is a half per cent off."""
    smooth = build_setup(0, RigSettings(width=32, height=32))
    rough, film = replace(smooth, roughness=0.5), np.full((32, 32), 3.0)
    heights = 0.5 * norm.ppf((np.arange(2001) + 0.5) / 2001)
    for number in (1, 2):
        one, at = smooth.x[:1, :1], film[:1, :1]
        mean = np.mean([smooth.light(number, at + off, one, one) for off in heights])
        found = float(rough.light(number, film, smooth.x, smooth.y)[0, 0])
        npt.assert_allclose(found, mean, rtol=1e-4)
        assert abs(float(smooth.light(number, at, one, one)[0, 0]) / mean - 1) > 3e-3


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


def drawn(rig):
    """Grains of one pulse."""
    fixed = draw_grains(rig, 10, np.random.default_rng(1))
    return mix_grains(fixed, rig, np.random.default_rng(2))


def test_speckle_has_its_contrast_and_correlation():
    rig = RigSettings(width=400, height=400, speckle_fixed=0.06, speckle_new=0.08, speckle_size=0.8)
    grains = drawn(rig)
    y, x = np.indices((400, 400), dtype=float)
    field = speckle(x, y, grains, size=0.8, blur=0.0) - 1
    npt.assert_allclose(field.std(), np.hypot(0.06, 0.08), rtol=0.02)
    for lag in (1, 2):  # two Gaussian grains overlap like exp(-r^2/(4 s^2))
        correlation = np.mean(field[:, lag:] * field[:, :-lag]) / field.var()
        npt.assert_allclose(correlation, np.exp(-(lag**2) / (4 * 0.8**2)), atol=0.015)


def test_camera_sees_speckle_through_its_point_spread():
    grains = drawn(RigSettings(width=40, height=40))
    y, x = np.indices((40, 40)) + 0.37
    # the point spread by Gauss-Hermite quadrature
    node, weight = np.polynomial.hermite_e.hermegauss(14)
    blurred = sum(
        wx * wy * speckle(x + 0.55 * nx, y + 0.55 * ny, grains, size=0.72, blur=0.0)
        for nx, wx in zip(node, weight, strict=True)
        for ny, wy in zip(node, weight, strict=True)
    )
    seen = speckle(x, y, grains, size=0.72, blur=0.55)
    npt.assert_allclose(seen, blurred / (2 * np.pi), atol=1e-4)


def test_one_grain_is_a_gaussian_of_the_blurred_width():
    """s^2 = size^2 + blur^2, and the light of the grain does not depend on the blur."""
    lone = Grains(*(np.full((1, 1), value) for value in (0.25, -0.25, 2.0)), 0)
    away = np.array([0.0, 0.5, 1.0, 2.0])[None]
    for blur in (0.0, 0.9):
        s2 = 0.7**2 + blur**2
        found = speckle(0.25 + away, np.full((1, 4), -0.25), lone, size=0.7, blur=blur)
        peak = 2.0 * 0.7**2 / s2 / (np.sqrt(np.pi) * 0.7)
        npt.assert_allclose(found, 1 + peak * np.exp(-(away**2) / (2 * s2)), atol=2e-6)


def test_pulses_share_the_fixed_part_of_the_speckle():
    """Correlation of two pulses: the fixed variance over the whole."""
    rig = RigSettings(width=200, height=200, speckle_fixed=0.06, speckle_new=0.08)
    fixed = draw_grains(rig, 0, np.random.default_rng(1))
    one, other = (mix_grains(fixed, rig, np.random.default_rng(seed)) for seed in (2, 3))
    npt.assert_allclose(one.brightness.std(), 0.1, rtol=0.015)
    correlation = np.corrcoef(one.brightness.ravel(), other.brightness.ravel())[0, 1]
    npt.assert_allclose(correlation, 0.36, atol=4 / 200)


def test_beam_falls_to_its_corner_brightness_half_a_diagonal_from_the_axis():
    rig = RigSettings(beam_corner=0.4)
    axis_x = rig.centre[0] + 0.04 * rig.width
    axis_y = rig.centre[1] - 0.03 * rig.height
    turn = np.linspace(0, 2 * np.pi, 9)
    x, y = axis_x + rig.half_diagonal * np.cos(turn), axis_y + rig.half_diagonal * np.sin(turn)
    npt.assert_allclose(beam(x, y, rig), 0.4, rtol=1e-12)
    assert beam(np.array(axis_x), np.array(axis_y), rig) == 1
