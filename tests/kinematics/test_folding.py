"""Triggers that repeat, triggers that do not, and averages by phase."""

import numpy as np
import pytest
from scenes.linkage import LINKAGE, locate, make_log

from erlif.core.errors import EncoderError
from erlif.kinematics import Encoder, encoder_notes, fold_frames

AT_SMALLEST, AT_LARGEST = LINKAGE.dead_points()


def divided(per_cycle, cycles):
    """Crank angles of a divider that gives so many pulses in a turn. [rad]"""
    return 0.3 + np.arange(int(per_cycle * cycles)) * 2 * np.pi / per_cycle


def located(crank, **encoder):
    return locate(make_log(np.degrees(LINKAGE.rocker_angle(crank))), **encoder)


def test_a_divider_that_does_not_repeat_leaves_each_frame_for_itself():
    crank = divided(50.89, 4)
    found = located(crank, zero=0.0)
    assert found.trigger.values.tolist() == list(range(crank.size))
    turns = ((crank - crank[0]) // (2 * np.pi)).astype(int)
    assert found.cycle.values.tolist() == turns.tolist()
    notes = " ".join(str(note) for note in encoder_notes(found))
    assert "50.89 triggers per cycle do not repeat" in notes


@pytest.mark.parametrize("bins", [2, 25, 50])
def test_bins_hold_frames_of_one_stroke_and_of_one_part_of_it(bins):
    crank = divided(50.89, 8)
    found = located(crank, zero=0.0, bins=bins)
    assert int(found.trigger.max()) == bins - 1
    rise = (AT_LARGEST - AT_SMALLEST) % (2 * np.pi)
    phase = (crank - AT_SMALLEST) % (2 * np.pi)
    widths = []
    for trigger in range(bins):
        members = found.trigger.values == trigger
        strokes = phase[members] < rise
        assert strokes.all() or not strokes.any()
        widths.append(np.ptp(phase[members]))
    # the share of a stroke is rounded to whole bins
    assert max(widths) < 2 * np.pi / bins * 1.1
    assert f"{bins} bins of the cycle" in str(encoder_notes(found)[0])


def test_bins_without_frames_are_left_out():
    crank = AT_SMALLEST + np.radians([5.0, 6.0, 100.0, 200.0, 365.5])
    fold = fold_frames(crank, make_log(np.arange(5.0)), Encoder(bins=10), LINKAGE)
    assert fold.trigger.tolist() == [0, 0, 1, 2, 0]
    assert fold.cycle.tolist() == [0, 0, 0, 0, 1]
    assert fold.remark == (
        "10 bins of the cycle, 1 to 3 frames in each; 7 without frames are left out"
    )


def test_a_given_number_that_does_not_repeat_is_refused_with_the_way_out():
    with pytest.raises(EncoderError, match=r"with 51 triggers per cycle .* average by bins = 50"):
        located(divided(50.5, 4), zero=0.0, triggers_per_cycle=51)


def test_strokes_are_not_mixed_where_triggers_creep_past_a_dead_point():
    """A tenth of a step in each cycle: the angles agree, the strokes do not."""
    crank = divided(11.9, 6)
    found = located(crank, zero=0.0)
    rise = (AT_LARGEST - AT_SMALLEST) % (2 * np.pi)
    outward = (crank - AT_SMALLEST) % (2 * np.pi) < rise
    for trigger in np.unique(found.trigger):
        members = outward[found.trigger.values == trigger]
        assert members.all() or not members.any()
