"""What the triggers are drawn against, by the motion and by what the film holds."""

import numpy as np
import pytest
from scenes.motion import DISC, SLIDER, film_of

from erlif.plots.triggers import choose_abscissa, has_varying_speed, stroke_looks


@pytest.mark.parametrize(
    ("mechanism", "label"),
    [(DISC, "disc angle [°]"), (SLIDER, "drive angle [°]")],
)
def test_the_angle_is_named_after_the_motion(mechanism, label):
    along = choose_abscissa(film_of(mechanism))
    assert along.label == label
    assert along.whole_turn


def test_a_disc_that_turns_several_times_is_drawn_against_time():
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


def test_without_strokes_all_triggers_look_alike():
    ((members, look),) = stroke_looks(film_of(DISC, without=["stroke"]))
    assert members.all()
    assert look["label"] == "trigger"


@pytest.mark.parametrize(("speed", "varies"), [([0.25] * 6, False), (np.arange(6.0), True)])
def test_a_steady_speed_is_recognised(speed, varies):
    film = film_of(DISC, without=["rocker_speed"], sliding_speed=np.asarray(speed))
    assert has_varying_speed(film) is varies
    assert not has_varying_speed(film.drop_vars("sliding_speed"))
