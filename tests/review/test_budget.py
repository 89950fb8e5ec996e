"""The budget adds up to the error bars of the maps and of the statistics."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
from scenes.rig import small_rig

import erlif
from conftest import Laboratory
from erlif.calibration import Systematics
from erlif.core.flags import Flag
from erlif.core.terms import TERMS
from erlif.ratio import BlurDifference
from erlif.ratio.softening import Softening
from erlif.rig import RigSettings, simulate
from erlif.show.plots import example_calibration
from erlif.show.report import print_budget

pytestmark = pytest.mark.usefixtures("without_theory")

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    out = tmp_path_factory.mktemp("lab")
    rig = RigSettings(
        width=160, height=112, field_width=13.44, spacing=7.0, fixture_frames=4, cycles=2
    )
    simulate(out, seed=71, rig=rig)
    calibration = erlif.calibrate(out / "fixture")
    film = erlif.process(out / "run", calibration=calibration)
    budget = erlif.budget(out / "run", trigger=2, calibration=calibration, films=(6.0, 8.0))
    return film, budget, out, calibration


def test_terms_add_up_to_the_error_bars_of_the_pixels(lab):
    film, budget, _, _ = lab
    one = film.isel(trigger=2)
    for n, wanted in enumerate((6.0, 8.0)):
        near = np.abs(one.thickness.values / wanted - 1) < 0.05
        sums = budget["std"].isel(quantity=n)
        npt.assert_allclose(
            sums.sel(term="random part"), np.median(one.thickness_std.values[near]), rtol=0.05
        )
        npt.assert_allclose(
            sums.sel(term="shared part"),
            np.median(one.thickness_std_shared.values[near]),
            rtol=0.05,
        )


def test_pixels_that_some_frames_lack_have_a_budget_too(lab, tmp_path):
    """With one of two frames black, the terms are those of the other frame alone."""
    _, whole, out, calibration = lab
    copy = shutil.copytree(out / "run", tmp_path / "run")
    triggers = len(list((copy / "camera1").iterdir())) // 2
    for camera in ("camera1", "camera2"):
        path = sorted((copy / camera).iterdir())[2 + triggers]
        tifffile.imwrite(path, np.full_like(tifffile.imread(path), 64))
    budget = erlif.budget(copy, trigger=2, calibration=calibration, films=(6.0, 8.0))
    assert np.isfinite(budget["std"].sel(term="total")).all()
    photons = [b["std"].isel(quantity=0).sel(term="photons, camera 1") for b in (budget, whole)]
    npt.assert_allclose(photons[0] / photons[1], np.sqrt(2), rtol=0.05)
    path.unlink()  # the same where camera 2 has lost it
    budget = erlif.budget(
        copy, trigger=2, calibration=calibration, films=(6.0, 8.0), skip_bad_frames=True
    )
    lost = budget["std"].isel(quantity=0).sel(term="photons, camera 1")
    npt.assert_allclose(lost / photons[1], np.sqrt(2), rtol=0.05)
    shutil.copy(out / "run" / "camera2" / path.name, path)
    named = erlif.budget(copy, trigger=2, calibration=calibration)
    assert named.sizes["quantity"] == 5


def test_terms_add_up_to_the_error_bars_of_the_statistics(lab):
    film, budget, _, _ = lab
    for name, title in (("film_mean", "mean film"), ("film_min", "minimum film")):
        column = budget.sel(quantity=title)
        npt.assert_allclose(column["value"], film[name].values[2], rtol=1e-6)
        npt.assert_allclose(
            column["std"].sel(term="total"), film[f"{name}_std"].values[2], rtol=1e-4
        )


def test_pixels_beside_a_step_are_left_out_as_in_the_film(lab, tmp_path):
    """Camera 2 has 20 % more light in one half of the image, as behind a step of 4 um."""
    _, _, out, calibration = lab
    copy = shutil.copytree(out / "run", tmp_path / "run")
    for path in (copy / "camera2").iterdir():
        page = tifffile.imread(path).astype(float)
        page[:, 80:] += 0.2 * (page[:, 80:] - 64)
        tifffile.imwrite(path, np.rint(page).astype(np.uint16), photometric="minisblack")
    film = erlif.process(copy, calibration=calibration).isel(trigger=2)
    assert (film["flags"] & Flag.FILM_STEP).any()
    column = erlif.budget(copy, trigger=2, calibration=calibration).sel(quantity="mean film")
    npt.assert_allclose(column["value"], film.film_mean, rtol=1e-6)
    npt.assert_allclose(column["std"].sel(term="total"), film.film_mean_std, rtol=1e-4)


@pytest.mark.slow
def test_an_uneven_wall_on_the_patch_is_in_the_budget_as_in_the_film(tmp_path):
    """The patch has the scale of the ratio taken out, and its wall is as uneven as the others."""
    wall = {"wall": (0.1, 0.1), "wall_texture": (0.5, 1.0), "brightness": (1.0, 1.03)}
    rig = small_rig(**wall, reference=6.5, fixture_frames=3)
    lab = Laboratory.simulated(tmp_path, seed=81, rig=rig)
    lab.edit("run/run.toml", ("[thickness]", '[light]\nratio = "correct"\n\n[thickness]'))
    film = erlif.process(lab.run).isel(trigger=2)
    column = erlif.budget(lab.run, trigger=2).sel(quantity="mean film")
    texture = film.film_mean_error.sel(error_term=film.error_term == "texture").item()
    npt.assert_allclose(column["std"].sel(term="texture"), texture, rtol=1e-4)
    npt.assert_allclose(column["std"].sel(term="total"), film.film_mean_std, rtol=1e-4)


def test_photons_are_the_square_root_of_their_number(lab):
    """Shot noise of a pixel from counts and gain alone, as far as its blur leaves it."""
    film, budget, out, calibration = lab
    pages = [tifffile.imread(path) for path in sorted((out / "run" / "camera1").iterdir())]
    triggers = film.sizes["trigger"]
    electrons = (
        np.mean([page.astype(float) - 64 for page in pages[2::triggers]], axis=0) * 4.4 * 2
    )  # of two frames together
    near = np.abs(film.thickness.values[2] / 6.0 - 1) < 0.05
    expected = np.median(1 / np.sqrt(electrons[near])) / float(calibration.slope(6.0))
    found = film.encoding["groups"]["registration"].attrs
    blur = BlurDifference(*found["blur_difference"], *found["blur_difference_std"])
    expected *= Softening.of(blur).factors[0] ** 0.5
    term = float(budget["std"].isel(quantity=0).sel(term="photons, camera 1"))
    npt.assert_allclose(term, expected, rtol=0.05)


def test_a_film_that_is_not_there_is_refused(lab):
    _, _, out, calibration = lab
    with pytest.raises(erlif.ErlifError, match="Expected at least 50 valid pixels of 40 um"):
        erlif.budget(out / "run", trigger=2, calibration=calibration, films=(40.0,))


def test_terms_of_width_zero_are_named(lab):
    """The virtual rig states 0 % for what it does not have."""
    _, budget, _, _ = lab
    assert {"ratio", "lag", "wall"} <= set(budget.attrs["declared_zero"])
    assert "Declared to be 0 % in [systematics]: " in print_budget(budget)


def test_remedies_begin_with_the_errors_of_the_run(lab):
    """Without systematics, the calibration and the noise of the mean remain."""
    _, _, out, calibration = lab
    budget = erlif.budget(out / "run", trigger=2, calibration=calibration, target="5 %")
    table = budget.target_std
    films = table.target_film.values
    low, high = calibration.covered_range
    inside = (films > low) & (films < high)
    expected = calibration.thickness_std(films[inside])
    assert (table.values[0][inside] >= expected).all()
    npt.assert_allclose(table.values[0][inside], expected, rtol=0.2)
    assert table.sizes["remedy"] == 1
    assert "Target: " in print_budget(budget)


def numbers(table):
    """Titles, terms and numbers of a table."""
    cells = [re.split(r"\s{2,}", line.strip()) for line in table.strip().splitlines()]
    words = [[cell for cell in row if not re.fullmatch(r"[\d.]+", cell)] for row in cells]
    return words, np.array(
        [float(cell) for row in cells for cell in row if re.fullmatch(r"[\d.]+", cell)]
    )


@pytest.mark.slow
def test_documented_budget_is_that_of_the_sample():
    """docs/uncertainty.md holds the budget of data_samples/straight_bushing.

    After a change of method, docs/make_budget.py renews it.
    """
    text = (ROOT / "docs" / "uncertainty.md").read_text(encoding="utf-8")
    documented = text.split("<!-- budget -->\n```text")[1].split("```\n<!-- end of budget -->")[0]
    sample = ROOT / "data_samples" / "straight_bushing"
    words, values = numbers(documented)
    words_now, values_now = numbers(print_budget(erlif.budget(sample)))
    assert words == words_now
    npt.assert_allclose(values, values_now, rtol=0.05, atol=0.1)


@pytest.mark.parametrize("correlation", [-0.9, 0.0, 0.9])
@pytest.mark.parametrize("size", [0.01, 0.1])
def test_calibration_and_background_add_up_however_they_are_correlated(correlation, size):
    """A background that is found with the calibration may compensate a part of its error."""
    plain = example_calibration()
    shares = size**2 * np.diag([1e-2, 1e-2])
    two = TERMS["background"].parameters
    empty = Systematics(("background",) * 2, two, shares, np.zeros((3, 2)), (3.0, 2.0))
    gradient = replace(plain, systematics=empty).gradient(3.0)
    own, other = plain.full_covariance @ gradient[:3], shares @ gradient[3:]
    scale = correlation / np.sqrt((gradient[:3] @ own) * (gradient[3:] @ other))
    both = replace(plain, systematics=replace(empty, cross=scale * np.outer(own, other)))

    terms = both.split_error(gradient)
    total = gradient @ both.full_covariance @ gradient
    npt.assert_allclose(terms["calibration"] ** 2 + terms["background"] ** 2, total)
