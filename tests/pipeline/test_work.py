"""The parts of the way from a run to a film."""

from dataclasses import replace

import numpy.testing as npt
import pytest

import erlif
from erlif.calibration import open_calibration
from erlif.core.progress import silent
from erlif.io.files import PartialFilm
from erlif.io.ingest import open_run
from erlif.pipeline.engines.engine import Threads
from erlif.pipeline.film import MAPS, complete_film, describe_triggers, group_frames
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.plane import ObjectPlane
from erlif.pipeline.recording.prepare import prepare_run
from erlif.pipeline.recording.register import FixtureMap
from erlif.pipeline.run import measure_run


@pytest.fixture(scope="module")
def calibration(small_rig):
    return open_calibration(small_rig.fixture / "calibration.nc")


def test_the_parts_give_the_film_of_the_command(small_rig, calibration, film, tmp_path):
    run = open_run(small_rig.run)
    cycle = locate_run(run)
    frames_of = group_frames(cycle, run.pairs)
    known = FixtureMap.of(calibration, run.settings)
    bare = replace(calibration, camera_map=None)

    ready = prepare_run(run, cycle, bare, known, silent)
    grid = ObjectPlane(run.settings, run.pairs.shape).grid(len(frames_of))
    with PartialFilm(tmp_path / "film.nc", "key", grid, MAPS) as unfinished:
        results = measure_run(run, ready, frames_of, unfinished, engine=Threads(1), progress=silent)
    found, groups = complete_film(
        run, cycle, describe_triggers(run, cycle), ready, results, bare, {}
    )

    with erlif.open_film(film) as expected:
        for name in ("film_min", "film_mean_std", "valid_pixels", "film_theory"):
            npt.assert_array_equal(found[name], expected[name])
    with erlif.open_film(film, group="frames") as expected:
        npt.assert_array_equal(groups["frames"].drift_x, expected.drift_x)
