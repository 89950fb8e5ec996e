"""Film thickness against speed over load: points, bars, powers and theory are those of the film."""

import matplotlib.pyplot as plt
import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene
from scenes.pictures import labels_of

from erlif.show import plots
from erlif.show.plots import film_over_theory
from erlif.show.plots.style import MUTED
from erlif.show.plots.trend import has_ratio

SPEED_OVER_LOAD = 1e3 * np.abs(scene.rocker_speed(scene.CRANK)) / scene.LOAD


def points_of(artists, colour):
    """All points of one colour, in the order of their places."""
    x = np.concatenate([line.get_xdata() for line in artists if line.get_color() == colour])
    y = np.concatenate([line.get_ydata() for line in artists if line.get_color() == colour])
    order = np.argsort(x)
    return x[order], y[order]


def test_drawn_power_goes_through_the_films(film):
    *_, line = plots.film_against_speed(film)
    x, y = line.get_data()
    npt.assert_allclose(np.polyfit(np.log(x), np.log(y), 1)[0], scene.POWER, rtol=1e-6)
    drawn = np.exp(np.interp(np.log(np.sort(SPEED_OVER_LOAD)), np.log(x), np.log(y)))
    npt.assert_allclose(drawn, np.sort(scene.minimum_film()), rtol=1e-6)
    npt.assert_allclose([x.min(), x.max()], [SPEED_OVER_LOAD.min(), SPEED_OVER_LOAD.max()])
    of = f",\n{scene.TRIGGERS} of {scene.TRIGGERS} triggers"
    powers = [f"mean, n = 0.400 ± 0.010{of}", f"minimum, n = 0.600 ± 0.010{of}"]
    assert labels_of(line.axes) == [*powers, "outward", "return"]


def test_triggers_too_slow_for_the_fit_are_grey(changed):
    changed.rocker_speed.values[0] *= 0.02
    artists = plots.film_against_speed(changed)
    x, y = points_of(artists[:-2], MUTED)
    npt.assert_array_equal(np.sort(y), np.sort([changed.film_mean[0], changed.film_min[0]]))
    npt.assert_allclose(x, 1e3 * abs(float(changed.rocker_speed[0])) / scene.LOAD)
    assert labels_of(artists[-1].axes)[-1] == "not in the fit"
    # the fitted line ends at the slowest trigger of the fit
    assert artists[-1].get_xdata().min() > x.max()


def test_a_theory_of_two_loads_is_no_line_and_one_beyond_the_axis_has_no_key(changed):
    """Back at the same speeds under twice the load, the curve would be a loop."""
    changed.rocker_speed.values[:] = speed = np.array([1.0, 2.0, 3.0, 3.2, 2.1, 1.1])
    for loads, loop in ((0.0, False), (0.5, True)):
        changed.film_hamrock_dowson.values[:] = speed - loads * (np.arange(6) > 2)
        *_, theory, formula = plots.film_and_theory(changed)
        assert (formula.get_linestyle() == "None") == loop
        assert formula.get_color() != "none"
    assert "\nbeyond the axis" in theory.get_label()
    assert theory.get_color() == "none"


@pytest.mark.parametrize("factor", [0.5, 2.5, 20.0])
def test_axis_holds_the_film_with_its_bars_and_theory_that_is_near(changed, factor):
    """Theory twenty times as thick would press measurement and prediction into a line."""
    *measured, transient, theory, _ = plots.film_and_theory(
        changed.assign(film_theory=factor * changed.film_min)
    )
    low, high = transient.axes.get_ylim()
    least = np.min([line.get_ydata().min() for line in (*measured, transient)])
    most = np.max([line.get_ydata().max() for line in (*measured, transient)])
    assert low < least - 0.03
    assert high > most + 0.03
    assert low > least / 4
    assert (low < theory.get_ydata().min() and theory.get_ydata().max() < high) == (factor < 3)
    assert ("beyond" in theory.get_label()) == (factor > 3)


def test_the_speed_of_the_exponent_is_drawn(film):
    """A film of a linkage whose log has the speed."""
    logged = film.copy()
    logged["speed_exponent"] = film.speed_exponent.assign_attrs(speed="sliding_speed")
    ax = plots.film_against_speed(logged)[0].axes
    assert ax.get_xlabel().startswith("sliding speed over load")
    assert plots.film_against_speed(film)[0].axes.get_xlabel().startswith("speed over load")


def test_a_statistic_without_a_point_is_not_in_the_legend(changed):
    """Here the mean, and the return stroke of the minimum, have none."""
    changed["film_mean"] = changed.film_mean * np.nan
    for name in ("speed_exponent_mean", "speed_exponent_mean_std"):
        changed[name] = changed[name] * np.nan
    assert not [
        text
        for text in labels_of(plots.film_against_speed(changed)[0].axes)
        if text.startswith("mean")
    ]
    changed["film_min"] = changed.film_min.where(changed.stroke > 0)
    labels = labels_of(plots.film_and_theory(changed)[0].axes)
    assert "measured minimum, outward" in labels
    assert "measured minimum, return" not in labels


@pytest.mark.parametrize("draw", [plots.film_against_speed, plots.film_and_theory])
def test_the_legend_lies_below_the_axes_so_that_no_line_crosses_it(changed, draw):
    """Also in axes of one's own, within whose place both stay."""
    steep = changed.assign(film_theory=2.5 * changed.film_min)
    figure, panels = plt.subplots(2, 1, figsize=(5, 8), layout="constrained")
    ax = draw(steep, ax=panels[0])[0].axes
    figure.draw_without_rendering()
    legend = ax.get_legend().get_window_extent()
    assert legend.y1 < ax.bbox.y0
    assert legend.y0 > panels[1].bbox.y1
    plt.close(figure)


def test_a_mean_that_leaves_out_pixels_beyond_the_range_is_grey(film):
    """It is in no exponent; the minimum of the same trigger is."""
    share = np.where(np.arange(scene.TRIGGERS) == 2, 0.03, 0.0)
    artists = plots.film_against_speed(film.assign(share_beyond_range=("trigger", share)))
    _, y = points_of(artists[:-2], MUTED)
    npt.assert_array_equal(y, [film.film_mean[2]])


@pytest.fixture
def ratios(film):
    """The ratio to the regime map, without its first trigger, and no other."""
    values = np.linspace(0.4, 0.6, film.sizes["trigger"])
    values[0] = np.nan
    return film.assign(
        film_over_theory=("trigger", values, {"factor": 0.5}),
        film_over_theory_std=("trigger", 0.1 * values),
        film_over_predicted=("trigger", values * np.nan, {"factor": np.nan}),
        film_over_predicted_std=("trigger", values * np.nan),
    )


def test_points_and_median_are_those_of_the_film(ratios):
    points = film_over_theory(ratios)
    drawn = np.sort(np.concatenate([one.get_ydata() for one in points]))
    npt.assert_allclose(drawn, ratios.film_over_theory.values[1:])
    ax = points[0].axes
    assert ax.get_legend().get_texts()[0].get_text() == "over regime map: 0.500"
    assert len(ax.get_legend().get_texts()) == 1


def test_central_film_over_theory_is_drawn_for_a_plateau(ratios):
    central = (2 * ratios.film_over_theory).assign_attrs(factor=1.0)
    ratios = ratios.assign(film_central=ratios.film_min, film_central_over_theory=central)
    ratios["film_central_over_theory_std"] = 0.1 * central
    for contact, count in (("point", 1), ("plateau", 2)):
        points = film_over_theory(ratios.assign_attrs(contact=contact))
        labels = [one.get_text() for one in points[0].axes.get_legend().get_texts()]
        assert labels == ["over regime map: 0.500", "over regime map, at the centre: 1.00"][:count]


def test_a_film_without_a_ratio_has_no_panel(film, ratios):
    assert has_ratio(ratios)
    assert not has_ratio(film)
    assert not has_ratio(ratios.assign(film_over_theory=ratios.film_over_theory * np.nan))


def test_a_theory_that_is_far_off_leaves_the_axis_to_one_that_is_not(ratios):
    std = ratios.film_over_theory_std
    far = (0.01 * ratios.film_over_theory).assign_attrs(factor=0.005, formula_error=np.inf)
    both = ratios.assign(
        film_over_hamrock_dowson=ratios.film_over_theory.assign_attrs(factor=0.5),
        film_over_hamrock_dowson_std=std,
        film_over_theory=far,
    )
    points = film_over_theory(both)
    drawn = np.concatenate([one.get_ydata() for one in points])
    assert drawn.min() > 0.3
    labels = points[0].axes.get_legend_handles_labels()[1]
    assert "over regime map: 0.00500, not its regime, beyond the axis" in labels
