"""A background that the run itself shows: reported, and subtracted on request."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pin import fit_true_film
from scenes.rig import small_rig

import erlif
from conftest import processed, simulated
from erlif.calibration import calibration_of
from erlif.pipeline.engines.results import FrameResult
from erlif.pipeline.physics.light import find_bleaching
from erlif.ratio import NO_CELLS

pytestmark = pytest.mark.usefixtures("without_theory")

SHARE = 0.06
RIG = small_rig(spacing=0.96, film_reference=3.0, background=SHARE)
"""Fifty triggers with films from 0.3 um on, and 6 % of the median light in every pixel."""


PATCH = '[reference]\nregion = { x = [4, 8], y = [4, 8] }\nthickness = "3 um"\n'

lab = simulated(RIG, seed=41)
reported = processed("lab", "reported", add='\n[light]\nerrors = "report"\n')
corrected = processed("lab", "corrected", add=f'\n[light]\nbackground = "correct"\n{PATCH}')


def test_background_is_found_within_its_error(reported):
    """The unit is the median of all light, of which the background is a part."""
    npt.assert_array_less(
        np.abs(reported.background - SHARE / (1 + SHARE)), 3 * reported.background_std
    )
    assert reported.background.attrs["chi_square"] > 11.83
    assert reported.background.attrs["subtracted"] == "false"
    assert "do not agree without light that is not film" in reported.attrs["notes"]
    assert 'background = "correct"' in reported.attrs["notes"]


def test_reported_background_is_in_the_errors_of_mean_and_minimum(lab, reported):
    """Without it the deviations would be many standard deviations."""
    pull = (reported.film_min - lab.truth.film_min.values) / reported.film_min_std
    assert np.median(np.abs(pull)) < 2


def test_reported_background_is_in_the_error_of_the_pin(lab, reported):
    """The circles nearest to the true film of each trigger, by least squares over the region."""
    x, y = reported.x.values, reported.y.values
    inside_x, inside_y = (x >= 4) & (x <= 15), (y >= 2) & (y <= 13)
    load_line = float(reported.pin_displacement.attrs["load_line"])
    place = (x - load_line)[inside_x], (y - y.mean())[inside_y]
    inside = np.ix_(inside_y, inside_x)
    known = [fit_true_film(film[inside], *place)[0] for film in lab.truth.film.values]
    error = reported.pin_displacement.values[:, 0] - known
    std = np.sqrt(reported.pin_position_cov.values[:, 0, 0])
    assert np.nanmedian(np.abs(error)) > 0.03  # 6 % of background moves a film of 3 um by 70 nm
    assert np.nanmax(np.abs(error) / std) < 2.5  # 5 without the background


def test_subtracted_background_leaves_films_within_their_errors(lab, reported, corrected):
    inside, error = lab.errors(reported, above=3, below=4)
    before = error[inside].mean()
    inside, error = lab.errors(corrected, above=3, below=4)
    after, shared = error[inside].mean(), corrected.thickness_std_shared.values[inside].mean()

    assert before > 0.06
    assert abs(after) < 2.5 * shared
    assert abs(after) < 0.5 * before
    assert "light that is not film subtracted" in corrected.attrs["notes"]


def test_what_the_subtraction_leaves_takes_the_place_of_an_unknown_background(reported, corrected):
    """Unmeasured, it is 1.5 % of the light; the error of the estimate is smaller, and not zero."""
    both = (reported["flags"].values == 0) & (corrected["flags"].values == 0)
    before, after = (
        np.median(film.thickness_std_shared.values[both]) for film in (reported, corrected)
    )
    assert after < 0.5 * before

    films = corrected.thickness.values[both]
    own = calibration_of(corrected).calibration.thickness_std(films)
    assert after > 1.3 * np.median(own)


def test_error_of_the_subtracted_background_is_in_that_of_the_patch(reported, corrected):
    """The pixels of its film have the same shared error, and that of the registration besides."""
    film, std = corrected.reference_film.values, corrected.reference_film_std.values
    assert np.isfinite(film).sum() > 20
    for k in np.flatnonzero(np.isfinite(film)):
        alike = np.abs(corrected.thickness.values[k] / film[k] - 1) < 0.02
        if alike.any():
            assert std[k] > 0.9 * np.median(corrected.thickness_std_shared.values[k][alike])


@pytest.mark.parametrize("name", ["reported", "corrected"])
def test_budget_has_the_background_and_adds_up(lab, reported, corrected, name):
    film = {"reported": reported, "corrected": corrected}[name]
    budget = erlif.budget(lab.directory / name, trigger=10)
    for quantity, variable in (("mean film", "film_mean"), ("minimum film", "film_min")):
        column = budget["std"].sel(quantity=quantity)
        assert float(column.sel(term="background")) > 0
        npt.assert_allclose(column.sel(term="total"), film[f"{variable}_std"][10], rtol=1e-3)


def light_of(rng, energies, *, per_frame=-1e-3):
    """One film in all frames; the light follows the energy and fades."""
    lights = {}
    for frame, energy in enumerate(energies):
        level = np.log(max(energy, 0.01)) + per_frame * frame
        noise = 1e-4 * rng.standard_normal((2, 120))
        cells = NO_CELLS._replace(light=7 + level + noise[0], log_ratio=0.3 + noise[1])
        lights[frame] = FrameResult(frame, (0.0, 0.0), (1, 1), cells=cells)
    return lights


@pytest.mark.parametrize("missed", [(), (7,)])
def test_one_missed_pulse_leaves_the_bleaching_of_the_light(missed):
    """The log has energy 0 there; all other pulses scatter by 3 %."""
    rng = np.random.default_rng(2)
    energies = 1 + 0.03 * rng.standard_normal(40)
    energies[list(missed)] = 0.0
    found, source = find_bleaching(light_of(rng, energies), np.zeros(40, int), energies)
    assert source == "at equal triggers"
    npt.assert_allclose(found.light, -1e-3, atol=4 * found.light_std)
    assert found.light_std < 2e-6
