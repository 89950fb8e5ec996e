"""Poses as maps of the plane, and which changes of them a known form determines."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import log_ratio, make_points

from erlif.calibration.placement import find_freedom
from erlif.calibration.pose import AS_GIVEN, FoundPose, Pose, find_turn

GIVEN = Pose((12.0, -3.0), 0.3, 0.05)
X = np.linspace(0, 18, 120)


def points_of(film, gradient, position=X, **changes):
    """Points of a film of known gradient without noise."""
    position, gradient = (np.reshape(each, (film.size, -1)) for each in (position, gradient))
    place = {"position": position, "gradient": gradient, "ratio_gradient": 0 * gradient}
    return make_points(film, **place | changes)


def freedom_of(points, *, pixel_pitch=0.06):
    film = points.thickness
    step = 1e-4
    fit = SimpleNamespace(
        kept=np.ones(film.size, bool),
        true_thickness=film,
        thickness_std=points.thickness_std,
        slope=lambda at: (log_ratio(at + step) - log_ratio(at - step)) / (2 * step),
    )
    return find_freedom(points, fit, pixel_pitch=pixel_pitch)


# maps


def test_origin_lies_at_zero_and_direction_turns_towards_image_y():
    along, across = GIVEN.place(np.array([12.0, 112.0, 12.0]), np.array([-3.0, -3.0, 97.0]))
    npt.assert_allclose(along, [0, 5 * np.cos(0.3), 5 * np.sin(0.3)], atol=1e-12)
    npt.assert_allclose(across, [0, -5 * np.sin(0.3), 5 * np.cos(0.3)], atol=1e-12)


@pytest.mark.parametrize(
    "change",
    [(0.7, 0, 0, 0), (0, -0.4, 0, 0), (0, 0, 0.02, 0), (0, 0, 0, 0.1), (0.3, 0.2, 0.01, 0.05)],
)
def test_a_changed_pose_moves_every_pixel_as_stated(change):
    """X becomes middle + offset + (1 + scale) R (X - middle), with R the turn by matrix."""
    middle = np.array([4.0, 1.5])
    column, row = np.random.default_rng(1).uniform(0, 300, (2, 20))
    before = np.stack(GIVEN.place(column, row))
    after = np.stack(GIVEN.changed(np.array(change), middle).place(column, row))
    offset, scale, turn = np.array(change[:2]), change[2], change[3]
    matrix = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    moved = (middle + offset)[:, None] + (1 + scale) * matrix @ (before - middle[:, None])
    npt.assert_allclose(after, moved, atol=1e-12)


def test_notes_state_what_was_refined_and_what_was_left():
    std = np.array([0.01, 0.0, 0.0, np.radians(0.05)])
    found = FoundPose(
        GIVEN,
        np.array([0.3, 0.0, 0.0, np.radians(1.5)]),
        np.diag(std**2),
        np.array([True, False, False, True]),
    )
    line = points_of(1 + X, np.ones(X.size))
    refined, left = (note.text for note in found.describe(line))
    assert "+300.0 ± 10.0 um along the profile" in refined
    assert "turned by +1.500 ± 0.050 degrees" in refined
    assert "left as given: scale." in left
    surface = replace(line, position=np.zeros((X.size, 2)))
    assert "left as given: origin across the profile, scale." in found.describe(surface)[1].text


# what the form determines


@pytest.mark.parametrize(
    ("film", "gradient"),
    [
        (0.1 + 0.9 * X, np.full(X.size, 0.9)),  # a straight wedge
        # any displacement changes this film by a function of thickness, which the curve imitates
        (np.exp(X / 7), np.exp(X / 7) / 7),
        # a ripple whose slope times a pixel is far below the error of the mean
        (1 + 0.9 * X + 1e-3 * np.sin(X), 0.9 + 1e-3 * np.cos(X)),
        (9 + 2.5 * np.sin(X[:10]), 2.5 * np.cos(X[:10])),  # too few points
    ],
)
def test_form_that_determines_nothing(film, gradient):
    assert freedom_of(points_of(film, gradient, X[: film.size])).size == 0


def test_a_symmetric_form_determines_its_offset_and_hides_its_scale():
    """A parabola scaled by 1 + e changes by 2 e times its depth, alike on both sides."""
    film = 1 + 0.1 * (X - 9) ** 2
    found = freedom_of(points_of(film, 0.2 * (X - 9)))
    assert found.size == 1
    npt.assert_allclose(found.shares, [1, 0, 0, 0], atol=1e-6)


def test_a_wavy_ramp_determines_offset_and_scale():
    film = 9 + 0.4 * (X - 9) + 2.5 * np.sin(X)
    points = points_of(film, 0.4 + 2.5 * np.cos(X))
    found = freedom_of(points)
    assert found.size == 2
    npt.assert_allclose(found.shares, [1, 0, 1, 0], atol=1e-12)
    npt.assert_allclose(found.middle, [9, 0], atol=1e-12)
    # the film under a point changes by gradient times displacement of the profile
    for combination in range(2):
        along, _, scale, _ = found.combinations[:, combination]
        expected = points.gradient[:, 0] * (along + scale * (X - 9))
        npt.assert_allclose(found.displacement[:, combination], expected, atol=1e-12)


def test_a_plane_surface_determines_its_turn_alone():
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 18, 30), np.linspace(0, 12, 20)))
    gradient = np.stack([np.full_like(x, 0.9), 0 * x], axis=1)
    found = freedom_of(points_of(1 + 0.9 * x, gradient, np.stack([x, y], axis=1)))
    assert found.size == 1
    npt.assert_allclose(found.shares, [0, 0, 0, 1], atol=1e-6)


# the turn of a line


def line_with_slopes(turn, *, noise, rng, count=60):
    """A line whose ratio has slopes along and across it as a turned image shows them."""
    along = 0.05 + 0.03 * np.sin(np.arange(count))
    position = np.linspace(0, 18, count)
    return points_of(
        1 + position,
        np.ones(count),
        position,
        ratio_gradient=along[:, None],
        across_slope=turn * along + rng.normal(0, noise, count),
        across_slope_std=np.full(count, noise),
    )


def test_a_turn_is_the_slope_across_over_the_slope_along():
    rng = np.random.default_rng(3)
    pulls = []
    for _ in range(50):
        found = find_turn(line_with_slopes(0.02, noise=2e-4, rng=rng), pixel_pitch=0.06)
        pulls.append((found.angle - 0.02) / found.std)
    assert abs(np.mean(pulls)) < 4 / np.sqrt(50)
    assert 0.7 < np.std(pulls) < 1.3


def test_dust_does_not_turn_a_line():
    points = line_with_slopes(0.02, noise=1e-4, rng=np.random.default_rng(4))
    across = points.across_slope.copy()
    across[[5, 33]] += 0.02
    found = find_turn(replace(points, across_slope=across), pixel_pitch=0.06)
    assert abs(found.angle - 0.02) < 4 * found.std


def test_an_insignificant_turn_leaves_the_given_direction():
    """Below three standard deviations; chance exceeds them in 0.3 % of 100 draws."""
    rng = np.random.default_rng(5)
    found = [
        find_turn(line_with_slopes(0.0, noise=2e-4, rng=rng), pixel_pitch=0.06) for _ in range(100)
    ]
    assert sum(turn is not AS_GIVEN for turn in found) <= 3


def test_an_uncertain_turn_leaves_the_given_direction():
    """5 standard deviations from zero, but uncertain by more than a pixel at the profile's edge."""
    points = line_with_slopes(0.5, noise=0.04, rng=np.random.default_rng(6))
    assert find_turn(points, pixel_pitch=0.06) is AS_GIVEN
    assert find_turn(points, pixel_pitch=6.0) is not AS_GIVEN


def test_surfaces_and_short_lines_leave_the_given_direction():
    points = line_with_slopes(0.02, noise=1e-4, rng=np.random.default_rng(7))
    assert find_turn(replace(points, position=np.zeros((60, 2))), pixel_pitch=0.06) is AS_GIVEN
    few = np.where(np.arange(60) < 7, points.across_slope, np.nan)
    assert find_turn(replace(points, across_slope=few), pixel_pitch=0.06) is AS_GIVEN
