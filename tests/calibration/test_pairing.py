"""CMM points and the ratio around them, against images whose ratio is known at every place."""

import numpy as np
import numpy.testing as npt
from scenes.fixture import PITCH, SHAPE, calibrate, image, log_ratio

from erlif.calibration import Profile, compare_calibrations
from erlif.calibration.pairing import pair_profile_with_image, thin_out
from erlif.calibration.pose import Pose
from erlif.core.flags import Flag

GIVEN = Pose((0.0, 0.0), 0.0, PITCH)
COLUMN, ROW = np.meshgrid(np.arange(SHAPE[1]) * PITCH, np.arange(SHAPE[0]) * PITCH)


def line_profile(start=1.0, stop=18.0, step=0.25):
    x = np.arange(start, stop, step)
    return Profile(x, x.copy(), np.full(x.size, 0.1))


def still_image(values):
    """An image of known ratio, its noise far below what is tested."""
    return image(np.random.default_rng(0), values, noise=1e-6)


# what a point receives


def test_ratio_at_a_point_of_a_line_is_that_at_its_position():
    """Cells are 4.2 pixels wide, so their mean lies off the point by up to half a pixel."""
    points, notes = pair_profile_with_image(still_image(0.3 * COLUMN), line_profile(), GIVEN)
    npt.assert_allclose(points.log_ratio, 0.3 * points.position[:, 0], atol=2e-5)
    npt.assert_allclose(points.ratio_gradient[:, 0], 0.3, atol=1e-4)
    npt.assert_allclose(points.across_slope, 0, atol=1e-4)
    npt.assert_allclose(points.gradient[:, 0], 1, atol=1e-9)  # thickness is x
    assert any("covers" in note.text for note in notes)  # the profile starts at 1 mm


def test_ratio_at_a_point_of_a_surface_is_freed_of_the_curvature_in_its_cell():
    """A cell of width w has the mean f + (f_xx + f_yy) w^2/24; a tenth of the offset may stay."""
    x, y = (
        axis.ravel() for axis in np.meshgrid(np.arange(0.4, 18.6, 0.4), np.arange(0.4, 3.6, 0.4))
    )

    def form(x, y):
        return 0.2 * (x - 9) ** 2 + 0.1 * x * y + 0.3 * y**2

    profile = Profile(np.stack([x, y], axis=1), 1 + x, np.full(x.size, 0.1))
    points, _ = pair_profile_with_image(still_image(form(COLUMN, ROW)), profile, GIVEN)
    assert points.on_surface
    offset = (0.4 + 0.6) * 0.4**2 / 24
    npt.assert_allclose(points.log_ratio, form(*points.position.T), atol=0.1 * offset)
    px, py = points.position.T
    expected = np.stack([0.4 * (px - 9) + 0.1 * py, 0.1 * px + 0.6 * py], axis=1)
    npt.assert_allclose(points.ratio_gradient, expected, atol=0.02)


def test_a_turned_image_has_a_slope_across_the_line():
    turn = 0.02
    ratios = still_image(0.3 * (np.cos(turn) * COLUMN + np.sin(turn) * ROW))
    points, _ = pair_profile_with_image(ratios, line_profile(), GIVEN)
    npt.assert_allclose(points.across_slope, 0.3 * np.sin(turn), atol=1e-4)
    npt.assert_allclose(points.mean_across, PITCH * (SHAPE[0] - 1) / 2, rtol=1e-6)


def test_error_of_a_point_is_that_of_the_mean_of_its_pixels():
    """64 rows of about 4.2 columns: the noise of one pixel over the root of their number."""
    rng, noise = np.random.default_rng(1), 0.01
    points, _ = pair_profile_with_image(image(rng, 0 * COLUMN, noise=noise), line_profile(), GIVEN)
    pixels = 0.25 / PITCH * SHAPE[0]
    npt.assert_allclose(np.median(points.log_ratio_std), noise / np.sqrt(pixels), rtol=0.06)
    pulls = points.log_ratio / points.log_ratio_std
    assert 0.7 < pulls.std() < 1.3
    npt.assert_allclose(points.pixel_var, noise**2, rtol=1e-5)
    npt.assert_array_equal(points.fixed_var, 0)


def test_scatter_above_the_stated_variance_counts():
    ratios = image(np.random.default_rng(2), 0 * COLUMN, noise=0.01)
    ratios["log_ratio_var"] = ratios.log_ratio_var / 100
    points, _ = pair_profile_with_image(ratios, line_profile(), GIVEN)
    pixels = 0.25 / PITCH * SHAPE[0]
    npt.assert_allclose(np.median(points.log_ratio_std), 0.01 / np.sqrt(pixels), rtol=0.06)


def test_dust_and_flagged_pixels_do_not_reach_the_mean():
    ratios = image(np.random.default_rng(3), 0 * COLUMN, noise=0.001)
    ratios.log_ratio.values[10:14, 100:104] = 3.0
    ratios.flags.values[30:50, 200:220] = Flag.NO_FILM
    ratios.log_ratio.values[30:50, 200:220] = 7.0
    points, _ = pair_profile_with_image(ratios, line_profile(), GIVEN)
    npt.assert_allclose(points.log_ratio, 0, atol=5e-4)


# coverage


def test_points_outside_the_image_are_left_out_and_reported():
    profile = line_profile(start=10.0, stop=24.0)
    points, notes = pair_profile_with_image(still_image(COLUMN), profile, GIVEN)
    assert points.position.max() < SHAPE[1] * PITCH + 0.25
    outside = profile.position.size - points.thickness.size
    assert outside > 15
    texts = [note.text for note in notes]
    assert any(f"{outside} of 56 points of the profile lie outside" in text for text in texts)
    (less,) = (note for note in notes if note.text.startswith("the profile covers 4"))
    assert less.level == "warning"  # 9.2 of 19.2 mm


def test_a_profile_of_more_than_half_the_image_is_a_note():
    """10.8 of 19.2 mm."""
    _, notes = pair_profile_with_image(still_image(COLUMN), line_profile(7.4, 18.0), GIVEN)
    (more,) = (note for note in notes if "covers" in note.text)
    assert more.level == "note"


# dense profiles


def test_close_points_are_averaged_and_their_errors_with_them():
    """Points every 0.02 mm on pixels of 0.1 mm: groups of 0.15 mm hold 7 or 8 of them."""
    x = 0.02 * np.arange(750)
    profile = thin_out(Profile(x, 3 * x, np.full(x.size, 0.1)), pixel_pitch=0.1)
    assert profile.position.size == 100
    npt.assert_allclose(profile.thickness, 3 * profile.position, rtol=1e-12)
    count = np.round((0.1 / profile.uncertainty) ** 2)
    assert set(count) == {7, 8}
    assert count.sum() == 750


def test_distant_points_and_surfaces_are_left_as_they_are():
    line = line_profile(step=0.25)
    assert thin_out(line, pixel_pitch=0.06) is line
    surface = Profile(np.random.default_rng(4).uniform(0, 1, (50, 2)), np.ones(50), None)
    assert thin_out(surface, pixel_pitch=0.5) is surface


def test_a_dense_profile_is_thinned_alike_wherever_each_photograph_was_placed():
    """Two photographs of a wavy ramp, each with its refined pose, rest on the same readings."""
    rng = np.random.default_rng(9)

    def wave(x):
        return 9 + 0.4 * (x - 9) + 2.5 * np.sin(x)

    x = np.arange(0, SHAPE[1] * PITCH, 0.02)
    profile = Profile(x, wave(x) + rng.normal(0, 0.05, x.size), np.full(x.size, 0.05))
    ratio = log_ratio(wave(PITCH * np.arange(SHAPE[1])))
    one, other = (calibrate(image(rng, ratio, noise=0.01), profile, align=True) for _ in range(2))
    assert one.pose.pose.pixel_pitch != other.pose.pose.pixel_pitch
    assert compare_calibrations(one, other).same_profile
