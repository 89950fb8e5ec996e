"""Galling that only the other stages show."""

import numpy as np
import pytest

from erlif.joint.endurance import StageFriction, analyse_endurance, describe_test
from erlif.joint.endurance.levels import find_level_rises, note_level_rises
from erlif.joint.rig import EnduranceRig, simulate_endurance
from tests.joint.endurance.conftest import as_read

QUIET = EnduranceRig(interval=4.0, stage_duration=400.0, galling_stage=None)
LAST_STEP = 2750.0  # s, while the load of the last of six stages is applied


def stages_of(*levels, running_in=0.02, duration=600.0):
    passed = np.arange(0.0, duration, 2.0)
    decay = running_in * np.exp(-passed / 80)
    return [StageFriction(700.0 * k + passed, one + decay) for k, one in enumerate(levels)]


def analysed(factor):
    """A test whose torque is multiplied by a factor of the time."""
    log, _ = simulate_endurance(QUIET, rng=np.random.default_rng(3))
    read = as_read(log)
    read["arm_force"] = read.arm_force * factor(read.time.values)
    return analyse_endurance(read, pin_radius=QUIET.pin_radius, arm=QUIET.arm)


def test_friction_that_rises_in_a_step_of_load_is_no_survivor():
    result = analysed(lambda time: np.where(time > LAST_STEP, 1.75, 1.0))
    assert result.whole[-1].start > LAST_STEP > result.whole[-2].end
    assert result.onset is None
    assert (result.failure.decided, result.failure.failed) == (False, False)
    assert result.failure.load == result.whole[-2].load
    text = "\n".join(describe_test(result))
    assert "warning: stage 6: friction of" in text
    assert "load survived" not in text
    assert "no galling" not in text

    slow = analysed(lambda time: 1 + 0.45 * np.clip((time - 2900) / 200, 0, 1))
    assert (slow.onset, slow.failure.decided) == (None, False)

    ordinary = analysed(np.ones_like)
    assert (ordinary.failure.decided, ordinary.notes) == (True, ())
    assert "load survived" in "\n".join(describe_test(ordinary))


@pytest.mark.parametrize(
    ("levels", "stage", "recovered"),
    [
        ((0.133, 0.132, 0.133, 0.193), 3, None),
        ((0.133, 0.193, 0.191, 0.195), 1, None),
        ((0.13, 0.13, 0.19, 0.13, 0.13), 2, 3),
    ],
)
def test_the_stage_of_the_rise_is_named_and_where_it_recovers(levels, stage, recovered):
    (rise,) = find_level_rises(stages_of(*levels))
    assert (rise.stage, rise.recovered) == (stage, recovered)
    assert levels[stage] == pytest.approx(rise.level, abs=0.001)
    (note,) = note_level_rises([rise], range(1, 6))
    assert f"{100 * (rise.level / rise.before - 1):.0f} % above stage {rise.stage}" in str(note)
    assert note.level == ("warning" if recovered is None else "note")


def test_a_slow_rise_in_the_first_stage_is_found():
    first, *others = stages_of(0.19, 0.19, 0.19)
    slow = np.interp(first.time, [250, 450], [-0.06, 0.0])
    (rise,) = find_level_rises([StageFriction(first.time, first.friction + slow), *others])
    assert (rise.stage, rise.recovered) == (0, None)


def test_drift_steps_with_the_load_and_running_in_are_ordinary():
    """Friction that rises by 0.03 with each load, and a last stage that ends in its running-in."""
    assert find_level_rises(stages_of(*(0.12 + 0.03 * np.arange(5)))) == ()
    *others, last = stages_of(0.13, 0.13, 0.13, running_in=0.06)
    short = StageFriction(last.time[:20], last.friction[:20])
    assert find_level_rises([*others, short]) == ()
