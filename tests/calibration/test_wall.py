"""Curves before another wall than the fixture's, against every wavelength of the rig's filters."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import (
    WEDGE,
    calibrate,
    find_films,
    image,
    through_filters,
    wedge_profile,
    with_systematics,
)

from erlif.calibration import change_wall
from erlif.show.plots import example_calibration

FILMS = np.array([1.0, 2.0, 3.0, 4.0, 6.0, 8.0])


def fixture_before(wall, *, stated):
    rng = np.random.default_rng(6)
    ratios = image(rng, through_filters(wall)(WEDGE))
    return calibrate(ratios, wedge_profile(rng), reflectance=wall if stated else None)


@pytest.mark.parametrize(
    ("of_fixture", "of_joint", "stated"),
    [(0.0, 0.3, False), (0.0, 0.05, False), (0.05, 0.2, True), (0.1, 0.3, True), (0.3, 0.0, True)],
)
def test_films_before_another_wall_are_true(of_fixture, of_joint, stated):
    """The curve of the fixture itself is off by 0.2 to 4 um there."""
    fixture = fixture_before(of_fixture, stated=stated)
    joint = change_wall(fixture, of_joint)
    films = FILMS[joint.thickness_range[1] * 0.8 > FILMS]
    ratios = through_filters(of_joint)(films)
    error, std = find_films(joint, ratios) - films, joint.thickness_std(films)
    assert films.size >= 4
    assert (np.abs(error) < 2 * np.hypot(std, 0.01 * films)).all()
    assert (np.abs(error) < 0.05 * films)[films < 5].all()
    assert np.nanmax(np.abs(find_films(fixture, ratios) - films)) > 0.1


def test_a_fitted_reflectance_leaves_the_curve_uncertain_and_is_named():
    fitted, stated = (change_wall(fixture_before(0.3, stated=each), 0.1) for each in (False, True))
    assert fitted.thickness_std(4.0) > 3 * stated.thickness_std(4.0)
    assert any("State wall in [optics]" in note.text for note in fitted.notes)
    assert not any("State wall in [optics]" in note.text for note in stated.notes)
    taken_as_black = change_wall(fixture_before(0.0, stated=False), 0.1)
    assert any("is taken as black" in note.text for note in taken_as_black.notes)


def test_range_ends_below_the_highest_ratio():
    joint = change_wall(example_calibration(), 0.3)
    films = np.linspace(*joint.thickness_range, 200)
    assert (np.diff(through_filters(0.3)(films[films > 0.1])) > 0).all()
    assert joint.thickness_range[1] < 12


def test_fixture_of_the_same_wall_is_unchanged():
    black = example_calibration()
    assert change_wall(black, 0.0) is black
    reflecting = change_wall(black, 0.3)
    assert change_wall(reflecting, 0.3) is reflecting
    npt.assert_allclose(change_wall(reflecting, 0.0).covariance, black.covariance)


def test_errors_of_the_fixture_stay():
    fixture = with_systematics(example_calibration(), position=0.05, size=0.01).calibration
    joint = change_wall(fixture, 0.3)
    assert joint.systematics.widths == fixture.systematics.widths
    assert joint.thickness_std(4.0) > 0.05
