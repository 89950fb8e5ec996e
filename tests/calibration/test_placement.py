"""Refined poses of lines and surfaces against displacements that were put in."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import (
    PITCH,
    SHAPE,
    WEDGE,
    K,
    P,
    Q,
    assert_covers,
    calibrate,
    find_films,
    has_note,
    image,
    log_ratio,
    pulls_of_curve,
    wedge_profile,
)

from conftest import FULL
from erlif.calibration import Profile
from erlif.calibration.pairing import pair_profile_with_image
from erlif.calibration.placement import add_uncertainty_of_turn, refine_pose
from erlif.calibration.pose import Pose
from erlif.calibration.regression import fit_robustly

COLUMN, ROW = np.meshgrid(np.arange(SHAPE[1]) * PITCH, np.arange(SHAPE[0]) * PITCH)
MIDDLE = (9.5, 1.7)
FILMS = np.array([6.0, 8.0, 11.0])


def wave(x):
    return 9 + 0.4 * (x - 9) + 2.5 * np.sin(x)


def bumps(x, y):
    return 8 + 0.5 * (x - 9) + 2.0 * np.sin(0.7 * x) + 1.5 * np.cos(0.5 * x + 0.8 * y)


def straight(x):
    return 0.1 + 0.93 * x


def turned_line(rng, *, along, scale, turn, film=wave, noise=0.1):
    """A line profile whose image starts `along` mm further, larger by `scale`, turned by `turn`.

    Scale and turn [rad] are about the given origin.
    """
    x = along + (1 + scale) * (np.cos(turn) * COLUMN + np.sin(turn) * ROW)
    place = np.arange(0, 19.2, 0.1)
    profile = Profile(
        place, film(place) + rng.normal(0, noise, place.size), np.full(place.size, noise)
    )
    return image(rng, log_ratio(film(x))), profile


def turned_surface(rng, *, along, across, scale, turn, film=bumps, noise=0.1):
    """A surface profile whose image is displaced, scaled and turned about its middle."""
    dx, dy = COLUMN - MIDDLE[0], ROW - MIDDLE[1]
    x = MIDDLE[0] + along + (1 + scale) * (np.cos(turn) * dx + np.sin(turn) * dy)
    y = MIDDLE[1] + across + (1 + scale) * (np.cos(turn) * dy - np.sin(turn) * dx)
    places = np.stack(
        [axis.ravel() for axis in np.meshgrid(np.arange(0, 19.1, 0.4), np.arange(-0.3, 4.2, 0.4))],
        axis=1,
    )
    thickness = film(*places.T) + rng.normal(0, noise, len(places))
    return image(rng, log_ratio(film(x, y))), Profile(
        places, thickness, np.full(len(places), noise)
    )


def draw(rng, *, across=False):
    pose = {
        "along": rng.normal(0, 0.15),
        "scale": rng.normal(0, 0.005),
        "turn": np.radians(rng.normal(0, 1)),
    }
    return {**pose, "across": rng.normal(0, 0.15)} if across else pose


def pulls_of_line(rng):
    """Errors of the pose, of K, p and q, and of films, over their standard deviations."""
    true = draw(rng)
    calibration = calibrate(*turned_line(rng, **true), align=True)
    found = calibration.pose
    middle = float(calibration.curve.curve_x.mean())
    expected = np.array([true["along"] + true["scale"] * middle, true["scale"]])
    pose = (found.change[[0, 2]] - expected) / found.standard_deviations[[0, 2]]
    return [*pose, *pulls_of_curve(calibration, FILMS)]


def pulls_of_surface(rng):
    true = draw(rng, across=True)
    calibration = calibrate(*turned_surface(rng, **true), align=True)
    found = calibration.pose
    expected = np.array([true[name] for name in ("along", "across", "scale", "turn")])
    return [
        *(found.change - expected) / found.standard_deviations,
        *pulls_of_curve(calibration, FILMS),
    ]


def film_error(calibration):
    return np.abs(find_films(calibration, log_ratio(FILMS)) - FILMS)


# profiles with form


def test_offset_scale_and_turn_of_a_line_are_found_and_its_film_with_them():
    """0.3 mm, 1 % and 1.5 degrees off: the refined pose leaves the film error of the true pose."""
    rng = np.random.default_rng(1)
    turn = np.radians(1.5)
    ratios, profile = turned_line(rng, along=0.3, scale=0.01, turn=turn)
    refined = calibrate(ratios, profile, align=True)
    assert refined.pose.determined.tolist() == [True, False, True, True]
    known = calibrate(
        ratios,
        profile,
        pixel_pitch=1.01 * PITCH,
        direction=turn,
        origin=(-0.3 * np.cos(turn) / PITCH / 1.01, -0.3 * np.sin(turn) / PITCH / 1.01),
    )
    given = calibrate(ratios, profile)
    assert film_error(given).max() > 0.2
    assert (
        film_error(refined).max() < film_error(known).max() + 2 * refined.thickness_std(FILMS).max()
    )
    assert film_error(refined).max() < 0.08
    assert np.all(refined.standard_deviations > known.standard_deviations)
    assert has_note(refined, "degrees")
    assert has_note(refined, "scaled by")


@pytest.mark.slow
def test_uncertainties_of_pose_and_curve_cover_on_a_line():
    rng = np.random.default_rng(4)
    assert_covers([pulls_of_line(rng) for _ in range(40 if FULL else 12)])


@pytest.mark.slow
def test_scatter_of_pose_and_curve_matches_the_error_bars_on_a_surface():
    """The pose scatters by a tenth or two more than stated.

    The cells of a surface are wide, and its form is that of a polynomial.
    """
    rng, count = np.random.default_rng(5), 14 if FULL else 7
    pulls = np.array([pulls_of_surface(rng) for _ in range(count)])
    scatter = np.sqrt((pulls**2).mean(axis=0))
    width = 1 / np.sqrt(2 * count)  # scatter of the root mean square of so many draws
    assert np.all(scatter > 1 - 3 * width)
    assert np.all(scatter < 1.2 + 3 * width)
    assert 0.75 < scatter[4:].mean() < 1.25


def test_unknown_cmm_noise_does_not_hide_the_pose():
    rng = np.random.default_rng(8)
    ratios, profile = turned_line(rng, along=0.3, scale=0, turn=0)
    profile = Profile(profile.position, profile.thickness, None)
    found = calibrate(ratios, profile, align=True).pose
    assert abs(found.change[0] - 0.3) < 4 * found.standard_deviations[0] < 0.05


# profiles without form


@pytest.mark.slow
def test_straight_wedges_are_left_as_given():
    """Noise of the CMM is not taken for form: no straight wedge is moved or scaled."""
    rng = np.random.default_rng(5)
    for _ in range(50 if FULL else 12):
        ratios, profile = turned_line(
            rng, along=0.0, scale=0.0, turn=0.0, film=straight, noise=0.15
        )
        found = calibrate(ratios, profile, align=True).pose
        npt.assert_array_equal(found.change[:3], 0)
        assert not found.determined[:3].any()


def test_turn_of_a_straight_wedge_is_found_in_the_image():
    rng = np.random.default_rng(6)
    turn = np.radians(1.2)
    ratios, profile = turned_line(rng, along=0, scale=0, turn=turn, film=straight)
    calibration = calibrate(ratios, profile, align=True)
    found = calibration.pose
    assert found.determined.tolist() == [False, False, False, True]
    assert abs(found.change[3] - turn) < 4 * found.standard_deviations[3]
    assert found.standard_deviations[3] < 0.002
    assert np.all(np.abs(calibration.parameters - [K, P, Q]) < 4 * calibration.standard_deviations)
    assert has_note(calibration, "left as given: origin along the profile, scale.")


# the uncertainty of the turn


@pytest.mark.parametrize(("film", "free"), [(straight, 0), (wave, 2)])
def test_uncertain_turn_widens_the_covariance_as_a_turned_fit_shifts(film, free):
    """The added covariance is the outer product of the shift that one standard deviation makes.

    On a wave, offset and scale are fitted with the curve and follow the turn. The image lies off
    the axis of the profile (origin at the lower edge), where a turn moves it.
    """
    rng = np.random.default_rng(9)
    ratios, profile = turned_line(rng, along=0, scale=0, turn=0.02, film=film)
    given = Pose((0.0, 0.0), 0.0, PITCH)
    points, _ = pair_profile_with_image(ratios, profile, given)
    points, freedom, found = refine_pose(ratios, profile, points, given)
    assert freedom.size == free
    fit = fit_robustly(points, freedom)
    std = found.standard_deviations[3]
    wider = add_uncertainty_of_turn(fit, points, freedom, found)
    added = wider.covariance - fit.covariance

    # fifty standard deviations, so that the shift exceeds what a fit leaves unsettled
    films = points.thickness + 50 * std * points.gradient[:, 0] * points.mean_across
    turned = fit_robustly(replace(points, thickness=films), freedom)
    shift = np.concatenate([turned.parameters, turned.displacement])
    shift -= np.concatenate([fit.parameters, fit.displacement])
    npt.assert_allclose(np.sqrt(np.diag(added)), np.abs(shift) / 50, rtol=0.05)


def test_a_misplaced_straight_wedge_shifts_all_films_by_what_the_note_states():
    """20 px of a wedge of 17.9 um in its columns; the chi-square does not show it."""
    rng = np.random.default_rng(21)
    ratios, profile = image(rng, log_ratio(WEDGE)), wedge_profile(rng)
    per_pixel = float(np.mean(np.diff(WEDGE)))
    placed, misplaced = (calibrate(ratios, profile, origin=(x, 0.0)) for x in (0.0, -20.0))
    assert misplaced.reduced_chi_square < 1.5

    films = np.linspace(3.0, 10.0, 8)
    read = np.interp(placed.predict(films), misplaced.predict(WEDGE), WEDGE)
    npt.assert_allclose(read - films, 20 * per_pixel, rtol=0.15)
    assert has_note(misplaced, f"each pixel of error shifts all films by {per_pixel:.2g} um")
