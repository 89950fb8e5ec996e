"""The curve of a calibration, on parameters that are known exactly."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.fixture import FILMS, K, P, Q, find_films, log_ratio

from erlif.core.notes import Level, Note
from erlif.show.plots import example_calibration


def test_prediction_is_the_integrated_ratio(exact):
    npt.assert_allclose(exact.predict_log(FILMS), log_ratio(FILMS), rtol=1e-12)
    npt.assert_allclose(exact.predict(FILMS), np.exp(log_ratio(FILMS)), rtol=1e-12)
    npt.assert_allclose(exact.predict(1e-9), K, rtol=1e-8)
    npt.assert_allclose(exact.predict(1e3), K * P / Q, rtol=1e-12)


@pytest.mark.parametrize("name", ["exact", "departing"])
def test_slope_is_the_derivative(name, request):
    calibration = request.getfixturevalue(name)
    film, step = np.linspace(0.4, 13.9, 60), 1e-5
    numerical = (calibration.predict_log(film + step) - calibration.predict_log(film - step)) / (
        2 * step
    )
    npt.assert_allclose(calibration.slope(film), numerical, rtol=1e-6, atol=1e-9)


def test_gradient_is_the_derivative_by_every_parameter(departing):
    film, step = np.linspace(0.4, 13.9, 20), 1e-6
    names = ["ratio_at_zero", "attenuation_camera1", "attenuation_camera2"]
    changed = [
        [replace(departing, **{name: getattr(departing, name) + sign * step}) for sign in (1, -1)]
        for name in names
    ]
    spline = departing.departure
    for unit in np.eye(5):
        splines = [
            replace(spline, coefficients=spline.coefficients + sign * step * unit)
            for sign in (1, -1)
        ]
        changed.append([replace(departing, departure=each) for each in splines])
    numerical = [
        (above.predict_log(film) - below.predict_log(film)) / (2 * step) for above, below in changed
    ]
    npt.assert_allclose(departing.gradient(film), numerical, atol=1e-8)
    npt.assert_allclose(departing.model.gradient(film), numerical[:3], atol=1e-8)


def test_error_of_a_film_is_that_of_drawn_parameters(departing):
    """Films read with 4000 draws of all parameters scatter as stated, to 4 of their 1.1 %."""
    rng = np.random.default_rng(1)
    draws = rng.multivariate_normal(np.zeros(8), departing.full_covariance, 4000)
    npt.assert_array_equal(departing.standard_deviations, [2e-3, 2e-3, 1e-3])
    shifts = draws @ departing.gradient(FILMS)
    npt.assert_allclose(shifts.std(axis=0), departing.log_ratio_std(FILMS), rtol=0.045)
    npt.assert_allclose(
        departing.thickness_std(FILMS), departing.log_ratio_std(FILMS) / departing.slope(FILMS)
    )


def test_a_calibration_shows_its_parameters_with_their_errors():
    calibration = replace(
        example_calibration(),
        fixture="<script>",
        notes=(Note(Level.WARNING, "profile", "<b>too short"),),
    )
    text, page = repr(calibration), calibration._repr_html_()
    for shown in ("0.66000 ± 0.00100", "0.24500 ± 0.00100 1/um", "0.30 to 16.00 um", "580 nm"):
        assert shown in text
        assert shown in page
    assert "warning: profile: <b>too short" in text
    assert page.count("<circle") == 20
    assert "<script" not in page
    assert "<b>" not in page


@pytest.mark.parametrize("name", ["exact", "departing"])
def test_table_of_the_inverse_agrees_with_root_finding(name, request):
    calibration = request.getfixturevalue(name)
    table = calibration.inverse
    entries = np.arange(table.thickness.size)
    first, last = np.interp(calibration.thickness_range, table.thickness, entries)
    place = np.random.default_rng(0).uniform(first, last, 200)
    values = table.start + table.step * place
    film = find_films(calibration, values)
    npt.assert_allclose(calibration.predict_log(film), values, atol=1e-9)
    low, high = calibration.thickness_range
    beyond = calibration.predict_log([[low - 0.01], [high + 0.01]])
    npt.assert_array_equal(find_films(calibration, beyond), [[np.nan], [np.nan]])
    npt.assert_allclose(np.interp(place, entries, table.thickness), film, atol=2e-5)
    npt.assert_allclose(
        np.interp(place, entries, table.per_log_ratio), 1 / calibration.slope(film), rtol=1e-4
    )
    npt.assert_allclose(
        np.interp(place, entries, table.calibration_std), calibration.thickness_std(film), rtol=1e-3
    )


def test_table_covers_the_fixture_and_not_the_calibrated_range_alone(exact):
    assert exact.covered_range == (0.3, 17.0)
    npt.assert_allclose(exact.inverse.thickness[[0, -1]], [0.3, 17.0])
    assert replace(exact, curve=xr.Dataset()).covered_range == (0.3, 14.0)
