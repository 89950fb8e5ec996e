"""Speed and film thickness over a cycle: curves are the linkage, points are the triggers."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene
from scenes.motion import DISC, film_of
from scenes.pictures import labels_of

from erlif.show import plots
from erlif.show.plots import style
from erlif.show.plots.kinematics import linkage_cycle


def test_speed_curve_is_the_linkage_and_goes_through_the_triggers(film):
    curve, outward, back = plots.speed_against_angle(film)
    angle, speed = curve.get_data()
    npt.assert_allclose(np.ptp(angle), 24.4260, atol=2e-3)  # swing by two other linkage programs
    # the interior angle runs the other way
    npt.assert_allclose([speed.max(), -speed.min()], [2.552104, 2.540492], rtol=1e-5)
    for points in (outward, back):
        for x, y in zip(*points.get_data(), strict=True):
            assert np.hypot((angle - x) / 24, (speed - y) / 5).min() < 5e-3
    assert len(outward.get_xdata()) + len(back.get_xdata()) == scene.TRIGGERS


def test_speed_over_the_cycle_is_that_of_the_law_of_cosines(film):
    """The surface of a pin of 33.36 mm radius moves by 33.36 mm/s at 1 rad/s."""
    curve, outward, back = plots.speed_over_cycle(film)
    ax = curve.axes
    (second,) = ax.child_axes
    ax.get_figure().draw_without_rendering()
    npt.assert_allclose(second.get_ylim(), np.array(ax.get_ylim()) * 33.36, rtol=1e-12)
    crank, speed = curve.get_data()
    interpolated = np.interp(scene.CRANK, crank, speed)
    npt.assert_allclose(interpolated, scene.rocker_speed(scene.CRANK), atol=1e-3)
    drawn = np.sort(np.concatenate([outward.get_xdata(), back.get_xdata()]))
    npt.assert_array_equal(drawn, np.sort(scene.CRANK))


def test_reading_of_an_encoder_on_the_crank_is_the_crank_angle(film, with_settings):
    mounted = with_settings(
        ('mounted_on = "rocker"', 'mounted_on = "crank"'), ("zero = ", 'zero = "0 rad" # ')
    )
    cycle = linkage_cycle(mounted)
    npt.assert_allclose(cycle.reading, cycle.crank_angle % 360, atol=1e-9)
    curve, *_ = plots.speed_against_angle(mounted)
    # the jump from 360 to 0 degree is not joined by a line
    x = curve.get_xdata()
    assert np.isnan(x).sum() == 1
    assert np.nanmax(np.abs(np.diff(x))) < 1


def test_bands_are_one_standard_deviation(film):
    artists = plots.film_over_cycle(film)
    for band, line in zip(artists[0::2], artists[1::2], strict=True):
        edges = np.concatenate([path.vertices for path in band.get_paths()])
        std = 0.02 if line.get_color() == artists[1].get_color() else 0.03
        for x in line.get_xdata():
            npt.assert_allclose(np.ptp(edges[edges[:, 0] == x, 1]), 2 * std)


def test_minimum_has_an_axis_of_its_own_and_the_turn_of_a_disc_is_closed():
    """A mean of 12 um beside a minimum of 1.1 to 2.1 um."""
    angle = 30.0 + 60.0 * np.arange(6)
    thin = 1.6 + 0.5 * np.cos(np.radians(angle))
    names = {"film_min": thin, "film_mean": np.full(6, 12.0)}
    names |= {"sliding_speed": np.full(6, 0.25)}
    film = film_of(DISC, without=["rocker_speed", "stroke"], crank_angle=angle, **names)
    above, below = plots.cycle_figure(film).axes
    assert above.get_ylabel() == "minimum film [µm]"
    assert 2.1 < above.get_ylim()[1] < 2.5
    assert below.get_ylim()[1] > 12
    line = above.lines[0]
    npt.assert_allclose(line.get_xdata(), np.r_[-30, angle, 390])
    npt.assert_allclose(line.get_ydata(), np.r_[thin[-1], thin, thin[0]])


def test_film_over_the_cycle_fills_its_axes_unless_it_comes_close_to_contact(film):
    """From zero, a film of 6.0 to 6.2 um would take 3 % of the axes."""
    for low, high in ((6.0, 6.2), (0.5, 6.0)):
        films = np.linspace(low, high, scene.TRIGGERS)
        known = film.assign(film_min=("trigger", films), film_mean=("trigger", films))
        bottom, top = plots.film_over_cycle(known)[0].axes.get_ylim()
        assert (bottom == 0) == (low < 1)
        drawn = (low - 0.03, high + 0.03)
        assert bottom <= drawn[0]
        assert drawn[1] < top
        assert drawn[1] - max(drawn[0], 0.0) > 0.5 * (top - bottom)


@pytest.mark.parametrize(
    ("draw", "thinnest"), [(plots.cycle_figure, 0.05), (plots.film_over_cycle, 1.0)]
)
def test_legend_covers_no_film(film, draw, thinnest):
    """Near the second dead point, at 200 degrees of the crank, the film is close to contact."""
    thick = thinnest + 3.0 * np.sin(np.radians(scene.CRANK - 200) / 2) ** 2
    known = film.assign(film_min=("trigger", thick), film_mean=("trigger", thick + 0.5))
    drawn = draw(known)
    ax = drawn[0].axes if isinstance(drawn, list) else drawn.axes[0]
    ax.get_figure().draw_without_rendering()

    box = ax.get_legend().get_window_extent()
    curves = [line.get_xydata() for line in ax.lines if len(line.get_xdata()) > 2]
    bands = [path.vertices for band in ax.collections for path in band.get_paths()]
    points = ax.transData.transform(np.concatenate([*curves, *bands]))
    assert not any(box.contains(*xy) for xy in points)


def test_joint_of_a_slider_crank_turns_by_crank_less_rod(with_settings):
    """The rod is inclined by arcsin(-a/l sin t); the crank pin turns against it (Mukras 2008)."""
    slider = with_settings(
        ('kind = "crank-rocker"', 'kind = "slider-crank"'),
        ('rocker = "26 cm"', ""),
        ('ground = "51 cm"', ""),
        ('mounted_on = "rocker"', 'mounted_on = "crank"'),
    )
    cycle = linkage_cycle(slider)
    t, step = np.radians(cycle.crank_angle), 1e-5
    omega = 114 * np.pi / 30

    def rod(angle):
        return np.arcsin(-0.055 / 0.44 * np.sin(angle))

    expected = omega * (1 - (rod(t + step) - rod(t - step)) / (2 * step))
    npt.assert_allclose(cycle.speed, expected, rtol=1e-6)
    assert cycle.speed.min() > 0
    # a joint that turns one way only has no line at speed zero
    horizontal = [
        line
        for line in plots.speed_over_cycle(slider)[0].axes.lines
        if set(line.get_ydata()) == {0}
    ]
    assert horizontal == []


def test_a_mean_of_part_of_the_region_is_pale_and_joined_to_no_other(film):
    """At the second trigger of each stroke 5 % of the region are beyond the measurable range."""
    share = np.where(np.arange(scene.TRIGGERS) % 3 == 1, 0.05, 0.0)
    ax = plots.film_over_cycle(film.assign(share_beyond_range=("trigger", share)))[0].axes
    means = [line for line in ax.lines if line.get_color() == style.MEAN]
    pale = {x for line in means if line.get_alpha() < 1 for x in line.get_xdata()}
    full = {x for line in means if line.get_alpha() == 1 for x in line.get_xdata()}
    assert pale == set(scene.CRANK[share > 0])
    assert full == set(scene.CRANK[share == 0])
    assert labels_of(ax) == ["mean", "mean, part beyond range", "minimum"]
