"""Discs, sliders and films at rest, against the closed form of their motion."""

import math

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import EncoderError
from erlif.core.notes import Level
from erlif.kinematics import (
    Sinusoid,
    TurningDisc,
    encoder_notes,
    locate_logged,
    locate_rotation,
    locate_slider,
)


def make_log(count, **columns):
    data = {"number": ("frame", np.arange(count))}
    return xr.Dataset(
        data | {name: ("frame", np.asarray(values, float)) for name, values in columns.items()}
    )


# disc


def test_a_disc_slides_at_speed_times_radius():
    """60 rpm at 20 mm: 2 pi 20 mm/s."""
    found = locate_rotation(make_log(4), rotation=TurningDisc(0.02, 2 * math.pi))
    npt.assert_allclose(found.sliding_speed, 0.125664, rtol=1e-5)
    assert found.trigger.values.tolist() == [0, 1, 2, 3]
    assert set(found) == {"trigger", "cycle", "sliding_speed"}


@pytest.mark.parametrize(("step", "rpm"), [(1e-4, "6.67e+04"), (0.1, ""), (1e3, "0.00667")])
def test_a_rate_beyond_those_of_discs_is_a_time_of_another_unit(step, rpm):
    """40 degrees in 0.1 s are 66.7 rpm; in 0.1 ms, and in 1000 s, times were misread."""
    log = make_log(30, angle=40.0 * np.arange(30) % 360, time=step * np.arange(30))
    notes = list(encoder_notes(locate_rotation(log, rotation=TurningDisc(0.02))))
    words = f"turns at {rpm} rpm, unlike those of test rigs"
    assert any(words in str(note) for note in notes) == bool(rpm)


@pytest.mark.parametrize("wrapped", [True, False])
@pytest.mark.parametrize("sense", [1, -1])
def test_the_speed_of_a_disc_follows_from_angle_and_time(wrapped, sense):
    """40 degrees in 0.1 s: 6.981 rad/s, whether the encoder begins anew at 360 degrees or not."""
    angle = sense * 40.0 * np.arange(30)
    log = make_log(30, angle=angle % 360 if wrapped else angle, time=0.1 * np.arange(30))
    found = locate_rotation(log, rotation=TurningDisc(0.02), zero=math.radians(15))
    npt.assert_allclose(found.sliding_speed, 0.02 * math.radians(400), rtol=1e-12)
    npt.assert_allclose(found.crank_angle, (angle + 15) % 360)
    assert "stroke" not in found


def test_a_disc_that_speeds_up_has_the_derivative_of_its_angle():
    """Angle 50 t^2 degree: 100 t degree/s; central differences of a parabola are exact."""
    time = np.linspace(0, 3, 61)
    log = make_log(61, angle=50 * time**2 % 360, time=time)
    speed = locate_rotation(log, rotation=TurningDisc(0.5)).sliding_speed.values
    npt.assert_allclose(speed[1:-1], 0.5 * np.radians(100 * time[1:-1]), rtol=1e-9)


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"angle": [0, 10, 20]}, "columns angle_deg and time_s"),
        ({"angle": [0, 170, 340], "time": [0, 1, 2]}, "whole turns more"),
        ({"angle": [0, 10, 20], "time": [0, 2, 1]}, "time_s to rise"),
        ({"angle": [5, 5, 5], "time": [0, 1, 2]}, "the same in all frames"),
    ],
)
def test_a_speed_that_the_log_does_not_determine_is_asked_for(columns, words):
    with pytest.raises(EncoderError, match=words) as refusal:
        locate_rotation(make_log(3, **columns), rotation=TurningDisc(0.02))
    assert 'speed = "60 rpm" in [mechanism]' in str(refusal.value)
    with pytest.raises(EncoderError, match="remove bins"):
        locate_rotation(make_log(4), rotation=TurningDisc(0.02, 1.0), bins=4)


def test_a_logged_speed_takes_the_place_of_the_computed_one():
    """As it is; 0.02 m at 3 rad/s; and the slope of a continuous log, 90 degrees in a second."""
    found = locate_rotation(make_log(2, sliding_speed=[0.1, -0.2]), rotation=TurningDisc(0.02, 1.0))
    assert found.sliding_speed.values.tolist() == [0.1, 0.2]
    logged = make_log(2, rotation_speed=[3.0, -3.0], angle_rate=[90.0, 90.0])
    found = locate_rotation(logged, rotation=TurningDisc(0.02, 1.0))
    npt.assert_allclose(found.sliding_speed, 0.06)
    found = locate_rotation(logged.drop_vars("rotation_speed"), rotation=TurningDisc(0.02))
    npt.assert_allclose(found.sliding_speed, 0.01 * math.pi)


# slider


def test_a_slider_has_position_and_speed_of_a_sine():
    """x = 5 mm sin(wt) at 3 Hz, v = 5 mm w cos(wt)."""
    angle = np.arange(0, 720, 25.0)
    found = locate_slider(make_log(angle.size, angle=angle % 360), slider=Sinusoid(0.01, 3.0))
    phase, omega = np.radians(angle), 6 * math.pi
    npt.assert_allclose(found.position, 5 * np.sin(phase), atol=1e-9)
    npt.assert_allclose(
        found.sliding_speed * found.stroke, 0.005 * omega * np.cos(phase), atol=1e-12
    )
    npt.assert_allclose(found.crank_angle, angle % 360)
    assert found.position.attrs["units"] == "mm"


def test_a_slider_without_an_encoder_follows_the_time_from_its_zero():
    """At 2 Hz and from 30 degrees on, 0.125 s is a quarter of a cycle."""
    log = make_log(3, time=[0.0, 0.125, 0.25])
    found = locate_slider(log, slider=Sinusoid(0.01, 2.0), zero=math.radians(30))
    npt.assert_allclose(found.crank_angle, [30, 120, 210])
    npt.assert_allclose(found.position, [2.5, 2.5 * math.sqrt(3), -2.5])
    assert "encoder_angle" not in found


@pytest.mark.parametrize("columns", [{}, {"time": [0.0, 1.0]}])
def test_a_slider_of_unknown_phase_is_refused(columns):
    with pytest.raises(EncoderError, match=r"angle_deg.*zero in \[encoder\]"):
        locate_slider(make_log(2, **columns), slider=Sinusoid(0.01, 2.0))


# without a mechanism


def test_a_logged_speed_that_turns_back_has_strokes():
    found = locate_logged(make_log(4, sliding_speed=[0.1, 0.2, -0.1, -0.2]))
    assert found.sliding_speed.values.tolist() == [0.1, 0.2, 0.1, 0.2]
    assert found.stroke.values.tolist() == [1, 1, -1, -1]
    assert "stroke" not in locate_logged(make_log(2, sliding_speed=[0.1, 0.0]))


# settings that the log contradicts


@pytest.mark.parametrize(
    ("step", "rpm", "given"),
    [
        *((60, 100, None), (60, 104, None), (300, 500, None), (60, 1300, None)),
        *((60, 50, 100), (60, 230, 100), (30, 500, 50), (300, 50, 100), (0, 50, 0)),
    ],
)
def test_a_speed_that_the_log_contradicts_is_reported(step, rpm, given):
    """60 degrees in 0.1 s are 100 rpm or 1.667 Hz, as are 300 degrees the other way.

    1300 rpm turn by 780 degrees in that time, which leave the readings of 60.
    """
    log = make_log(12, angle=np.arange(12) * float(step) % 360, time=0.1 * np.arange(12))
    disc = encoder_notes(locate_rotation(log, rotation=TurningDisc(0.02, rpm * math.pi / 30)))
    slider = encoder_notes(locate_slider(log, slider=Sinusoid(0.01, rpm / 60)))
    assert [note.level for note in (*disc, *slider)] == [Level.WARNING] * 2 * (given is not None)
    if given:
        both = f"speed is {rpm} rpm, but angle and time of the log give {given} rpm"
        assert both in disc[0].text
        both = (
            f"frequency is {rpm / 60:.4g} Hz, but angle and time of the log give {given / 60:.4g}"
        )
        assert both in slider[0].text


def test_a_logged_speed_needs_no_other_one():
    log = make_log(12, angle=30.0 * np.arange(12), time=0.1 * np.arange(12))
    logged = log.assign(rotation_speed=("frame", np.full(12, 5.2)))
    assert encoder_notes(locate_rotation(log, rotation=TurningDisc(0.02, 52.0)))
    assert not encoder_notes(locate_rotation(logged, rotation=TurningDisc(0.02, 52.0)))


# folding


def test_turns_of_a_disc_fold_onto_one():
    log = make_log(12, angle=np.arange(12) * 90.0)
    found = locate_rotation(log, rotation=TurningDisc(0.02, 1.0), triggers_per_cycle=4)
    assert found.trigger.values.tolist() == [0, 1, 2, 3] * 3
    assert found.cycle.values.tolist() == [0] * 4 + [1] * 4 + [2] * 4


@pytest.mark.parametrize(("triggers", "turns"), [(12, 1), (24, 2), (36, 3)])
def test_triggers_that_span_several_turns_have_a_note(triggers, turns):
    """12 frames a turn of 30 degrees each."""
    log = make_log(72, angle=np.arange(72) * 30.0 % 360)
    found = locate_rotation(log, rotation=TurningDisc(0.02, 6.0), triggers_per_cycle=triggers)
    notes = [note for note in encoder_notes(found) if "triggers_per_cycle" in note.text]
    assert [note.level for note in notes] == [Level.NOTE] * (turns > 1)
    assert all(f"spans {turns} turns" in note.text and "12 would" in note.text for note in notes)


@pytest.mark.parametrize("sense", [1, -1])
def test_cycles_are_counted_in_either_sense(sense):
    """30 degrees from frame to frame: 24 frames are two turns, whichever way the disc turns."""
    angle = (5.0 + sense * 30.0 * np.arange(24)) % 360
    log = make_log(24, angle=angle)
    found = locate_rotation(log, rotation=TurningDisc(0.02, 5.0), bins=4)
    assert np.bincount(found.trigger).tolist() == [6, 6, 6, 6]
    passed = np.floor(({1: 5.0, -1: 355.0}[sense] + 30.0 * np.arange(24)) / 360)
    assert found.cycle.values.tolist() == passed.tolist()


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("rated", [True, False])
def test_the_stroke_of_a_slider_is_that_of_its_position(sense, rated):
    angle = (4.0 + sense * 20.0 * np.arange(40)) % 360
    rate = {"angle_rate": np.full(40, sense * 100.0)} if rated else {}
    found = locate_slider(make_log(40, angle=angle, **rate), slider=Sinusoid(0.01, 5.0), bins=10)

    # position half a step later
    later = 5.0 * np.sin(np.radians(angle + sense * 0.01))
    npt.assert_array_equal(found.stroke, np.sign(later - found.position))
    for _, members in found.groupby("trigger"):
        assert np.unique(members.stroke).size == 1
    assert found.cycle.max() <= 3
