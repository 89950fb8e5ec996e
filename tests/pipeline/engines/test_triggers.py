"""Triggers to maps and results: order, resumption, progress, single frames and none."""

import pickle
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.results import make_result

from erlif.calibration import RunCurve
from erlif.core.flags import Flag
from erlif.core.progress import silent
from erlif.io.files import PartialFilm
from erlif.pipeline.engines.engine import Threads
from erlif.pipeline.engines.triggers import MAPS, TriggerTask, run_triggers
from erlif.pipeline.plane import ObjectPlane

FRAMES = [[0, 3], [1, 4], [2, 5]]


def begin(directory, triggers=3, name="film.nc"):
    """A film of this many triggers in the making."""
    grid = xr.Dataset(
        coords={"trigger": np.arange(triggers), "y": np.arange(4.0), "x": np.arange(6.0)}
    )
    return PartialFilm(directory / name, "key", grid, MAPS)


def compute(frames):
    """Maps that hold the number of the first frame."""
    image = np.full((4, 6), float(frames[0]), np.float32)
    names = ("thickness", "thickness_std", "thickness_std_shared")
    maps = dict.fromkeys(names, image) | {"flags": np.zeros((4, 6), np.uint16)}
    return maps, make_result(*frames)


def test_finished_triggers_are_not_computed_again(tmp_path):
    done, steps = [], []

    def fail_at_the_third(frames):
        done.append(frames[0])
        if frames[0] == 2:
            raise KeyboardInterrupt
        return compute(frames)

    with begin(tmp_path) as unfinished, pytest.raises(KeyboardInterrupt):
        run_triggers(fail_at_the_third, FRAMES, unfinished, engine=Threads(1), progress=silent)
    assert done == [0, 1, 2]

    with begin(tmp_path) as unfinished:
        results = run_triggers(
            compute, FRAMES, unfinished, engine=Threads(), progress=lambda *step: steps.append(step)
        )
    assert steps == [("film", 3, 3)]
    assert len(results) == 3


# the task of the small rig


def task_of(run, chain, calibration):
    plane = ObjectPlane(run.settings, run.pairs.shape)
    return TriggerTask(chain, RunCurve.of(calibration), plane, frozenset())


@pytest.fixture(scope="module")
def task(run, prepared, calibration):
    return task_of(run, prepared.chain, calibration)


def test_trigger_without_frames_is_outside_the_overlap(task):
    maps, result = task([])
    assert (maps["flags"] == Flag.OUTSIDE_OVERLAP).all()
    assert np.isnan(maps["thickness"]).all()
    assert np.isnan([result.statistics.mean.value, result.statistics.gap.minimum.value]).all()
    assert result.frames == ()


def test_smoothing_changes_the_maps_and_not_the_statistics(task):
    settings = task.plane.settings
    smoothed = settings.thickness.model_copy(update={"smoothing": 3})
    settings = settings.model_copy(update={"thickness": smoothed})
    smooth = replace(task, plane=replace(task.plane, settings=settings))
    raw_maps, raw = task([2])
    maps, result = smooth([2])
    assert result.to_arrays().keys() == raw.to_arrays().keys()
    for name in result.to_arrays().keys() - {"pixels"}:
        npt.assert_array_equal(result.to_arrays()[name], raw.to_arrays()[name])
    valid = int((maps["flags"] == 0).sum())
    assert result.pixels[0] == valid > raw.pixels[0]  # smoothing widens the measurable range
    steps = [np.nanstd(np.diff(one["thickness"], axis=1)) for one in (raw_maps, maps)]
    assert steps[1] < 0.7 * steps[0]


def test_film_needs_the_tables_of_the_references_alone(run, prepared, calibration, task):
    chain = pickle.loads(pickle.dumps(prepared.chain.tabulated()))  # as a worker gets it
    assert not {"y", "x"} & chain.references.sizes.keys()
    whole, _ = task([2])
    whole = {name: image.copy() for name, image in whole.items()}
    maps, _ = task_of(run, chain, calibration)([2])
    for name, image in whole.items():
        npt.assert_array_equal(maps[name], image)
