"""Ratio to thickness, pixel by pixel."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import with_systematics
from scenes.gap import K, P, Q, known_calibration
from scenes.gap import true_log_ratio as log_ratio_of
from scenes.pair import ratio_images

from erlif.core.flags import Flag
from erlif.show.plots import example_calibration
from erlif.thickness import FilmTables, measure_thickness


@pytest.fixture
def calibration():
    return known_calibration()


def test_known_films_are_read_back(calibration):
    film = np.linspace(0.25, 15.9, 600).reshape(20, 30)
    maps = measure_thickness(ratio_images(log_ratio_of(film), variance=1e-10), calibration)
    npt.assert_allclose(maps.thickness, film, rtol=2e-4)  # single precision of the ratio at 16 um
    npt.assert_array_equal(maps.flags, 0)


@pytest.mark.parametrize("film", [1.0, 3.0, 6.0])
def test_standard_deviation_is_the_scatter(calibration, film):
    rng = np.random.default_rng(1)
    noise = 0.005
    images = ratio_images(log_ratio_of(film) + rng.normal(0, noise, (300, 300)), noise**2)
    maps = measure_thickness(images, calibration)
    npt.assert_allclose(maps.thickness.std(), maps.thickness_std.mean(), rtol=0.02)


def test_shared_part_is_that_of_calibration_and_registration(calibration):
    film = np.full((4, 4), 5.0)
    maps = measure_thickness(ratio_images(log_ratio_of(film), shared=4e-6), calibration)
    slope = Q / np.expm1(Q * 5) - P / np.expm1(P * 5)
    step = 1e-6
    k, p, q = np.array([[K], [P], [Q]]) + step * np.eye(3)
    changed = np.log(k * p / q * (1 - np.exp(-q * 5)) / (1 - np.exp(-p * 5)))
    by_parameter = (changed - log_ratio_of(5.0)) / step
    own = by_parameter @ calibration.covariance @ by_parameter
    npt.assert_allclose(maps.thickness_std_shared, np.sqrt(own + 4e-6) / slope, rtol=1e-3)


def test_error_bars_at_the_thin_limit_are_those_of_thin_films():
    """Pixels above the limit in surroundings below it have the slope of a thin film."""
    calibration = known_calibration(valid=(1.0, 16.0), covariance=1e-8 * np.eye(3))
    rng = np.random.default_rng(3)
    film = np.clip(1.25 + 0.25 * rng.standard_normal((200, 200)), 0.3, None)
    maps = measure_thickness(ratio_images(log_ratio_of(film), variance=1e-6), calibration)
    valid = maps.flags.values == 0
    assert 0.2 < valid.mean() < 0.95
    expected = 1e-3 / (Q / np.expm1(Q * film) - P / np.expm1(P * film))
    ratio = maps.thickness_std.values[valid] / expected[valid]
    assert ratio.min() > 0.9
    assert ratio.max() < 1.1


@pytest.mark.parametrize(
    ("film", "outwards", "flag"), [(0.2, -1, Flag.BELOW_RANGE), (16.0, 1, Flag.ABOVE_RANGE)]
)
def test_the_covered_range_ends_sharply_for_a_single_pixel(calibration, film, outwards, flag):
    """Pixels whose ratio is 0.002 % within and beyond that of the last film, among valid ones.

    A third one has a ratio beyond that of any film: nothing is extrapolated.
    """
    log_ratio = np.full((30, 30), log_ratio_of(5.0))
    log_ratio[8, 8] = log_ratio_of(film) - outwards * 2e-5
    log_ratio[22, 22] = log_ratio_of(film) + outwards * 2e-5
    log_ratio[15, 15] = (np.log(K * P / Q) if outwards > 0 else np.log(K)) + outwards * 0.1
    maps = measure_thickness(ratio_images(log_ratio, variance=1e-8), calibration)
    expected = np.zeros((30, 30))
    expected[22, 22] = expected[15, 15] = flag
    npt.assert_array_equal(maps["flags"], expected)
    npt.assert_array_equal(np.isnan(maps.thickness), expected > 0)


@pytest.fixture(scope="module")
def calibration_of_tables():
    return example_calibration()


def test_tables_hold_exactly_the_log_ratios_between_their_ends(calibration_of_tables):
    """The numbers in single precision next to the limits, in double precision."""
    table, limits = calibration_of_tables.inverse, FilmTables.of(calibration_of_tables).limits
    last = table.start + table.step * (table.thickness.size - 1)
    below, above = np.float32(-np.inf), np.float32(np.inf)
    assert float(np.nextafter(limits[4], below)) < table.start <= float(limits[4])
    assert float(limits[5]) <= last + 1e-15
    assert float(np.nextafter(limits[5], above)) > last


def test_tables_give_the_film_that_made_the_ratio(calibration_of_tables):
    (start, per_step, _), (thickness, slopes), _ = FilmTables.of(calibration_of_tables)
    film = np.linspace(1.0, 10.0, 50)
    place = (calibration_of_tables.predict_log(film) - start) * per_step
    entries = np.arange(thickness.size)
    found = np.interp(place, entries, thickness)
    assert np.abs(found - film).max() < 1e-3

    # the rate is the slope of the film over the log ratio, by differences
    around = np.gradient(film, calibration_of_tables.predict_log(film))
    rate = np.interp(place, entries, slopes.view(np.float32)[::2])
    np.testing.assert_allclose(rate[1:-1], around[1:-1], rtol=0.02)


@pytest.mark.parametrize("correlation", [0.0, 1.0, -0.8])
def test_errors_that_grow_are_those_of_their_share_of_the_run(calibration_of_tables, correlation):
    """Between first and last frame as by the covariance itself, whatever grows with what stays."""
    whole = with_systematics(calibration_of_tables, temperature=0.0, wall=0.01)
    covariance = 0.01**2 * np.array([[1.0, correlation], [correlation, 1.0]])
    whole = replace(whole, systematics=whole.systematics.adding("temperature", covariance))
    assert whole.systematics.grows_apart == (correlation == 0)

    first, middle, last = (FilmTables.of(whole.at(share)) for share in (0.0, 0.5, 1.0))
    for share in (0.25, 0.5, 0.8):
        found, expected = (
            tables.films[1].view(np.float32)
            for tables in (
                first.growing_to(last, share, middle if correlation else None),
                FilmTables.of(whole.at(share)),
            )
        )
        npt.assert_allclose(found, expected, rtol=1e-5)
