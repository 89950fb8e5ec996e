"""Beam and speckle against closed forms of their statistics."""

import numpy as np
import numpy.testing as npt

from erlif.rig import RigSettings
from erlif.rig.scene import Grains, beam, draw_grains, mix_grains, speckle


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
