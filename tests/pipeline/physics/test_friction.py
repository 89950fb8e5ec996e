"""Friction of the film of a run: the true one of the virtual rig, and what a logged torque adds."""

import csv

import numpy as np
import numpy.testing as npt
import pytest
from scenes.friction import true_friction
from scenes.measured import statistics_of

from conftest import Laboratory
from erlif.rig import RigSettings

RIG = RigSettings(
    width=128, height=96, spacing=3.0, film="reynolds", fixture_frames=6, bubbles=0, tilt=0.0
)
BOUNDARY = 0.04  # N m of the log that no film carries


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """A rig whose log has the torque of the true film and a known part beside it."""
    lab = Laboratory.simulated(tmp_path_factory.mktemp("friction"), seed=5, rig=RIG)
    torque, *_ = true_friction(lab.truth, RIG)
    log = lab.run / "encoder.csv"
    header, *rows = csv.reader(log.read_text(encoding="utf-8").splitlines())
    sense = np.sign(lab.truth.rocker_speed.values)
    logged = sense * (torque + BOUNDARY)
    rows = [[*row, f"{one:.6f}"] for row, one in zip(rows, logged, strict=True)]
    with log.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([[*header, "torque_Nm"], *rows])
    return lab


@pytest.fixture(scope="module")
def film(lab):
    return statistics_of(lab.run, theory=True)


@pytest.mark.slow
def test_friction_is_that_of_the_true_film(lab, film):
    torque, _, _ = true_friction(lab.truth, RIG)
    off = film.friction_torque.values - torque
    assert (np.abs(off) < 2 * film.friction_torque_std.values).mean() >= 0.95
    assert np.abs(off / torque).max() < 0.01
    assert not film.friction_void_share.values.any()
    work = film.friction_torque.values * np.abs(film.rocker_speed.values)
    npt.assert_allclose(film.friction_power, work, rtol=1e-4)
    assert "viscosity_std" in film.attrs["notes"]


@pytest.mark.slow
def test_shear_of_the_region_is_known_as_its_mean_film_is(lab, film):
    """The calibration, which all triggers share, is the error of both, with opposite signs."""
    _, drag, mean = true_friction(lab.truth, RIG)
    seen = film.share_beyond_range.values < 0.001
    assert 6 < seen.sum() < seen.size
    off, off_mean = film.film_drag.values / drag - 1, film.film_mean.values / mean - 1
    assert np.abs(off)[seen].max() < 0.02
    assert np.abs(off + off_mean)[seen].max() < 0.005
    std, std_mean = (film[f"{name}_std"] / film[name] for name in ("film_drag", "film_mean"))
    npt.assert_allclose(std[seen], std_mean[seen], rtol=0.3)
    # where part of the film is beyond the range, the gap gives the shear there
    far = film.share_beyond_range.values > 0.05
    pull = off[far] / std.values[far]  # of one rig, whose triggers share most of the error
    assert np.sqrt((pull**2).mean()) < 2
    assert np.abs(off)[far].max() < 0.01


@pytest.mark.slow
def test_logged_torque_less_that_of_the_film_is_the_rest(film):
    off = film.torque_not_film.values - BOUNDARY
    assert (np.abs(off) < 2 * film.friction_torque_std.values).mean() >= 0.9
    assert abs(np.mean(off)) < 0.1 * BOUNDARY
    assert film.torque_logged.attrs["units"] == "N m"


@pytest.mark.slow
def test_error_of_the_viscosity_counts_and_no_oil_has_no_friction(lab, film):
    """A stated error of the viscosity widens friction; a film without [oil] has none."""
    oil = 'viscosity = "0.12 Pa s"'
    run = lab.copy_run("wide", (oil, f'{oil}\nviscosity_std = "0.012 Pa s"'))
    wide = statistics_of(run, theory=True)
    couette = film.friction_torque - film.friction_torque_pressure
    expected = np.hypot(film.friction_torque_std, 0.1 * couette)
    npt.assert_allclose(wide.friction_torque_std, expected, rtol=1e-3)
    expected = np.hypot(film.film_drag_std, 0.1 * film.film_drag)
    npt.assert_allclose(wide.film_drag_std, expected, rtol=1e-3)

    text = (lab.run / "run.toml").read_text(encoding="utf-8")
    start = text.index("[oil]")
    table = text[start : text.index("\n[", start)]
    bare = statistics_of(lab.copy_run("bare", (table, "")), theory=True)
    added = ("friction", "film_drag", "hersey", "torque_not_film")
    assert not [name for name in bare if name.startswith(added)]
    npt.assert_array_equal(bare.film_mean, film.film_mean)
