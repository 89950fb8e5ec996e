"""An oil that warms during the run, and the changes of the light that a laboratory has measured."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.rig import small_rig

import erlif
from conftest import Laboratory, processed
from erlif.calibration import calibration_of, compare_calibrations
from erlif.io.settings import TemperatureOptions
from erlif.pipeline import restore_images
from erlif.pipeline.physics.temperature import error_of_warming
from erlif.rig.dyes import BANDS, DyedOil, filtered_light

pytestmark = pytest.mark.usefixtures("without_theory")

BOTH = 'calibration = ["../fixture/calibration.nc", "../fixture_after/calibration.nc"]'
WARMER = 10.0
"""Last frame over the first, whose oil is that of the fixture. [K]"""

RIG = small_rig(
    width=160, height=128, spacing=4.0, film_reference=4.0, warming=WARMER, fixture_after=True
)


def change_of(band):
    """Change of the light of a thin film behind a filter, as a fluorimeter measures it. [%/K]"""
    thin = np.array([0.1])
    glow = tuple(1 + each for each in RIG.glow_per_kelvin)
    warm, cold = (
        float(filtered_light(thin, band, oil=DyedOil(glow=of))[0]) for of in (glow, (1.0, 1.0))
    )
    return 100 * (warm / cold - 1)


STATED = (
    "\n[temperature]\n"
    + "".join(f'camera{n} = "{change_of(band):.4f} %/K"\n' for n, band in enumerate(BANDS, 1))
    + 'std = "0.01 %/K"\nreading_std = "0.5 K"\n'
)


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    lab = Laboratory.simulated(tmp_path_factory.mktemp("warm"), seed=61, rig=RIG)
    for name, temperature in (("fixture", 25.0), ("fixture_after", 25.0 + WARMER)):
        stated = f'temperature = "{temperature:g} degC"\nname = "vir'
        lab.edit(f"{name}/fixture.toml", ('name = "vir', stated))
        made, path = erlif.calibrate(lab.directory / name), lab.directory / name / "calibration.nc"
        erlif.save_calibration(made, path, overwrite=True)
    lab.edit("run/run.toml", (BOTH, 'calibration = "../fixture/calibration.nc"'))
    return lab


plain = processed("lab", "plain", add='\n[light]\nerrors = "report"\n')


@pytest.fixture(scope="module")
def corrected(lab):
    run = lab.copy_run("corrected", add=STATED)
    return erlif.process(run, output=run / "film.nc", workers=2).load()


def last_films(film, lab):
    """Median error over the true film [1] and stated standard deviation, last five frames. [um]"""
    inside, error = lab.errors(film, above=3, below=8)
    inside[:-5] = False
    relative = float(np.median(error[inside] / lab.truth.film.values[inside]))
    return relative, float(np.median(error[inside])), film.thickness_std_shared.values[inside]


def test_films_of_warm_oil_are_those_of_the_truth(lab, plain, corrected):
    before, _, wide = last_films(plain, lab)
    after, off, std = last_films(corrected, lab)
    assert before > 0.02
    assert abs(after) < 0.02
    assert abs(off) < 2 * np.median(std)
    assert np.median(std) < 0.7 * np.median(wide)


def test_fixtures_at_two_temperatures_show_the_coefficient_of_the_ratio(lab):
    cold, warm = (
        erlif.open_calibration(lab.directory / name / "calibration.nc")
        for name in ("fixture", "fixture_after")
    )
    found = compare_calibrations(warm, cold)
    true = (change_of(BANDS[1]) - change_of(BANDS[0])) / 100
    coefficient, std = found.temperature_coefficient
    assert abs(coefficient - true) < 3 * std
    assert std < 0.2 * abs(true)
    assert f'camera2 = "{100 * coefficient:.4f} %/K"' in found.verdict
    assert replace(found, warmer=0.5).temperature_coefficient is None
    assert "[temperature]" not in replace(found, warmer=None).verdict


def test_stated_error_is_that_of_coefficient_and_reading(lab, corrected):
    """Of the last frame: 0.01 %/K of 10 K, and twice 0.5 K of 0.1 %/K of the ratio."""
    coefficient = change_of(BANDS[1]) - change_of(BANDS[0])
    expected = 0.01 * np.hypot(0.01 * WARMER, np.sqrt(2) * 0.5 * coefficient)
    film, calibration = 6.0, erlif.open_calibration(lab.fixture / "calibration.nc")
    near = np.abs(corrected.thickness.values[-1] - film) < 0.1
    shared = float(np.median(corrected.thickness_std_shared.values[-1][near]))
    found = np.sqrt(shared**2 - float(calibration.thickness_std(film)) ** 2)
    assert found == pytest.approx(expected / float(calibration.slope(film)), rel=0.1)

    # of the mean film the run itself shows that nothing is left
    of_mean = corrected.film_mean_error.sel(error_term="temperature").values[-1]
    assert of_mean < expected / float(calibration.slope(corrected.film_mean.values[-1]))


def test_images_behind_a_map_have_its_ratio(lab, corrected):
    """The ratio of a corrected film, inverted, is that film."""
    run, last = lab.directory / "corrected", corrected.sizes["trigger"] - 1
    images = restore_images(run / "film.nc", run, trigger=last)
    film = calibration_of(corrected).inverse.look_up(images.log_ratio.values.astype(float))
    valid = corrected["flags"].values[last] == 0
    rounding = 0.11 * corrected.thickness_std.values[last][valid]
    npt.assert_array_less(np.abs(film - corrected.thickness.values[last])[valid], rounding)


def test_budget_has_the_error_of_the_film(lab, corrected):
    trigger = corrected.sizes["trigger"] - 3
    table = erlif.budget(lab.directory / "corrected", trigger=trigger)
    found = float(table["std"].sel(term="temperature", quantity="mean film"))
    expected = float(corrected.film_mean_error.sel(error_term="temperature")[trigger])
    assert found == pytest.approx(expected, rel=0.05)


def test_a_log_without_temperatures_is_refused(lab, refused):
    run = lab.copy_run("missing", add=STATED)
    log = run / "encoder.csv"
    rows = [row.split(",") for row in log.read_text(encoding="utf-8").splitlines()]
    n = rows[0].index("temperature_C")
    text = "\n".join(",".join(row[:n] + row[n + 1 :]) for row in rows) + "\n"
    log.write_text(text, encoding="utf-8")
    assert "no column temperature. Add it to the log" in refused("process", run)


def test_temperature_between_two_fixtures_is_refused(lab, refused):
    one = 'calibration = "../fixture/calibration.nc"'
    run = lab.copy_run("between", (one, BOTH), add=STATED)
    assert "shows the temperature as well" in refused("process", run)


def test_error_grows_with_the_temperature_of_the_run():
    """A rise of 8 K from 2 K: the error of the coefficient is 2 K of it, then 10 K."""
    options = TemperatureOptions(
        camera1="-0.2 %/K", camera2="-0.1 %/K", std="0.02 %/K", reading_std="0 K"
    )
    covariance = error_of_warming(np.linspace(2.0, 10.0, 30), options)
    assert np.sqrt(covariance[0, 0]) == pytest.approx(2 * 2e-4)
    assert np.sqrt(covariance.sum()) == pytest.approx(10 * 2e-4)
