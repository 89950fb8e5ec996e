"""Effects of tolerances, against finite changes of the curve."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.planning import Spectrum, WantedFilm, log_ratio, vary_tolerances
from erlif.planning.optimum import FILMS


@pytest.fixture(scope="module")
def changes(design, film):
    return vary_tolerances(design, film)


def test_the_largest_effect_is_first_and_noise_leaves_the_film_alone(design, changes):
    """Also where the slope of the ratio is zero to the last digit, at a film of 10 mm."""
    effects = [change.effect for change in changes]
    assert effects == sorted(effects, reverse=True)
    films = {change.what: change.film for change in changes}
    assert len(films) == 9
    still = [films[what] for what in ("pulse energy", "read noise", "full well")]
    npt.assert_allclose(still, 0.0, atol=1e-12)

    found = vary_tolerances(design, WantedFilm(2.0, 10e3, (0.1, 20e3)))
    assert all(np.isnan(change.std) for change in found)
    films = [change.film for change in found]
    assert films == sorted(films, reverse=True)


def test_gain_of_a_camera_moves_the_film_by_its_logarithm(design, film, changes):
    """Inverted by the curve itself in place of its slope."""
    films = np.geomspace(film.thinnest, film.thickest, FILMS)
    table = np.linspace(0.01, 60, 60_000)
    moved = np.interp(log_ratio(design, films) + np.log(1.0005), log_ratio(design, table), table)
    expected = float(np.abs(moved / films - 1).max())

    small = vary_tolerances(design, film, {"gain": 0.0005})
    found = next(change for change in small if change.what == "gain of camera 1")
    assert found.film == pytest.approx(expected, rel=0.01)


def test_more_light_extends_the_range(design):
    narrow = WantedFilm(2.0, 8.0, (0.1, 18.0))
    found = {one.what: one for one in vary_tolerances(design, narrow, {"gain": 0.005})}
    change = found["pulse energy"]
    assert change.std == pytest.approx(1 / np.sqrt(0.9) - 1, abs=0.01)  # less light
    assert change.thinnest > 0 > change.thickest
    assert found["gain of camera 1"].tolerance == "0.5 %"  # with its digits


def test_dyes_by_coefficients_have_no_shift_of_a_filter(design, film):
    nm = np.array([532.0, 580.0, 610.0])
    narrow = tuple(
        replace(
            dye,
            absorption=Spectrum(nm, dye.absorption.at(nm), "absorption", narrow=True),
            emission=Spectrum(nm, dye.emission.at(nm), "emission", narrow=True),
        )
        for dye in design.dyes
    )
    found = vary_tolerances(replace(design, dyes=narrow), film)
    assert not [change for change in found if "filter" in change.what]
    assert len(found) == 7
