"""The orbit of the pin: points, ellipses and clearance are where the positions are."""

import numpy as np
import numpy.testing as npt
from matplotlib.patches import Ellipse
from scenes import film as scene

from erlif.show import plots


def test_points_are_the_displacements_towards_the_load_downwards(film):
    wall, outward, back, *_ = plots.pin_orbit(film)
    side = np.concatenate([outward.get_xdata(), back.get_xdata()])
    load = np.concatenate([outward.get_ydata(), back.get_ydata()])
    npt.assert_allclose(np.sort(load), np.sort(230.0 - scene.minimum_film()))
    npt.assert_allclose(side, 0.2 / 33.475 * load, rtol=1e-4)
    low, high = wall.axes.get_ylim()
    assert low > high
    # the pin touches where both displacements together are the clearance
    npt.assert_allclose(np.hypot(*wall.get_data()), 230.0)


def test_ellipses_are_one_standard_deviation(film):
    """Of the displacements in um; of the angle in degrees and the film nearly so, at 230 um."""
    ellipses = [artist for artist in plots.pin_orbit(film) if isinstance(artist, Ellipse)]
    assert len(ellipses) == scene.TRIGGERS
    load, side = 2 * scene.RANDOM_STD[:2]
    npt.assert_allclose([ellipses[0].width, ellipses[0].height], [side, load], rtol=1e-4)
    npt.assert_allclose(ellipses[0].angle % 180, 0, atol=1e-9)

    unrolled = [artist for artist in plots.closest_film(film) if isinstance(artist, Ellipse)]
    assert len(unrolled) == scene.TRIGGERS + 1
    whole = np.hypot(scene.RANDOM_STD, scene.SHARED_STD)[:2]
    for ellipse, std, k in ((unrolled[0], scene.RANDOM_STD[:2], 0), (unrolled[-1], whole, -1)):
        distance = 230.0 - scene.minimum_film()[k]
        expected = 2 * np.array([std[0], np.degrees(std[1] / distance)])
        npt.assert_allclose(sorted([ellipse.width, ellipse.height]), sorted(expected), rtol=2e-3)


def test_ellipse_of_correlated_errors_is_turned(changed):
    """Equal variances with a positive correlation lie along the diagonal."""
    changed.pin_position_cov_random.values[:, :2, :2] = [[1.0, 0.6], [0.6, 1.0]]
    *_, last = plots.pin_orbit(changed)
    npt.assert_allclose(last.angle % 180, 45)
    npt.assert_allclose([last.width, last.height], 2 * np.sqrt([1.6, 0.4]), rtol=1e-4)


def test_the_orbit_has_no_larger_scale_sideways_than_along_the_load(changed):
    """Noise of 0.1 um sideways beside films that differ by micrometres."""
    load = 230.0 - scene.minimum_film()
    side = 0.05 * (-1.0) ** np.arange(scene.TRIGGERS)
    changed["pin_displacement"].values[:] = np.stack([load, side], axis=1)
    ax = plots.pin_orbit(changed)[0].axes
    assert np.ptp(ax.get_xlim()) > np.ptp(np.append(load, 230.0))
    unrolled = plots.closest_film(changed)[0].axes
    npt.assert_array_less(np.degrees(np.ptp(load) / 230.0), np.ptp(unrolled.get_xlim()))
