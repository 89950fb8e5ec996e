"""What departs from the reabsorption model: found where it is there, and only there."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes import film as film_scene
from scenes.fixture import (
    FILMS,
    WEDGE,
    assert_covers,
    calibrate,
    calibrate_wedge,
    image,
    log_ratio,
    wedge_profile,
)

from erlif.calibration import Calibration, Profile, open_calibration, save_calibration
from erlif.calibration.storage import calibration_of, record_calibration
from erlif.files import open_film
from erlif.plots import ratio_residuals
from erlif.report import describe_calibration
from erlif.rig import dyes

BACKGROUND = 0.01
"""Light that no dye absorbs, added to camera 2: the ratio's logarithm departs from the model by up to 0.3 %."""
GRID = np.linspace(0.3, 12, 300)


def through_broad_filters(thickness, width):
    """Logarithm of the ratio of the rig's invented dyes behind Gaussian filters of a full width at half maximum, by quadrature."""
    light = []
    for band in dyes.BANDS:
        wavelength = np.arange(band - 60, band + 60.1, 0.1)
        weight = dyes.emission(wavelength) * np.exp(
            -4 * np.log(2) * ((wavelength - band) / width) ** 2
        )
        depth = np.multiply.outer(
            thickness, dyes.absorption(np.asarray(dyes.LASER)) + dyes.absorption(wavelength)
        )
        light.append(thickness * ((-np.expm1(-depth) / depth) @ weight))
    return np.log(light[1] / light[0])


@pytest.fixture(scope="module")
def departing():
    return calibrate_wedge(np.random.default_rng(1), noise=0.001, background=BACKGROUND)


def largest_error(calibration, true):
    """Of the ratio over 0.3 to 12 um. [%]"""
    return 100 * np.abs(calibration.predict_log(GRID) - true).max()


def model_alone(calibration):
    return Calibration.from_dataset(
        calibration.to_dataset()
        .drop_vars(
            [
                name
                for name in calibration.to_dataset().variables
                if str(name).startswith("departure")
            ]
        )
        .assign_attrs(calibration.attributes)
    )


def test_background_light_is_followed_to_a_twentieth_of_a_per_cent(departing):
    true = log_ratio(GRID, background=BACKGROUND)
    assert departing.departure is not None
    assert largest_error(model_alone(departing), true) > 0.2
    assert largest_error(departing, true) < 0.05
    assert any("departs from the reabsorption model by" in note for note in departing.notes)


@pytest.mark.parametrize("width", [30, 50])
def test_broad_filters_are_followed_to_a_twentieth_of_a_per_cent(width):
    rng = np.random.default_rng(2)
    ratios = image(rng, through_broad_filters(WEDGE, width))
    calibration = calibrate(ratios, wedge_profile(rng, noise=0.001))
    true = through_broad_filters(GRID, width)
    assert largest_error(model_alone(calibration), true) > 0.05
    assert largest_error(calibration, true) < 0.05


def test_filters_of_the_rig_need_no_departure():
    """10 nm wide, they leave less than 0.05 % once K, p and q are fitted, so model and data agree."""
    rng = np.random.default_rng(3)
    one, two = (dyes.tabulate_signal(band) for band in dyes.BANDS)
    calibration = calibrate(
        image(rng, np.log(two(WEDGE) / one(WEDGE))), wedge_profile(rng, noise=0.001)
    )
    assert calibration.departure is None
    assert largest_error(calibration, np.log(two(GRID) / one(GRID))) < 0.05


def test_noise_alone_never_calls_for_a_departure_or_speaks_of_structure():
    """In sixty fixtures; the criterion's chance is below 1e-3 in each."""
    rng = np.random.default_rng(4)
    for _ in range(60):
        calibration = calibrate_wedge(rng)
        assert calibration.departure is None
        assert not any("structure" in note or "err alike" in note for note in calibration.notes)


def test_curve_rises_and_its_derivatives_are_those_of_the_curve(departing):
    low, high = departing.thickness_range
    film = np.linspace(low + 0.01, high - 0.01, 200)
    step = 1e-5
    numerical = (departing.predict_log(film + step) - departing.predict_log(film - step)) / (
        2 * step
    )
    npt.assert_allclose(departing.slope(film), numerical, rtol=1e-5, atol=1e-8)
    assert np.all(departing.slope(np.linspace(0, 30, 500)) > 0)
    assert departing.gradient(film).shape == (len(departing.full_covariance), film.size)
    npt.assert_array_equal(departing.full_covariance[:3, :3], departing.covariance)
    npt.assert_allclose(departing.invert(departing.predict_log(film)), film, atol=1e-7)
    table = departing.inverse
    place = (departing.predict_log(film) - table.start) / table.step
    npt.assert_allclose(
        np.interp(place, np.arange(table.thickness.size), table.thickness), film, atol=2e-5
    )


def test_departure_survives_the_file_and_older_files_open(departing, tmp_path):
    path = save_calibration(departing, tmp_path / "calibration.nc")
    back = open_calibration(path)
    npt.assert_array_equal(back.predict_log(GRID), departing.predict_log(GRID))
    npt.assert_array_equal(back.full_covariance, departing.full_covariance)
    assert model_alone(departing).departure is None


def test_pose_survives_the_file(tmp_path):
    rng = np.random.default_rng(5)
    calibration = calibrate(image(rng, log_ratio(WEDGE)), wedge_profile(rng), align=True)
    back = open_calibration(save_calibration(calibration, tmp_path / "calibration.nc"))
    assert back.pose.pose == calibration.pose.pose
    npt.assert_array_equal(back.pose.covariance, calibration.pose.covariance)


def test_departure_is_said_and_drawn(departing):
    assert "followed by a spline" in describe_calibration(departing)
    artists = ratio_residuals(departing)
    dashed = next(
        artist for artist in artists if getattr(artist, "get_label", str)() == "model alone"
    )
    drawn = np.interp(6.0, *dashed.get_data())
    expected = 100 * np.expm1(
        model_alone(departing).predict_log(6.0) - log_ratio(6.0, background=BACKGROUND)
    )
    assert abs(drawn - expected) < 0.05


def test_smaller_departure_is_said_but_not_used():
    """Background light at which the criterion does not insist, but chance would seldom leave such residuals."""
    rng = np.random.default_rng(6)
    said = [calibrate_wedge(rng, noise=0.15, background=0.003) for _ in range(15)]
    assert any(
        calibration.departure is None
        and any("residuals have structure" in note for note in calibration.notes)
        for calibration in said
    )


def test_falling_ratio_is_never_the_curve():
    """A ratio that falls between 14 and 17 um: whatever is used rises over all the fixture covers, and the notes say so."""
    rng = np.random.default_rng(7)
    ratios = image(rng, log_ratio(WEDGE) + 0.01 * np.sin(WEDGE / 2))
    calibration = calibrate(ratios, wedge_profile(rng, noise=0.02))
    assert np.all(calibration.slope(np.linspace(0, 18, 1000)) > 0)
    assert any(
        "the ratio would fall" in note or "lets the ratio fall" in note
        for note in calibration.notes
    )


def test_correlated_errors_of_the_profile_are_said_and_widen_the_error_bars():
    rng = np.random.default_rng(8)
    straight = wedge_profile(rng, noise=0.1)
    wavy = Profile(
        straight.position,
        straight.thickness + 0.15 * np.sin(4.2 * straight.position),
        straight.uncertainty,
    )
    ratios = image(rng, log_ratio(WEDGE))
    before, after = (calibrate(ratios, profile) for profile in (straight, wavy))
    assert any("neighbouring points along the profile err alike" in note for note in after.notes)
    scatter = np.sqrt(after.reduced_chi_square)
    assert np.all(after.standard_deviations > 1.15 * scatter * before.standard_deviations)


def test_curve_holds_residuals_of_the_whole_curve(departing):
    curve = departing.curve
    fitted = departing.predict(curve.curve_thickness.values)
    npt.assert_allclose(curve.curve_ratio.values - curve.curve_residual.values, fitted, rtol=1e-12)
    assert isinstance(curve, xr.Dataset)
    assert {"curve_x", "curve_ratio_std"} <= set(curve.variables)


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.02, 0.08])
def test_films_read_with_a_departure_cover(noise):
    rng = np.random.default_rng(9)
    read = log_ratio(FILMS, background=BACKGROUND)
    pulls = []
    for _ in range(70):
        calibration = calibrate_wedge(rng, noise=noise, background=BACKGROUND)
        assert calibration.departure is not None
        pulls.append((calibration.invert(read) - FILMS) / calibration.thickness_std(FILMS))
    assert_covers(pulls)


def test_film_keeps_the_whole_curve_it_was_read_with(departing, tmp_path):
    """The figures of a film use its calibration again: departure and covered range must come back from its attributes."""
    with open_film(film_scene.make_film(tmp_path)) as film:
        film.attrs["calibration"] = record_calibration(departing)
        again = calibration_of(film)
    films = np.linspace(*departing.thickness_range, 50)
    npt.assert_array_equal(again.predict_log(films), departing.predict_log(films))
    npt.assert_allclose(again.thickness_std(films), departing.thickness_std(films), rtol=1e-12)
    assert again.covered_range == departing.covered_range
