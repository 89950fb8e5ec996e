"""Standard deviation of a planned pixel, against propagation, integration and drawn photons."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.io.settings.planning import ReferencesOfPlan
from erlif.planning import (
    WantedFilm,
    calibrated_range,
    frames_needed,
    log_ratio,
    log_ratio_variance,
    measurable_range,
    signal,
    thickness_std,
)
from erlif.planning.precision import INTERPOLATION, dimmed_to_full_scale

FILMS = np.array([1.0, 4.0, 10.0])


def test_interpolation_averages_as_the_cardinal_spline_does():
    """Parseval: the mean over all sub-pixel positions is the integral of its transfer squared."""
    frequency = np.linspace(-60, 60, 400_001)
    transfer = np.sinc(frequency) ** 4 / ((2 + np.cos(2 * np.pi * frequency)) / 3)
    npt.assert_allclose(np.trapezoid(transfer**2, frequency) ** 2, INTERPOLATION, rtol=1e-6)


def test_variance_is_that_of_drawn_photons(design):
    rng = np.random.default_rng(5)
    draws = 200_000
    logarithms = []
    for number, camera in enumerate(design.cameras, start=1):
        electrons = rng.poisson(signal(design, number, 5.0), draws)
        counts = np.rint((electrons + rng.normal(0, camera.read_noise, draws)) / camera.gain)
        logarithms.append(np.log(counts))
    new, _ = log_ratio_variance(design, 5.0, average=2)
    assert np.var(logarithms[1] - logarithms[0]) == pytest.approx(4 * new, rel=0.01)


def test_light_that_falls_off_is_averaged_over_a_square_field(design):
    """The means of 1/light and 1/light^2 over a Gaussian beam, by summation."""
    reading = 81 + 4.4**2 / 12
    side = (np.arange(400) + 0.5) / 400
    light = 0.3 ** ((side**2 + side[:, None] ** 2) / 2)
    darker, _ = log_ratio_variance(replace(design, corner=0.3), 5.0)
    electrons = [signal(design, number, 5.0) * light for number in (1, 2)]
    expected = [np.mean((each + reading) / each**2) for each in electrons]
    npt.assert_allclose(darker, expected[0] + INTERPOLATION * expected[1], rtol=1e-5)


def test_pages_of_flats_are_a_part_that_frames_do_not_reduce(design):
    few = replace(design, references=ReferencesOfPlan(flat_pages=4))
    _, fixed = log_ratio_variance(few, 5.0)
    pages = 4 * 0.5 * design.cameras[0].full_scale
    reading = 81 + 4.4**2 / 12
    expected = sum(
        share * (1 / pages + reading / 8 / signal(few, number, 5.0) ** 2)
        for number, share in ((1, 1.0), (2, INTERPOLATION))
    )
    npt.assert_allclose(fixed, expected)
    many = thickness_std(few, 5.0, frames=10**9)
    new, _ = log_ratio_variance(few, 5.0)
    npt.assert_allclose(many / thickness_std(few, 5.0), np.sqrt(fixed / (new + fixed)), rtol=1e-6)


def test_frames_needed_are_enough_and_one_fewer_is_not(design):
    wanted = 0.1 * FILMS
    needed = frames_needed(design, FILMS, wanted)
    for film, aim, count in zip(FILMS, wanted, needed, strict=True):
        assert thickness_std(design, film, frames=int(count)) <= aim
        if count > 1:
            assert thickness_std(design, film, frames=int(count) - 1) > aim


def test_range_of_the_documented_rig(design):
    """docs/uncertainty.md: 0.9 to 12.5 um at full light, 1.3 to 10.5 at 3300, 2.0 to 8.2 at 1100,
    found with the virtual rig whose beam is darker beside its middle."""
    film = WantedFilm(1.0, 10.0, (0.1, 18.0))
    for energy, low, high in ((1.0, 0.9, 12.5), (0.3, 1.3, 10.5), (0.1, 2.0, 8.2)):
        found = measurable_range(replace(design, energy=energy), film)
        npt.assert_allclose(found, (low, high), rtol=0.15)


def test_ends_of_the_range_are_two_standard_deviations_from_the_fixture(design):
    film = WantedFilm(1.0, 10.0, (0.1, 18.0), frames=4)
    ends = measurable_range(design, film)
    for end, fixture in zip(ends, film.covered, strict=True):
        new, fixed = log_ratio_variance(design, end)
        away = abs(log_ratio(design, end) - log_ratio(design, fixture))
        npt.assert_allclose(away / np.sqrt(new / 4 + fixed), 2.0, rtol=1e-3)


def test_calibration_ends_where_a_quarter_of_the_film_is_noise(design):
    _, high = calibrated_range(design, WantedFilm(1.0, 10.0, (0.1, 40.0)))
    npt.assert_allclose(thickness_std(design, high) / high, 0.25, rtol=1e-4)


def test_a_saturated_camera_ends_the_range_and_no_film_is_measurable_in_the_dark(design):
    bright, film = replace(design, energy=2.0), WantedFilm(1.0, 10.0, (0.1, 18.0))
    _, high = measurable_range(bright, film)
    largest = max(float(signal(bright, number, high)) for number in (1, 2))
    npt.assert_allclose(largest, design.cameras[0].full_scale, rtol=1e-4)
    assert np.isnan(measurable_range(replace(design, energy=1e-3), film)).all()

    # no number of frames measures a film that saturates a camera
    films = np.array([1.0, 30.0])
    light = np.array([signal(bright, number, films) for number in (1, 2)])
    assert (light.max(axis=0) > design.cameras[0].full_scale).tolist() == [False, True]
    assert np.isinf(frames_needed(bright, films, 10 * films)).tolist() == [False, True]


def test_pulse_energy_is_lowered_to_the_wanted_fill_and_never_raised(design):
    dimmed = dimmed_to_full_scale(design, 50.0, 0.3)
    largest = max(float(signal(dimmed, number, 50.0)) for number in (1, 2))
    npt.assert_allclose(largest, 0.3 * design.cameras[0].full_scale)
    assert dimmed_to_full_scale(design, 50.0, 1.0).energy == 1.0
