"""What the triggers are drawn against, by the motion and by what the film holds."""

import numpy as np
from matplotlib.figure import Figure
from scenes.motion import DISC, SLIDER, film_of

from erlif.show.plots.triggers import (
    broken,
    choose_abscissa,
    close_turn,
    draw_stretches,
    find_gaps,
    has_varying_speed,
    in_order,
)


def test_the_angle_is_named_after_the_motion_and_several_turns_are_drawn_against_time():
    for mechanism, label in ((DISC, "disc angle [°]"), (SLIDER, "drive angle [°]")):
        along = choose_abscissa(film_of(mechanism))
        assert along.label == label
        assert along.whole_turn
    turning = np.arange(6) * 250.0 % 360
    time = 0.1 * np.arange(6)
    along = choose_abscissa(film_of(DISC, crank_angle=turning, time=time))
    assert along.label == "time [s]"
    assert along.values.tolist() == time.tolist()
    assert choose_abscissa(film_of(DISC, crank_angle=turning)).label == "disc angle [°]"


def test_without_a_motion_time_angle_or_trigger_are_taken_in_this_order():
    film = film_of(None, without=["crank_angle"], time=np.arange(6.0))
    assert choose_abscissa(film).label == "time [s]"
    film = film.drop_vars("time")
    assert choose_abscissa(film).label == "encoder angle [°]"
    film = film.drop_vars("encoder_angle")
    assert choose_abscissa(film).label == "trigger"
    assert choose_abscissa(film).values.tolist() == [0, 1, 2, 3, 4, 5]


def test_a_steady_speed_is_recognised():
    for speed, varies in (([0.25] * 6, False), (np.arange(6.0), True)):
        film = film_of(DISC, without=["rocker_speed"], sliding_speed=np.asarray(speed))
        assert has_varying_speed(film) is varies
        assert not has_varying_speed(film.drop_vars("sliding_speed"))


def test_a_trigger_left_out_of_a_cycle_breaks_the_line():
    """Even angles of a rocker, which a sine stands for, are uneven angles of the crank."""
    crank = np.degrees(np.arcsin(np.linspace(-0.96, 0.96, 26)))
    assert not find_gaps(np.diff(crank)).any()
    for left_out in (5, 12, 20):
        steps = np.diff(np.delete(crank, left_out))
        assert np.flatnonzero(find_gaps(steps)).tolist() == [left_out - 1]


def test_stretches_end_with_their_stroke():
    film = film_of(DISC).assign(stroke=("trigger", [1, 1, -1, -1, -1, 1]))
    parts = in_order(film, np.arange(6.0)[::-1])
    assert [part.tolist() for part in parts] == [[0, 1], [2, 3, 4], [5]]
    line = broken(parts, np.arange(6))
    assert line[~np.isnan(line)].tolist() == [0, 1, 2, 3, 4, 5]
    assert np.flatnonzero(np.isnan(line)).tolist() == [2, 6]


def test_a_stretch_of_one_trigger_is_a_dash():
    """Beside a dead point a cycle that begins within a stroke leaves one, whose line has no end."""
    ax = Figure().add_subplot()
    parts = [np.array([0, 1, 2]), np.array([3]), np.array([4, 5])]
    y = np.array([1.0, 2.0, 3.0, 4.0, np.nan, 6.0])
    (line,) = draw_stretches(ax, parts, np.arange(6.0), y, colour="k")
    assert line.get_marker() == "_"
    assert line.get_ydata()[line.get_markevery()].tolist() == [4.0, 6.0]


def test_no_line_joins_the_triggers_of_two_turns():
    """Two turns and a half, from an angle within the turn; a trigger of the third is left out."""
    angle = np.delete((200 + 30.0 * np.arange(30)) % 360, 24)
    parts = in_order(film_of(DISC).drop_vars("stroke"), angle)
    assert [part[0] for part in parts] == [0, 6, 18, 24]
    for part in parts:
        np.testing.assert_allclose(np.diff(angle[part]), 30)


def test_no_line_leads_from_the_last_trigger_to_the_first():
    """Most of a turn: the film has changed when the angle of the first trigger is near again."""
    angle = (200 + 30.0 * np.arange(11)) % 360
    parts = in_order(film_of(DISC).drop_vars("stroke"), angle)
    assert [part.tolist() for part in parts] == [[*range(6)], [*range(6, 11)]]


def test_a_whole_turn_of_a_disc_is_closed_and_no_other():
    angles = np.array([191.0, 251, 311, 11, 71, 131])
    for mechanism, shown, closed in (
        (DISC, angles, True),
        (DISC, np.arange(6) * 20.0, False),  # a third of a turn
        (DISC, (np.arange(6) * 130.0) % 360, False),  # two turns
        (SLIDER, angles, False),
    ):
        film = film_of(mechanism, crank_angle=shown)
        order, place = close_turn(film, choose_abscissa(film))
        if closed:
            assert place.tolist() == [-49, 11, 71, 131, 191, 251, 311, 371]
            assert order.tolist() == [2, 3, 4, 5, 0, 1, 2, 3]
        else:
            assert place.tolist() == shown.tolist()
