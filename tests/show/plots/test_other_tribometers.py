"""Figures of a slider and of a film at rest: labels of the motion, and no empty panel."""

import numpy as np
import numpy.testing as npt
from scenes.motion import DISC, THEORY, film_of, slider_film, static_film

from erlif.core.flags import Flag
from erlif.io.files import describe_trigger, motion_of
from erlif.show import plots
from erlif.show.plots.files import FigureSource, reason_missing
from erlif.show.report.tables import results_table, trigger_section

SHARES = np.full(6, 0.9)


def labels(figure):
    return [(ax.get_xlabel(), ax.get_ylabel()) for ax in figure.axes]


def test_speed_of_a_slider_is_an_ellipse_over_its_position():
    """5 mm and 157.1 mm/s: pi times 5 Hz times 10 mm."""
    curve, outward, back = plots.speed_against_angle(slider_film())
    x, v = curve.get_data()
    npt.assert_allclose((x / 5) ** 2 + (v / 157.0796) ** 2, 1.0, rtol=1e-6)
    for points, sign in ((outward, 1), (back, -1)):
        x, v = points.get_data()
        npt.assert_allclose(v, sign * 157.0796 * np.sqrt(1 - (x / 5) ** 2), rtol=1e-6)
    assert curve.axes.get_xlabel() == "position from mid-stroke [mm]"
    assert curve.axes.get_ylabel() == "sliding speed [mm/s]"


def test_cycle_of_a_slider_turns_back_at_its_ends():
    figure = plots.cycle_figure(slider_film())
    assert labels(figure)[2] == ("drive angle [°]", "sliding speed [mm/s]")
    dotted = [line for line in figure.axes[0].lines if line.get_linestyle() == ":"]
    assert sorted(line.get_xdata()[0] for line in dotted) == [90.0, 270.0]


def test_film_at_rest_is_drawn_against_the_trigger_alone():
    found = labels(plots.cycle_figure(static_film()))
    assert found == [("", "minimum film [µm]"), ("trigger", "mean film [µm]")]

    # there is no sliding direction and no rigid gap; triggers are named by number or time
    figure = plots.thickness_figure(static_film(), trigger=0)
    named = [pair for pair in labels(figure) if pair[0]]
    assert named == [("x [mm]", "y [mm]"), ("x [mm]", "film thickness [µm]")]
    timed = static_film().assign(time=("trigger", 0.25 * np.arange(6)))
    for film, first in ((static_film(), ["0", "1", "2"]), (timed, ["0 s", "0.25 s", "0.5 s"])):
        titles = [ax.get_title() for ax in plots.map_sheet_figure(film).axes]
        assert titles[:3] == first


def test_film_without_theory_has_one_panel_against_sliding_speed():
    figure = plots.speed_figure(slider_film())
    label = "sliding speed over load, v/F [10⁻³ m s⁻¹ N⁻¹]"
    assert labels(figure) == [(label, "film thickness [µm]")]
    x = np.abs(slider_film().sliding_speed / slider_film()["joint_load"])
    npt.assert_allclose(plots.trend.speed_over_load(slider_film()), x)


def test_figures_that_would_be_empty_are_left_out_with_the_reason(tmp_path):
    without = ["rocker_speed", "stroke", *THEORY]
    steady = film_of(DISC, without=without, sliding_speed=np.full(6, 0.25))
    for film, speed, trend in (
        (slider_film(), None, None),
        (static_film(), "no speed", "no speed and no load"),
        (steady, "the same at all triggers to 1 %, 250 mm/s", "varies by less than 10%"),
    ):
        source = FigureSource(tmp_path / "film.nc", film, 0, None, None)
        names = ("speed_against_angle", "film_against_speed", "film_over_cycle", "map_sheet")
        found = [reason_missing(name, source) for name in names]
        assert found[2:] == [None, None]
        for reason, words in zip(found, (speed, trend), strict=False):
            assert reason is None if words is None else words in reason


def test_tables_have_the_columns_of_the_motion():
    assert motion_of(static_film()) == ""
    table = trigger_section(static_film(), SHARES)
    for title in ("Stroke", "[°]", "[rad/s]", "Load", "Theory"):
        assert title not in table
    table = trigger_section(slider_film(), SHARES)
    assert all(title in table for title in ("Drive [°]", "Position [mm]", "Sliding [mm/s]"))
    rows = dict(results_table(static_film(), np.full((6, 1 + len(Flag)), 0.9)).rows)
    assert "Load" not in rows
    assert "(trigger 4)" in rows["Minimum film thickness"]  # no angle to name


def test_a_trigger_is_named_by_the_angle_of_what_turns():
    steady = film_of(DISC, without=["rocker_speed", "stroke", *THEORY])
    for film, link in ((steady, "disc"), (slider_film(), "drive")):
        assert f", {link} {float(film.crank_angle[1]):.2f}°" in describe_trigger(film, 1)
        foot = plots.map_sheet_figure(film).get_supxlabel()
        assert foot.startswith(f"{link} angle above each map")
