"""A pair while the run goes on: its film against that of the finished run and the truth."""

import numpy as np
import pytest

import erlif
from erlif.io.ingest.arrivals import Arrival
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.watch.live import LiveFilm, measure_counts, run_of
from erlif.trend import GapShape


@pytest.fixture(scope="module")
def live(run):
    so_far = run_of(run.directory, run.settings, run.pairs)
    return run, LiveFilm.prepare(so_far, *find_calibration(run, None))


def measure(run, film, frame):
    pages = run.pairs.pages[0][frame], run.pairs.pages[1][frame]
    return film.measure(run.pairs, frame, Arrival(frame, pages, 12.5))


def test_a_pair_has_the_film_of_the_finished_run_within_its_error(live, film):
    run, prepared = live
    with erlif.open_film(film) as finished:
        for frame in range(6):
            pair, shown, gaps = measure(run, prepared, frame)
            std = float(finished.film_min_std[frame])
            assert abs(pair.film_mean - float(finished.film_mean[frame])) < std
            minimum, own = gaps.films[GapShape(finished.attrs["contact"])]
            assert abs(minimum - float(finished.film_min[frame])) < std
            assert own == pytest.approx(std, rel=0.5)
            assert pair.time == 12.5
            assert shown.thickness.shape == (96, 128)
            np.testing.assert_array_equal(np.isnan(shown.thickness), shown.flags != 0)


def test_a_pair_has_the_film_of_the_rig(live, small_rig):
    run, prepared = live
    pair, shown, _ = measure(run, prepared, 3)
    true = small_rig.truth.film.values[3]
    good = (shown.flags == 0) & (true > 1) & (true < 10)
    assert good.mean() > 0.5
    assert np.median(shown.thickness[good] - true[good]) == pytest.approx(0, abs=0.05)
    assert pair.valid == pytest.approx((shown.flags == 0).mean())


def test_light_and_saturation_are_those_of_the_counts(live):
    run, prepared = live
    pair, *_ = measure(run, prepared, 0)
    assert 100 < pair.light[0] < 4095
    assert pair.saturated == (0.0, 0.0)
    half = np.full((8, 8), 4095, np.uint16)
    half[:, :4] = 0
    assert measure_counts((half, half), (4095, 65535)) == ((2047.5, 2047.5), (0.5, 0.0))
