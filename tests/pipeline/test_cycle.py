"""The triggers of a run: frames of each, and the means of log and motion."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ConfigError
from erlif.io.ingest import FramePairs
from erlif.io.ingest.images import Page
from erlif.pipeline.cycle import _trigger_mean, describe_triggers, group_frames


def pairs_of(count, skipped=()):
    pages = tuple(Page(Path(f"frame_{k}.tif"), 0) for k in range(count))
    reasons = dict.fromkeys(skipped, "damaged")
    return FramePairs(Path(), (pages, pages), (64, 80), (12, 12), reasons)


def cycle_of(*triggers):
    return xr.Dataset({"trigger": ("frame", np.array(triggers))})


def test_frames_that_were_left_out_belong_to_no_trigger():
    """Trigger 1 has lost both its frames and keeps its place."""
    frames = group_frames(cycle_of(0, 1, 2, 0, 1, 2), pairs_of(6, skipped=(1, 3, 4)))
    assert frames == [[0], [], [2, 5]]


@pytest.fixture(scope="module")
def logged(two_cycles):
    """Columns of the encoder log, read as text."""
    lines = (two_cycles.run / "encoder.csv").read_text().splitlines()
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    return dict(zip(lines[0].split(","), rows.T, strict=True))


@pytest.mark.parametrize(
    ("name", "column"),
    [("joint_load", "load_N"), ("temperature", "temperature_C"), ("encoder_angle", "angle_deg")],
)
def test_triggers_of_two_cycles_have_the_means_of_the_log(cycles, logged, name, column):
    triggers = describe_triggers(*cycles)
    expected = (logged[column][:6] + logged[column][6:]) / 2
    npt.assert_allclose(triggers[name], expected)


def test_trigger_has_the_mean_of_the_frames_that_are_left(cycles, logged):
    """Frame 7 belongs to trigger 1; both frames of trigger 2 are lost, and their log remains."""
    run, cycle = cycles
    pairs = replace(run.pairs, skipped=dict.fromkeys((7, 2, 8), "damaged"))
    load = describe_triggers(replace(run, pairs=pairs), cycle)["joint_load"].values
    npt.assert_allclose(load[1], logged["load_N"][1])
    npt.assert_allclose(load[2], (logged["load_N"][2] + logged["load_N"][8]) / 2)


def test_triggers_that_do_not_repeat_have_their_times(cycles, logged):
    """Frames that are averaged over cycles have none; frames of several cycles, each for itself."""
    run, cycle = cycles
    assert "time" not in describe_triggers(run, cycle)
    each = cycle.assign(trigger=cycle.trigger.copy(data=np.arange(12)))
    npt.assert_allclose(describe_triggers(run, each).time, logged["time_s"])


def test_mean_crank_angle_passes_through_zero(cycles):
    """359 and 3 degree have a mean of 1 degree."""
    run, cycle = cycles
    angle = cycle.crank_angle.values.copy()
    angle[[0, 6]] = 359.0, 3.0
    triggers = describe_triggers(run, cycle.assign(crank_angle=cycle.crank_angle.copy(data=angle)))
    npt.assert_allclose(triggers.crank_angle[0], 1.0)


def test_load_of_the_settings_serves_where_the_log_has_none(cycles):
    run, cycle = cycles
    log = run.log.drop_vars("joint_load")
    npt.assert_allclose(describe_triggers(replace(run, log=log), cycle)["joint_load"], 222.411)
    joint = run.settings.joint.model_copy(update={"load": None})
    settings = run.settings.model_copy(update={"joint": joint})
    with pytest.raises(ConfigError, match="no load_N and"):
        describe_triggers(replace(run, log=log, settings=settings), cycle)


@pytest.mark.parametrize("mounted", [{"mounted_on": "crank"}, {}])
def test_the_mean_angle_of_a_turning_encoder_passes_over_zero(mounted):
    """350, 359 and 6 degrees, the last one as 726 two turns later."""
    angles = xr.DataArray([350.0, 359.0, 726.0], dims="frame", name="encoder_angle")
    assert _trigger_mean(angles.assign_attrs(mounted), [0, 1, 2]) == pytest.approx(358 + 1 / 3)
    assert _trigger_mean(angles.assign_attrs(mounted_on="rocker"), [0, 1]) == 354.5
