"""Calibration against films whose ratio was integrated independently of the fitted model."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scipy.integrate import quad

from erlif.calibration import (
    Calibration,
    Profile,
    check_bands,
    fit_calibration,
    open_calibration,
    read_profile,
    save_calibration,
)
from erlif.core.errors import CalibrationError
from erlif.core.flags import Flag
from erlif.core.products import RatioImages

K, P, Q = 0.65, 0.40, 0.25
PITCH = 0.06
SHAPE = (64, 320)
WEDGE = 0.1 + 17.9 * np.arange(SHAPE[1]) / (SHAPE[1] - 1)


def integrated_ratio(thickness):
    """Ratio of the light of two bands by quadrature over depth, not by the closed form that is fitted."""
    one, two = (quad(lambda x, a=a: np.exp(-a * x), 0, thickness, epsabs=1e-13)[0] for a in (P, Q))
    return K * two / one


RATIO = np.array([integrated_ratio(t) for t in WEDGE])


def ratio_image(rng, *, noise=0.004, ratio=RATIO, shape=SHAPE):
    values = np.log(ratio) + rng.normal(0, noise, shape)
    dims = ("y", "x")
    return RatioImages(
        xr.Dataset(
            {
                "log_ratio": (dims, values.astype(np.float32)),
                "log_ratio_var": (dims, np.full(shape, noise**2, np.float32)),
                "log_ratio_var_fixed": (dims, np.zeros(shape, np.float32)),
                "log_ratio_var_shared": (dims, np.zeros(shape, np.float32)),
                "flags": (dims, np.zeros(shape, np.uint8)),
            }
        )
    )


def cmm_profile(rng, *, noise=0.15, step=0.1):
    x = np.arange(0, SHAPE[1] * PITCH, step)
    thickness = 0.1 + 17.9 * x / (PITCH * (SHAPE[1] - 1))
    return Profile(x, thickness + rng.normal(0, noise, x.size), np.full(x.size, max(noise, 1e-3)))


def fit(rng, **changes):
    options = {"pixel_pitch": PITCH, "bands": (580.0, 610.0), "frames": 12}
    image, profile = changes.pop("image", None), changes.pop("profile", None)
    return fit_calibration(
        ratio_image(rng) if image is None else image,
        cmm_profile(rng) if profile is None else profile,
        **options | changes,
    )


def test_exact_fixture_gives_the_parameters():
    calibration = fit(
        np.random.default_rng(1), profile=cmm_profile(np.random.default_rng(1), noise=0.0)
    )
    npt.assert_allclose(calibration.parameters, [K, P, Q], rtol=4e-3)
    npt.assert_allclose(calibration.predict(WEDGE), RATIO, rtol=3e-4)


@pytest.mark.slow
def test_uncertainties_of_parameters_and_films_cover():
    """Two hundred fixtures with a noisy CMM: 68 and 95 % of parameters, and of films read at 1, 3 and 8 um, within one and two standard
    deviations."""
    rng = np.random.default_rng(2)
    films = np.array([1.0, 3.0, 8.0])
    read = np.log([integrated_ratio(film) for film in films])
    pulls = []
    for _ in range(200):
        calibration = fit(rng)
        assert calibration.departure is None
        found = (calibration.invert(read) - films) / calibration.thickness_std(films)
        pulls.append(
            [*(calibration.parameters - [K, P, Q]) / calibration.standard_deviations, *found]
        )
    pulls = np.array(pulls)
    within = [(np.abs(pulls) < width).mean(axis=0) for width in (1, 2)]
    # 200 draws scatter by 3.3 and 1.5 % about 68.3 and 95.4 %
    assert np.all(np.abs(within[0] - 0.683) < 3 * 0.033)
    assert np.all(np.abs(within[1] - 0.954) < 3 * 0.015)
    assert np.all(np.abs(pulls.mean(axis=0)) < 4 / np.sqrt(200))


def test_reduced_chi_square_is_one_for_the_stated_noise():
    values = [fit(np.random.default_rng(seed)).reduced_chi_square for seed in range(5)]
    assert 0.8 < np.mean(values) < 1.2


def test_unknown_cmm_uncertainty_is_estimated():
    rng = np.random.default_rng(3)
    profile = cmm_profile(rng)
    calibration = fit(rng, profile=Profile(profile.position, profile.thickness, None))
    assert any("estimated from the scatter" in note for note in calibration.notes)
    npt.assert_allclose(
        calibration.parameters, [K, P, Q], atol=4 * calibration.standard_deviations.max()
    )
    truth = fit(np.random.default_rng(3))
    npt.assert_allclose(calibration.standard_deviations, truth.standard_deviations, rtol=0.3)


def test_range_ends_where_a_pixel_tells_too_little():
    """Noise s on a single pixel leaves s/slope; the range ends where that is a quarter of the thickness."""
    noise = 0.0135
    rng = np.random.default_rng(4)
    image = ratio_image(rng, noise=noise / np.sqrt(12))
    calibration = fit(rng, image=image)
    low, high = calibration.thickness_range
    assert 0 <= low < 0.3
    slope = Q / np.expm1(Q * high) - P / np.expm1(P * high)
    npt.assert_allclose(noise / slope, 0.25 * high, rtol=0.05)


def test_dim_light_leaves_a_range():
    """With a fifteenth of the light no pixel tells a quarter of its thickness, yet averages do: films of 1 to 10 um stay in."""
    noise = 0.055
    calibration = fit(
        np.random.default_rng(4),
        image=ratio_image(np.random.default_rng(4), noise=noise / np.sqrt(12)),
    )
    low, high = calibration.thickness_range
    slope = Q / np.expm1(Q * WEDGE) - P / np.expm1(P * WEDGE)
    best = (noise / slope / WEDGE).min()
    assert best > 0.25
    assert low < 1
    assert high > 9


def test_dust_and_bubbles_do_not_move_the_fit():
    rng = np.random.default_rng(5)
    image = ratio_image(rng)
    image.log_ratio.values[20:30, 100:112] += 0.5
    image.flags.values[40:50, 200:210] = Flag.NO_FILM
    image.log_ratio.values[40:50, 200:210] = np.nan
    calibration = fit(rng, image=image)
    assert np.all(np.abs(calibration.parameters - [K, P, Q]) < 4 * calibration.standard_deviations)


def test_wrong_origin_is_found_by_align_where_the_profile_has_form():
    """A wavy ramp, its profile given 0.3 mm off: the origin comes back and the error of the plain fit goes."""
    rng = np.random.default_rng(6)

    def wave(x):
        return 9 + 0.4 * (x - 9) + 2.5 * np.sin(x)

    ratio = np.array([integrated_ratio(t) for t in wave(PITCH * np.arange(SHAPE[1]))])
    position = np.arange(0, SHAPE[1] * PITCH, 0.1)
    profile = Profile(position + 0.3, wave(position), np.full(position.size, 0.01))
    image = ratio_image(rng, ratio=ratio)
    aligned = fit(rng, image=image, profile=profile, align=True)
    plain = fit(rng, image=image, profile=profile)
    error = {
        name: abs(float(c.predict_log(5.0)) - np.log(integrated_ratio(5.0)))
        for name, c in (("a", aligned), ("p", plain))
    }
    assert error["a"] < 0.1 * error["p"]
    assert aligned.pose.determined.tolist() == [True, False, True, False]
    assert abs(aligned.pose.change[0] - 0.3) < 0.015
    assert any("um along the profile" in note for note in aligned.notes)


def test_straight_wedge_says_that_it_cannot_tell_its_origin():
    calibration = fit(np.random.default_rng(6), align=True)
    assert any(
        "left as given: origin along the profile, scale, direction" in note
        for note in calibration.notes
    )
    npt.assert_array_equal(calibration.parameters, fit(np.random.default_rng(6)).parameters)


def test_turned_profile_is_laid_over_the_image():
    """A wedge that rises down the image, with the profile's x turned by 90 degrees."""
    rng = np.random.default_rng(7)
    image = ratio_image(rng, ratio=RATIO[:, None], shape=SHAPE[::-1])
    calibration = fit(rng, image=image, direction=np.pi / 2)
    assert np.all(np.abs(calibration.parameters - [K, P, Q]) < 4 * calibration.standard_deviations)


def test_surface_profile_is_used_point_by_point():
    rng = np.random.default_rng(8)
    x, y = (
        axis.ravel() for axis in np.meshgrid(np.arange(0.3, 18.9, 0.6), np.arange(0.3, 3.6, 0.6))
    )
    thickness = 0.1 + 17.9 * x / (PITCH * (SHAPE[1] - 1))
    profile = Profile(
        np.stack([x, y], axis=1), thickness + rng.normal(0, 0.1, x.size), np.full(x.size, 0.1)
    )
    calibration = fit(rng, profile=profile)
    assert np.all(np.abs(calibration.parameters - [K, P, Q]) < 4 * calibration.standard_deviations)


def test_thin_wedge_says_what_it_cannot_tell():
    rng = np.random.default_rng(9)
    thin = 0.02 * WEDGE
    ratio = np.array([integrated_ratio(t) for t in thin])
    exact = cmm_profile(rng, noise=0.0)
    profile = Profile(exact.position, 0.02 * exact.thickness, np.full(exact.thickness.size, 0.005))
    calibration = fit(rng, image=ratio_image(rng, ratio=ratio), profile=profile)
    assert any("too thin to tell p and q apart" in note for note in calibration.notes)
    slope = calibration.attenuation_camera1 - calibration.attenuation_camera2
    covariance = calibration.covariance
    std = np.sqrt(covariance[1, 1] + covariance[2, 2] - 2 * covariance[1, 2])
    assert abs(slope - (P - Q)) < 4 * std


def test_exchanged_cameras_are_recognised():
    with pytest.raises(CalibrationError, match="cameras look swapped"):
        fit(
            np.random.default_rng(10), image=ratio_image(np.random.default_rng(10), ratio=1 / RATIO)
        )


def test_partly_covering_profile_is_used_and_said():
    rng = np.random.default_rng(11)
    whole = cmm_profile(rng)
    part = Profile(whole.position[:120], whole.thickness[:120], whole.uncertainty[:120])
    calibration = fit(rng, profile=part)
    assert any("covers 6" in note for note in calibration.notes)
    assert calibration.thickness_range[1] < 12
    with pytest.raises(CalibrationError, match="at least 8 points of the profile in the image"):
        fit(rng, profile=Profile(whole.position + 18.9, whole.thickness, whole.uncertainty))


def test_inverse_undoes_the_prediction_and_leaves_the_rest():
    calibration = fit(np.random.default_rng(12))
    low, high = calibration.thickness_range
    inside = np.linspace(low + 1e-6, high - 1e-6, 30)
    npt.assert_allclose(calibration.invert(calibration.predict_log(inside)), inside, atol=1e-7)
    beyond = calibration.invert(calibration.predict_log([low - 0.01, high + 0.01]))
    assert np.isnan(beyond).all()


def test_table_of_the_inverse_agrees_with_root_finding():
    calibration = fit(np.random.default_rng(13))
    table = calibration.inverse
    last = np.interp(
        calibration.thickness_range[1], table.thickness, np.arange(table.thickness.size)
    )
    place = np.random.default_rng(0).uniform(0, last, 200)
    log_ratio = table.start + table.step * place
    interpolated = np.interp(place, np.arange(table.thickness.size), table.thickness)
    npt.assert_allclose(interpolated, calibration.invert(log_ratio), atol=2e-5)


def test_thickness_uncertainty_of_the_calibration_covers():
    """The film read at 4 um scatters over fixtures as the calibration says it does."""
    rng = np.random.default_rng(14)
    pulls = []
    for _ in range(40):
        calibration = fit(rng)
        found = calibration.invert(np.log(integrated_ratio(4.0)))
        pulls.append((found - 4.0) / calibration.thickness_std(4.0))
    assert 0.7 < np.std(pulls) < 1.35
    assert abs(np.mean(pulls)) < 4 / np.sqrt(40)


def test_file_round_trip_keeps_everything(tmp_path):
    calibration = fit(np.random.default_rng(15))
    path = save_calibration(calibration, tmp_path / "calibration.nc")
    back = open_calibration(path)
    npt.assert_array_equal(back.parameters, calibration.parameters)
    npt.assert_array_equal(back.covariance, calibration.covariance)
    assert back.thickness_range == calibration.thickness_range
    assert back.bands == calibration.bands
    assert back.notes == calibration.notes
    xr.testing.assert_equal(back.curve, calibration.curve)


def test_ratio_the_other_way_round_is_refused(tmp_path):
    dataset = (
        fit(np.random.default_rng(16)).to_dataset().assign_attrs(ratio_direction="camera1/camera2")
    )
    with pytest.raises(CalibrationError, match=r"camera1/camera2"):
        Calibration.from_dataset(dataset)


def test_other_bands_are_refused_and_exchanged_ones_recognised():
    calibration = fit(np.random.default_rng(17))
    check_bands(calibration, (580.0, 610.0))
    with pytest.raises(CalibrationError, match="560 and 610 nm"):
        check_bands(calibration, (560.0, 610.0))
    with pytest.raises(CalibrationError, match="swapped"):
        check_bands(calibration, (610.0, 580.0))


def write_profile(path, rows, header="x_mm,thickness_um,uncertainty_um"):
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_profile_out_of_order_is_sorted_and_repeats_averaged(tmp_path):
    rows = [f"{x},{x * 2.0},0.1" for x in (0, 2, 1, 3, 4, 5, 6, 7, 8)] + ["8,17.0,0.1"]
    profile = read_profile(write_profile(tmp_path / "p.csv", rows))
    npt.assert_allclose(profile.position, np.arange(9))
    npt.assert_allclose(profile.thickness[-1], 16.5)
    npt.assert_allclose(profile.uncertainty[-1], 0.1 / np.sqrt(2))
    assert len(profile.notes) == 2


@pytest.mark.parametrize(
    ("rows", "header", "message"),
    [
        (["0,1,0.1"] * 3, "x_mm,thickness_um,uncertainty_um", "at least 8 points"),
        (["0,1"] * 9, "x,t", "Expected the header"),
        (["0,1", "1,two"], "x_mm,thickness_um", "row 3, column thickness_um"),
        (
            [f"{x},1,0" for x in range(9)],
            "x_mm,thickness_um,uncertainty_um",
            "positive values of uncertainty_um",
        ),
    ],
)
def test_unusable_profile_is_refused(tmp_path, rows, header, message):
    with pytest.raises(CalibrationError, match=message):
        read_profile(write_profile(tmp_path / "p.csv", rows, header))


def test_a_line_scan_with_a_y_column_is_a_line(tmp_path):
    """A CMM writes y_mm although it ran along a line, to a few micrometres: the same calibration as without the column."""
    rng = np.random.default_rng(18)
    line, image = cmm_profile(rng), ratio_image(rng)
    rows = [
        f"{x!r},{t!r},0.15"
        for x, t in zip(line.position.tolist(), line.thickness.tolist(), strict=True)
    ]
    plain = read_profile(write_profile(tmp_path / "line.csv", rows))
    header = "x_mm,y_mm,thickness_um,uncertainty_um"
    for wander in (0.0, 0.003):
        across = (1.5 + rng.uniform(-wander, wander, len(rows))).tolist()
        listed = [row.replace(",", f",{y!r},", 1) for row, y in zip(rows, across, strict=True)]
        order = rng.permutation(len(rows))
        found = read_profile(
            write_profile(tmp_path / "scan.csv", [listed[n] for n in order], header)
        )
        npt.assert_array_equal(found.position, plain.position)
        npt.assert_array_equal(found.thickness, plain.thickness)
        assert any("a line profile along x_mm, at y_mm 1.5" in note for note in found.notes)
        npt.assert_array_equal(
            fit(rng, image=image, profile=found).parameters,
            fit(rng, image=image, profile=plain).parameters,
        )


@pytest.mark.parametrize(
    ("rows", "header"),
    [
        ([f"2.0,{y},{1 + y}" for y in range(9)], "x_mm,y_mm,thickness_um"),
        (["2.0,3.0,1.0"] * 9, "x_mm,y_mm,thickness_um"),
        (["2.0,1.0"] * 9, "x_mm,thickness_um"),
    ],
)
def test_a_profile_without_extent_along_x_is_refused(tmp_path, rows, header):
    with pytest.raises(CalibrationError, match="x_mm to change along the profile"):
        read_profile(write_profile(tmp_path / "p.csv", rows, header))


def test_a_surface_without_extent_is_refused_where_it_is_used():
    x = np.arange(0, 18.9, 0.3)
    profile = Profile(np.stack([x, np.full_like(x, 1.5)], axis=1), 0.1 + x, np.full_like(x, 0.1))
    with pytest.raises(CalibrationError, match="extent"):
        fit(np.random.default_rng(19), profile=profile)


def test_a_fixture_of_one_thickness_is_refused():
    x = np.arange(0, 18.9, 0.1)
    for seed in range(4):  # whichever way the noise lets the ratio rise
        rng = np.random.default_rng(seed)
        image = ratio_image(rng, ratio=np.full(SHAPE[1], integrated_ratio(5.0)))
        with pytest.raises(CalibrationError, match="is 5 um thick at all points"):
            fit(rng, image=image, profile=Profile(x, np.full_like(x, 5.0), np.full_like(x, 0.1)))
