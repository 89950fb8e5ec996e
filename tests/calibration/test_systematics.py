"""Errors that frames do not show: their effect on the film against the model that is disturbed."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import (
    WEDGE,
    K,
    P,
    Q,
    calibrate,
    image,
    log_ratio,
    wedge_profile,
    with_systematics,
)

from erlif.calibration import (
    NO_SYSTEMATICS,
    RunCurve,
    Systematics,
    calibration_of,
    open_calibration,
    record_calibration,
    save_calibration,
)
from erlif.core.terms import TERMS
from erlif.models.fluorescence import band_light, band_ratio
from erlif.show.plots import example_calibration, example_film

CALIBRATION = example_calibration()
FILMS = np.array([1.0, 3.0, 6.0, 10.0])
MEDIAN = 5.0
"""Film whose light the shares of light refer to. [um]"""


def band(film, attenuation):
    return -np.expm1(-attenuation * film) / attenuation


def extend(**widths):
    """The calibration with errors, shares of light referring to that of the median film."""
    K, p, q = CALIBRATION.parameters
    light = float(band(MEDIAN, p)), float(K * band(MEDIAN, q))
    return with_systematics(CALIBRATION, light=light, **widths)


def names(calibration):
    return [one.name for one in calibration.systematics.parameters]


def disturbed(term, size):
    """Logarithm of the ratio where one thing is wrong by `size`, from the light of two bands."""
    K, p, q = CALIBRATION.parameters
    h = FILMS

    def lights(film=h, bleached=0.0, reabsorbed=0.0):
        one = band(film, (1 - bleached) * p + reabsorbed * (p - q))
        return one, K * band(film, (1 - bleached) * q)

    one, two = lights()
    level = 0.4  # of full scale, where the film is the median one
    of_one = one / lights(MEDIAN)[0]

    changed = {
        "ratio": (one, two * (1 + size)),
        "lag": (one, two * (1 + size)),
        "temperature": (one, two * (1 + size)),
        "bleaching": lights(bleached=size),
        # dye 2 emits in band 2 and reabsorbs in band 1
        "batch": (lights(reabsorbed=size)[0], two * (1 + size)),
        "linearity": (one * (1 + size * level * of_one), two),
        "background": (one + size * lights(MEDIAN)[0], two),
        "position": lights(h + size),
        "size": lights(h * (1 + size)),
    }
    first, second = changed[term]
    return np.log(second / first)


ROWS = {
    "ratio": "constant",
    "lag": "constant",
    "temperature": "constant",
    "bleaching": "rising absorption",
    "batch": "dye 2",
    "linearity": "light 1",
    "background": "background 1",
    "position": "position",
    "size": "size",
}


@pytest.mark.parametrize("term", ROWS)
def test_gradient_is_the_change_of_the_ratio_of_a_disturbed_film(term):
    extended = extend(**{term: 0.01})
    step = 1e-6
    expected = (disturbed(term, step) - disturbed(term, -step)) / (2 * step)
    row = 3 + names(extended).index(ROWS[term])
    npt.assert_allclose(extended.gradient(FILMS)[row], expected, rtol=1e-5)
    npt.assert_array_equal(extended.gradient(FILMS)[:3], CALIBRATION.gradient(FILMS))


def test_a_wall_acts_as_the_model_before_it():
    """A joint that reflects 1 % more than the fixture; the laser has 0.8 of the attenuation q."""
    extended = extend(wall=0.01)
    K, p, q = CALIBRATION.parameters
    two = [
        band_ratio(
            FILMS,
            ratio_at_zero=K,
            attenuation_camera1=p,
            attenuation_camera2=q,
            attenuation_laser=0.8 * q,
            reflectance=R,
        ).log_ratio
        for R in (0.0, 1e-6)
    ]
    npt.assert_allclose(extended.gradient(FILMS)[-1], (two[1] - two[0]) / 1e-6, rtol=1e-4)


def test_scatter_of_all_terms_is_the_standard_deviation_of_the_film():
    extended = extend(**dict.fromkeys(TERMS, 0.01))
    rng = np.random.default_rng(3)
    covariance = extended.full_covariance
    npt.assert_array_equal(covariance, covariance.T)
    errors = rng.multivariate_normal(np.zeros(len(covariance)), covariance, 40000)
    scatter = (errors @ extended.gradient(FILMS) / extended.slope(FILMS)).std(axis=0)
    npt.assert_allclose(extended.thickness_std(FILMS), scatter, rtol=4 / np.sqrt(80000))
    assert (extended.thickness_std(FILMS) > CALIBRATION.thickness_std(FILMS)).all()


def test_terms_add_up_to_the_standard_deviation():
    extended = extend(**dict.fromkeys(TERMS, 0.01))
    terms = extended.split_error(extended.film_gradient(6.0))
    # the curve of one fixture does not change, and what rises has its full size at the end
    assert list(terms) == ["calibration", *(term for term in TERMS if term != "course")]
    npt.assert_allclose(
        np.sqrt(sum(std**2 for std in terms.values())), extended.thickness_std(6.0), rtol=1e-9
    )


def test_what_grows_during_the_run_is_absent_at_its_first_frame():
    extended = extend(bleaching=0.02, ratio=0.01)
    first, half, last = (extended.at(passed).thickness_std(FILMS) for passed in (0.0, 0.5, 1.0))
    plain = extend(ratio=0.01).thickness_std(FILMS)
    npt.assert_allclose(first, plain, rtol=1e-12)
    npt.assert_allclose(half**2 - plain**2, (last**2 - plain**2) / 4, rtol=1e-9)


def test_a_drift_of_the_ratio_grows_and_a_step_leaves_both_parts_of_a_run_in_doubt():
    """Of a ratio of which 1 % is stated, and a change of 3 %; 0.4 of the run is before the step."""
    alone = extend(ratio=0.01, wall=0.0)
    shares, std = (0.0, 0.3, 0.5, 1.0), 0.01

    def films(start):
        changed = replace(alone, systematics=alone.systematics.with_course(0.03, start=start))
        return [changed.at(share) for share in shares]

    for share, one in zip(shares, films(None), strict=True):
        own = one.log_ratio_std(3.0) ** 2 - CALIBRATION.log_ratio_std(3.0) ** 2
        npt.assert_allclose(own, std**2 + (0.03 * share) ** 2, rtol=1e-9)

    before, still, after, last = films(0.4)
    gradient = [one.gradient(3.0)[3:] for one in (before, still, after, last)]
    covariance = before.systematics.covariance
    found = np.array(gradient) @ covariance @ np.array(gradient).T
    parts = np.kron(np.eye(2), np.ones((2, 2)))  # frames of one part have one error
    npt.assert_allclose(found, std**2 + 0.03**2 * parts, rtol=1e-9)


def test_a_course_is_stored_with_the_calibration_and_needs_the_ratio():
    systematics = extend(ratio=0.01, background=0.02).systematics.with_course(0.03, start=0.4)
    back = Systematics.from_record(systematics.to_record())
    npt.assert_array_equal(back.covariance, systematics.covariance)
    assert (back.parameters, back.start) == (systematics.parameters, 0.4)
    for start in (0.4, None):
        course = extend(ratio=0.01).systematics.with_course(0.03, start=start)
        changed = replace(RunCurve.of(CALIBRATION), systematics=course)
        film = example_film().assign_attrs(calibration=record_calibration(changed))
        assert calibration_of(film).systematics.parameters == course.parameters

    without = extend(wall=0.01).systematics
    assert without.with_course(0.03, start=None) is without


def test_backgrounds_of_both_bands_are_alike():
    """Their correlation is 0.9; equal shares do not change the ratio of the median film."""
    extended = extend(background=0.01)
    std = np.sqrt(2 * (1 - 0.9)) * 0.01
    near = extended.log_ratio_std(MEDIAN) ** 2 - CALIBRATION.log_ratio_std(MEDIAN) ** 2
    npt.assert_allclose(near, std**2, rtol=1e-6)


def test_a_measured_background_takes_the_place_of_its_width():
    extended = extend(background=0.02, ratio=0.01)
    measured = Systematics(
        ("background",) * 2,
        TERMS["background"].parameters,
        np.array([[4e-6, 3e-6], [3e-6, 5e-6]]),
        1e-7 * np.arange(8).reshape(4, 2),  # K, p, q and the ratio
        (4.0, 3.0),
    )

    found = extended.systematics.with_background(measured)
    assert found.terms == extended.systematics.terms

    # the same light, whatever a share of it refers to
    films = np.array([2.0, 7.0])
    whole, alone = replace(extended, systematics=found), replace(CALIBRATION, systematics=measured)
    parts = [each.gradient(films)[-2:] for each in (whole, alone)]
    for own, other in (
        (found.covariance[1:, 1:], measured.covariance),
        (found.cross[:, 1:].T @ found.cross[:, 1:], measured.cross[:3].T @ measured.cross[:3]),
    ):
        variances = [
            np.einsum("if,ij,jf->f", part, matrix, part)
            for part, matrix in zip(parts, (own, other), strict=True)
        ]
        npt.assert_allclose(*variances, rtol=1e-12)
    npt.assert_allclose(found.covariance[0, 1:] @ parts[0], measured.cross[3] @ parts[1])
    assert found.prior.terms == ("ratio",)
    whole = replace(extended, systematics=found).full_covariance
    npt.assert_array_equal(whole, whole.T)


def test_terms_share_the_rise_of_the_ratio_by_their_widths():
    found = extend(temperature=0.03, bleaching=0.04).systematics
    assert found.rise == pytest.approx(0.05)
    changed = found.with_rise(0.01)
    npt.assert_allclose(changed.covariance, np.diag([0.03, 0.006, 0.008, 0.04]) ** 2)
    without = found.with_rise(0.0).with_rise(0.01)
    npt.assert_allclose(without.covariance, np.diag([0.03, 0.0, 0.01, 0.04]) ** 2)


def test_errors_of_a_fixture_are_stored_with_its_calibration(tmp_path):
    rng = np.random.default_rng(4)
    found = calibrate(
        image(rng, log_ratio(WEDGE)), wedge_profile(rng), position_std=0.06, size_std=0.005
    )
    # the wedge rises by 17.9 um over 319 pixels of 0.06 mm
    npt.assert_allclose(found.systematics.widths["position"], 17.9 / 319, rtol=0.05)
    assert found.systematics.widths["size"] == 0.005
    back = open_calibration(save_calibration(found, tmp_path / "calibration.nc"))
    npt.assert_array_equal(back.full_covariance, found.full_covariance)
    films = np.array([2.0, 8.0])
    alone = replace(found, systematics=NO_SYSTEMATICS)
    extra = found.thickness_std(films) ** 2 - alone.thickness_std(films) ** 2
    npt.assert_allclose(np.sqrt(extra), np.hypot(17.9 / 319, 0.005 * films), rtol=0.05)
    npt.assert_allclose(alone.parameters, [K, P, Q], rtol=0.05)


def test_course_between_two_fixtures_is_known_at_both_ends():
    later = replace(CALIBRATION, ratio_at_zero=0.6, attenuation_camera2=0.24)
    run = RunCurve.of(with_systematics(CALIBRATION, course=0.07).calibration, later)
    change = later.predict_log(FILMS) - CALIBRATION.predict_log(FILMS)
    for passed, factor in ((0.0, 0.0), (0.25, 0.75), (0.5, 1.0), (1.0, 0.0)):
        npt.assert_allclose(run.at(passed).gradient(FILMS)[3], factor * change, atol=1e-15)


def test_frames_of_a_run_have_the_errors_of_their_share():
    """Two frames at 0.25 and 1 of the run, each with all films, are those of `at`."""
    later = replace(CALIBRATION, ratio_at_zero=0.6, attenuation_camera2=0.24)
    before = with_systematics(CALIBRATION, temperature=0.01, course=0.07, wall=0.02)
    run = RunCurve.of(before.calibration, later)
    systematics, model = run.systematics, run.model
    films, passed = np.stack([FILMS, FILMS]), np.array([[0.25], [1.0]])
    found = (
        systematics.gradient(films, model, run.slope(films), run.change(films), passed=passed),
        systematics.gradient(
            films, model, run.slope(films), run.change(films), of="light", passed=passed
        ),
    )
    for n, share in enumerate(passed[:, 0]):
        at = replace(systematics, passed=share)
        for whole, of in zip(found, ("ratio", "light"), strict=True):
            one = at.gradient(FILMS, model, run.slope(FILMS), run.change(FILMS), of=of)
            npt.assert_allclose(whole[:, n], one, rtol=1e-12)


def light_gradient(calibration, film):
    slope, change = calibration.slope(film), calibration.change(film)
    return calibration.systematics.gradient(film, calibration.model, slope, change, of="light")


def test_light_agrees_with_films_that_are_wrong_by_a_share():
    """Light and ratio change as one with the size of the fixture and the absorption of the dyes."""
    extended = extend(size=0.01, bleaching=0.01, batch=0.01)
    systematics, model = extended.systematics, extended.model
    film = np.array([1.0, 3.0, 8.0])
    response = model.light(film).slope / extended.slope(film)
    own = extended.gradient(film)[-len(systematics.parameters) :]
    left = response * own - light_gradient(extended, film)
    for name in ("rising absorption", "size", "dyes"):
        n = names(extended).index(name)
        npt.assert_allclose(left[n], left[n][0], rtol=1e-9)


def test_light_before_a_wall_is_that_of_the_model():
    extended = extend(wall=0.01)
    _, p, q = extended.calibration.parameters
    film = np.array([1.0, 3.0, 8.0])
    lights = [
        np.log(band_light(film, attenuation=p, attenuation_laser=0.8 * q, reflectance=R).signal)
        for R in (0.0, 1e-6)
    ]
    found = light_gradient(extended, film)[0]
    npt.assert_allclose(found, (lights[1] - lights[0]) / 1e-6, rtol=1e-4)


def test_what_a_run_adds_is_in_curve_slope_and_file():
    """2 % of the ratio in the whole run and 1 % at its end; then 1 % less absorption."""
    extended = extend(ratio=0.02, bleaching=0.01)
    size = len(extended.full_covariance)
    value = np.zeros(size)
    value[3:5] = 0.02, 0.01  # after K, p and q; then the absorption, whose row stays 0
    systematics = extended.systematics.with_errors(0.25 * extended.full_covariance, value)
    assert Systematics.from_record(systematics.to_record()).to_record() == systematics.to_record()
    assert not extended.follows_run

    found = replace(extended, systematics=systematics)
    for passed in (0.0, 0.5, 1.0):
        more = found.at(passed).predict_log(FILMS) - CALIBRATION.predict_log(FILMS)
        npt.assert_allclose(more, 0.02 + 0.01 * passed, atol=1e-12)
    npt.assert_allclose(found.thickness_std(FILMS), 0.5 * extended.thickness_std(FILMS), rtol=1e-9)

    value = np.zeros(size)
    value[5] = 0.01
    bent = replace(extended, systematics=extended.systematics.with_errors(np.eye(size), value))
    thinner = CALIBRATION.predict_log(0.99 * FILMS) - CALIBRATION.predict_log(FILMS)
    more = bent.predict_log(FILMS) - CALIBRATION.predict_log(FILMS)
    npt.assert_allclose(more, thinner, rtol=0.015)
    step = 1e-4
    numerical = (bent.predict_log(FILMS + step) - bent.predict_log(FILMS - step)) / (2 * step)
    npt.assert_allclose(bent.slope(FILMS), numerical, rtol=1e-4)
