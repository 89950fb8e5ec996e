"""Figures of a calibration: points, fit, band, range and residuals are those of the calibration."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
from scenes import film as scene
from scenes.fixture import walled
from scenes.pictures import labels_of, picture, without_texts

from erlif.calibration import Profile
from erlif.calibration.departure import Departure
from erlif.show import plots


def bars_of(points):
    """Lower and upper ends of the error bars of points."""
    (container,) = [box for box in points.axes.containers if box.lines[0] is points]
    segments = np.array([path.vertices for path in container.lines[2][0].get_paths()])
    return segments[:, 0, 1], segments[:, 1, 1]


def test_residuals_are_in_per_cent_of_the_ratio(calibration):
    points = plots.ratio_residuals(calibration)[-1]
    ratio = scene.true_ratio(calibration.curve.curve_thickness.values)
    npt.assert_allclose(points.get_ydata(), 100 * calibration.curve.curve_residual / ratio)
    low, high = bars_of(points)
    npt.assert_allclose(high - low, 2 * 100 * 2e-3 / ratio)
    assert points.axes.get_ylabel() == "residual [% of ratio]"


def test_band_of_the_fit_is_the_scatter_of_its_parameters(calibration):
    rng = np.random.default_rng(3)
    drawn = rng.multivariate_normal([scene.K, scene.P, scene.Q], calibration.covariance, 4000)
    k, p, q = (drawn[:, n, None] for n in range(3))
    t = np.array([1.0, 5.0, 15.0])
    ratio = k * (p / q) * (1 - np.exp(-q * t)) / (1 - np.exp(-p * t))
    vertices = plots.ratio_against_thickness(calibration)[1].get_paths()[0].vertices
    for n, thickness in enumerate(t):
        closest = vertices[np.argmin(np.abs(vertices[:, 0] - thickness)), 0]
        half = np.ptp(vertices[vertices[:, 0] == closest, 1]) / 2
        npt.assert_allclose(half, ratio[:, n].std(), rtol=0.06)


def test_spline_is_named_and_the_model_alone_is_drawn(calibration):
    """A constant spline of 1 % lifts the fit, so that the model alone lies 1 % below."""
    knots = np.array([0.0] * 4 + [20.0] * 4)
    departure = Departure(knots, np.full(4, 0.01), 1e-8 * np.eye(4))
    lifted = replace(calibration, departure=departure)
    fit, *_ = plots.ratio_against_thickness(lifted)
    t, r = fit.get_data()
    npt.assert_allclose(r, np.exp(0.01) * scene.true_ratio(t), rtol=1e-9)
    assert fit.get_label() == "reabsorption model and spline"
    _, _, alone, _ = plots.ratio_residuals(lifted)
    npt.assert_allclose(alone.get_ydata(), 100 * (np.exp(-0.01) - 1))
    assert labels_of(alone.axes) == ["fit, 1 s.d.", "model alone"]


def test_wall_that_reflects_stands_among_the_parameters(calibration):
    fit, *_ = plots.ratio_against_thickness(walled(calibration))
    assert "R = 0.3000 ± 0.0100" in "".join(text.get_text() for text in fit.axes.texts)


def test_profile_of_a_surface_is_drawn_as_coloured_points():
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(4.0), np.arange(3.0)))
    surface = Profile(np.stack([x, y], axis=1), x + y, None)
    (points,) = plots.fixture_profile(surface)
    npt.assert_array_equal(points.get_offsets(), surface.position)
    npt.assert_array_equal(points.get_array(), surface.thickness)
    ax = points.axes
    assert ax.get_aspect() == 1
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("profile x [mm]", "profile y [mm]")
    assert [bar.get_ylabel() for bar in ax.child_axes] == ["thickness by CMM [µm]"]


def test_a_profile_is_drawn_less_its_straight_line():
    """A bow of 1 um over a wedge: its mean is 2/3, and no slope is left in it."""
    x = np.linspace(-1.0, 1.0, 201)
    wedge = Profile(x, 5.0 + 3.0 * x - x**2, None)
    below = plots.profile_figure(wedge).axes[1]
    drawn = below.get_lines()[0].get_ydata()
    npt.assert_allclose(drawn - drawn[100], -(x**2), atol=1e-12)
    assert abs(drawn.mean()) < 1e-12


@picture
def test_fixture_profile(calibration):
    wedge = calibration.curve.curve_thickness.values
    profile = Profile(wedge / 0.8, wedge, 0.02 * wedge)
    points, *_ = plots.fixture_profile(profile, calibration=calibration)
    return without_texts(points.axes.get_figure())


def test_a_band_is_named_once_where_both_panels_show_it(calibration):
    for std in (0.03, 1e-6):  # visible in both panels, and about the residuals alone
        known = replace(calibration, covariance=np.diag([std] * 3) ** 2)
        (legend,) = plots.calibration_figure(known).legends
        assert [text.get_text() for text in legend.get_texts()].count("fit, 1 s.d.") == 1
