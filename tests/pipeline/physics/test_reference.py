"""A patch of known film, dyes that bleach, and cameras that differ, from frames to film."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import with_systematics
from scenes.measured import statistics_of
from scenes.rig import small_rig

import erlif
from conftest import Laboratory, processed, simulated
from erlif.io.settings import ReferenceSettings
from erlif.pipeline.physics.reference import PatchScale, fit_patch_scale
from erlif.pipeline.physics.systematics import with_patch
from erlif.rig.dyes import BANDS, DyedOil, tabulate_signal
from erlif.show.plots import example_calibration
from erlif.thickness import PatchMean

pytestmark = pytest.mark.usefixtures("without_theory")

LOSS = (1e-3, 2e-3)
"""Shares of dye 1 and dye 2 that a pulse destroys."""

CORRECT = '\n[light]\nbleaching = "correct"\n'

RIG = small_rig(spacing=6.0, cycles=3, reference=4.0, bleaching=LOSS)


dyes = simulated(RIG, seed=51)
reported = processed("dyes", "reported", add='\n[light]\nerrors = "report"\n')
by_gap = processed("dyes")
corrected = processed("dyes", "corrected", add=CORRECT)


def test_bleaching_is_that_of_the_dyes(reported, dyes):
    last = dyes.truth.sizes["frame"] - 1
    film = np.array(4.0)
    left = tuple((1 - loss) ** last for loss in LOSS)
    fresh, faded = (
        [float(tabulate_signal(band, oil=DyedOil(share))(film)) for band in BANDS]
        for share in ((1.0, 1.0), left)
    )
    ratio = np.log(faded[1] / faded[0] * fresh[0] / fresh[1]) / last
    light = np.log(faded[0] / fresh[0]) / last
    assert abs(reported.bleaching_ratio - ratio) < 3 * reported.bleaching_ratio_std
    assert abs(reported.bleaching_light - light) < 3 * reported.bleaching_light_std
    assert abs(ratio) > 3 * reported.bleaching_ratio_std
    assert "as with dyes that bleach" in reported.attrs["notes"]
    assert "on the patch" in reported.attrs["notes"]


def test_cycles_show_the_bleaching_without_a_patch(dyes, reported):
    settings = (dyes.run / "run.toml").read_text(encoding="utf-8")
    patch = settings[settings.index("[reference]") :]
    plain = statistics_of(dyes.copy_run("cycles", (patch, "")))
    assert "reference_film" not in plain
    both = np.hypot(plain.bleaching_ratio_std, reported.bleaching_ratio_std)
    # the change depends a little on the film, which differs between patch and field
    slack = 0.5 * abs(float(reported.bleaching_ratio))
    assert abs(plain.bleaching_ratio - reported.bleaching_ratio) < 3 * both + slack
    assert plain.bleaching_ratio * reported.bleaching_ratio > 0
    assert "at equal triggers" in plain.attrs["notes"]


def test_film_of_the_patch_drifts_with_the_ratio_and_not_once_it_is_corrected(reported, corrected):
    off = float(abs(reported.reference_film - 4).mean())
    left = float(abs(corrected.reference_film - 4).mean())
    assert off > 2 * left
    npt.assert_array_less(
        abs(corrected.reference_film - 4), 3.5 * np.hypot(corrected.reference_film_std, 0.02)
    )
    assert "taken out of the ratio" in corrected.attrs["notes"]
    assert corrected.bleaching_ratio.attrs["corrected"] == "true"


def test_films_are_nearer_to_the_truth_once_it_is_corrected(dyes, reported, corrected, by_gap):
    true = dyes.truth.film_min.values
    off, left, without_patch = (
        float(abs(film.film_min - true).mean()) for film in (reported, corrected, by_gap)
    )
    assert left < 0.6 * off
    # the cells beside the patch hold its edge; the gap of all others shows the same error
    assert without_patch < 0.3 * off


def test_one_cycle_without_a_patch_cannot_be_corrected(lab):
    film = statistics_of(lab.copy_run("corrected", add=CORRECT))
    assert "cannot be separated from a change of the film" in film.attrs["notes"]


def test_a_wrong_film_of_the_patch_is_reported(dyes):
    """It is 0.6 um too thick, also where an error of the ratio of 5 % is allowed for."""
    changes = (('thickness = "4 um"', 'thickness = "4.6 um"'), ('ratio = "0 %"', 'ratio = "5 %"'))
    film = statistics_of(dyes.copy_run("wrong", *changes))
    assert "reference: " in film.attrs["notes"]
    assert "4.600 um known" in film.attrs["notes"].split("reference: ")[1]
    assert "Calibrate again" in film.attrs["notes"]


# scale of the ratio

SCALED = '\n[light]\nratio = "correct"\n[systematics]\nfield = "0 %"\n'

UNLIKE = replace(
    RIG,
    spacing=4.0,
    cycles=1,
    film_reference=4.0,
    reference=5.0,
    brightness=(1.0, 1.02),
    bleaching=(1.5e-3, 3e-3),
    write_systematics=False,
)
"""Camera 2 is 2 % brighter than at the calibration, and dye 2 loses 5 % over the run."""


unlike = simulated(UNLIKE, seed=52)
scaled = processed("unlike", "scaled", add=SCALED)
unscaled = processed("unlike", "unscaled", add='\n[light]\nerrors = "report"\n')


@pytest.mark.parametrize("part", ["first", "last"])
def test_films_are_true_where_a_patch_sets_the_ratio(unlike, scaled, unscaled, part):
    inside, error = unlike.errors(scaled, above=3, below=9)
    chosen = slice(0, 5) if part == "first" else slice(-5, None)
    within, error = inside[chosen], error[chosen]
    film = unlike.truth.film.values[chosen]
    std = scaled.thickness_std_shared.values[chosen][within]
    assert abs(np.median(error[within] / film[within])) < 0.02
    assert abs(np.median(error[within])) < 2 * np.median(std)
    assert np.median(std) < 0.3 * np.nanmedian(unscaled.thickness_std_shared.values[chosen][within])
    if part == "first":
        off = unlike.errors(unscaled, above=3, below=9)[1][chosen]
        assert np.nanmedian(off[within] / film[within]) > 0.05


def test_term_of_the_scale_is_that_of_the_patch(unlike, scaled):
    """A film of 5 um known to 0.02 um is measured as such; films beside it have other errors."""
    near = np.abs(scaled.thickness.values - 5) < 0.05
    std = scaled.thickness_std_shared.values[near & (scaled["flags"].values == 0)]
    assert 0.02 <= np.median(std) < 0.03
    assert float(scaled.film_mean_error.sel(error_term="temperature").max()) < 0.01
    assert "taken out of the films" in scaled.attrs["notes"]
    trigger = scaled.sizes["trigger"] // 2
    table = erlif.budget(unlike.directory / "scaled", trigger=trigger)
    found = float(table["std"].sel(term="shared part", quantity="mean film"))
    terms = scaled.film_mean_error.isel(trigger=trigger).drop_sel(error_term=["noise", "marks"])
    assert found == pytest.approx(float(np.sqrt((terms**2).sum())), rel=0.1)


def test_line_through_the_patch_has_its_course_and_scatter():
    """Frames of a scatter of 0.01 over 100 pulses that lose 3 % of the ratio, from + 2 %."""
    rng, calibration = np.random.default_rng(5), example_calibration()
    expected = float(calibration.predict_log(5.0))
    reference = ReferenceSettings(
        region={"x": [1, 2], "y": [1, 2]}, thickness="5 um", uncertainty="0.02 um"
    )
    pulls = []
    for _ in range(200):
        ratio = expected + 0.02 - 0.03 * np.arange(101) / 100 + rng.normal(0, 0.01, 101)
        lights = {
            n: SimpleNamespace(patch=PatchMean(7.0, one, 1e-5)) for n, one in enumerate(ratio)
        }
        found = fit_patch_scale(lights, calibration, reference, pairs=101)
        pulls.append((found.course - [0.02, -0.03]) / np.sqrt(np.diag(found.covariance)))
    npt.assert_allclose(np.std(pulls, axis=0), 1, atol=0.15)
    npt.assert_allclose(np.mean(pulls, axis=0), 0, atol=0.25)
    few = {n: lights[n] for n in range(5)}
    assert fit_patch_scale(few, calibration, reference, pairs=101) is None


def test_errors_beyond_the_widths_are_those_of_the_difference_to_the_patch():
    """Drawn errors of curve and run, less those of the film of the patch: its ratio is 20 % off."""
    widths = {"ratio": 0.01, "bleaching": 0.01, "wall": 0.02, "background": 0.01, "size": 0.005}
    before = with_systematics(example_calibration(), light=(4.0, 4.0), **widths)
    scale = PatchScale(np.array([0.2, 0.0]), 1e-8 * np.eye(2), film=5.0, film_std=0.02)
    after = with_patch(before, scale)
    npt.assert_allclose(after.predict_log(5.0) - before.predict_log(5.0), 0.2, rtol=1e-3)

    rng = np.random.default_rng(8)
    errors = rng.multivariate_normal(
        np.zeros(len(before.full_covariance)), before.full_covariance, 20000
    )
    for passed in (0.0, 0.5, 1.0):
        for film in (2.0, 5.0, 9.0):
            curve = before.at(passed)
            drawn = errors @ (curve.gradient(film) - curve.gradient(5.0))
            patch = 0.02 * float(before.slope(5.0)) * rng.standard_normal(drawn.size)
            expected = np.std(drawn + patch)
            found = float(after.at(passed).log_ratio_std(film))
            assert found == pytest.approx(expected, rel=0.03, abs=2e-4)


@pytest.mark.parametrize("shown", [0.001, 0.005, -0.02])
def test_within_the_widths_every_error_takes_its_part_of_what_a_patch_shows(shown):
    """Drawn errors of which the patch shows as much: their means and scatter at other films."""
    widths = {"ratio": 0.01, "wall": 0.02, "size": 0.005}
    before = with_systematics(example_calibration(), light=(4.0, 4.0), **widths)
    scale = PatchScale(np.array([shown, 0.0]), 1e-8 * np.eye(2), film=5.0, film_std=0.02)
    after = with_patch(before, scale)

    rng = np.random.default_rng(9)
    zeros = np.zeros(len(before.full_covariance))
    errors = rng.multivariate_normal(zeros, before.full_covariance, 400000)
    off = errors @ before.gradient(5.0) + 0.02 * float(before.slope(5.0)) * rng.standard_normal(
        400000
    )
    like = errors[np.abs(off - shown) < 3e-4]
    for film in (2.0, 5.0, 9.0):
        drawn = like @ before.gradient(film)
        change = float(after.predict_log(film) - before.predict_log(film))
        assert change == pytest.approx(drawn.mean(), abs=4 * drawn.std() / drawn.size**0.5 + 1e-5)
        assert float(after.log_ratio_std(film)) == pytest.approx(drawn.std(), rel=0.1)


@pytest.mark.slow
def test_a_window_over_one_camera_is_in_the_errors_of_a_ratio_that_a_patch_sets(tmp_path):
    """1.5 % rms over the field: the ratio on the patch is off by more than that on the films."""
    rig = replace(RIG, cycles=1, spacing=3.0, reference=6.0, bleaching=(0.0, 0.0))
    lab = Laboratory.simulated(tmp_path, seed=53, rig=replace(rig, shading=(0.026, 0, 0, 0, 0)))
    stated = ("[systematics]\n", '[systematics]\nfield = "1.5 %"\n')
    film = statistics_of(lab.copy_run("shaded", stated, add='\n[light]\nratio = "correct"\n'))
    off = film.film_min - lab.truth.film_min
    pull = float(np.abs(off / film.film_min_std).median())
    assert 0.3 < pull < 2
    assert float(off.median()) > 0.1
