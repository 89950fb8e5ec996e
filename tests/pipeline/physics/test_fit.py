"""A virtual run of known viscosity, photographed, processed and fitted."""

import re
import shutil

import numpy as np
import numpy.testing as npt
import pytest

import erlif
from erlif.core.errors import ErlifError
from erlif.pipeline.physics.fit import fit_film, state_physics
from erlif.pipeline.physics.predict import read_film
from erlif.prediction import compare_models
from erlif.rig import RigSettings, simulate
from erlif.show.report import summarise
from erlif.show.report.agreement import describe_other_factors


@pytest.fixture(scope="module")
def sinking(small_rig, tmp_path_factory):
    """A free pin that sinks in oil of 0.1 Pa s, where run.toml states another viscosity."""
    directory = tmp_path_factory.mktemp("sinking")
    rig = RigSettings(
        film="reynolds",
        tilt=0.0,
        viscosity=0.1,
        width=128,
        height=96,
        spacing=6.0,
        fixture_frames=1,
        dark_pages=4,
        flat_pages=3,
        bubbles=0,
    )
    simulate(directory, seed=5, rig=rig)
    erlif.process(
        directory / "run",
        calibration=small_rig.fixture / "calibration.nc",
        output=directory / "run" / "film.nc",
        workers=1,
    ).close()
    return directory / "run"


@pytest.fixture(scope="module")
def found(sinking):
    """The fit of that pin; never to be changed."""
    return fit_film(sinking)


def write_beside(run, film, path):
    """Write a changed film of a run with the frames of the original."""
    film.to_netcdf(path)
    with erlif.open_film(run / "film.nc", group="frames") as frames:
        frames.to_netcdf(path, group="frames", mode="a")


def test_free_pin_and_its_viscosity_are_found_in_photographs(found):
    assert found.candidates[0].name == "a pin that is free sideways"
    assert len(found.candidates) == 6
    viscosity = found.fit.estimates["viscosity"]
    assert abs(viscosity.value - 0.1) < 3 * viscosity.std
    assert viscosity.std < 0.2 * 0.1

    assert set(viscosity.parts) == {"fit", "clearance", "load", "tilt"}
    npt.assert_allclose(viscosity.parts["load"], 0.01 * viscosity.value, rtol=0.02)


@pytest.mark.usefixtures("two_models")
def test_the_clearance_enters_the_fit_as_in_a_film_of_other_radii(
    sinking, small_rig, found, tmp_path
):
    """The photographs are processed and fitted again with a bushing that is 5 um wider."""
    run = shutil.copytree(sinking, tmp_path / "wider")
    text = (run / "run.toml").read_text()
    assert "33.59 mm" in text
    (run / "run.toml").write_text(text.replace("33.59 mm", "33.595 mm"))
    calibration = small_rig.fixture / "calibration.nc"
    erlif.process(
        run, calibration=calibration, output=run / "film.nc", overwrite=True, workers=1
    ).close()
    wider, here = (one.fit.estimates["squeeze_time"] for one in (fit_film(run), found))

    # radii of 33.36 and 33.59 mm: each digit is 10 um, uniform over it
    change = abs(wider.value - here.value) / 5.0 * np.sqrt(2 / 12) * 10.0
    npt.assert_allclose(here.parts["clearance"], change, rtol=0.15)


@pytest.mark.usefixtures("two_models")
def test_the_law_of_the_oil_gives_drift_and_what_is_expected_of_it(sinking, tmp_path):
    """exp(b/(T - c)) falls by b/(T - c)^2 a kelvin: 5 % at 25 degC, where it is 0.13 Pa s."""
    place = tmp_path / "film.nc"
    law = 'vogel = { a = "0.05 mPa s", b = "1100 K", c = "-115 degC" }'
    with erlif.open_film(sinking / "film.nc") as film:
        text = re.sub(r'(?m)^viscosity = ".*"$', law, film.attrs["settings"], count=1)
        text = re.sub(r'reading_std = ".*"', 'reading_std = "2 K"', text)
        assert law in text
        assert '"2 K"' in text
        warm = float(film.temperature.mean())
        write_beside(sinking, film.assign_attrs(settings=text), place)
    found = fit_film(place).fit.estimates
    expected, falls = 5e-5 * np.exp(1100 / (warm + 115)), 1100 / (warm + 115) ** 2
    assert found["drift"].std < 2 * falls
    ratio = found["viscosity_ratio"]
    npt.assert_allclose(ratio.parts["temperature"], 2 * falls * ratio.value, rtol=1e-6)
    npt.assert_allclose(ratio.value, found["viscosity"].value / expected, rtol=1e-3)
    npt.assert_allclose(ratio.std, np.linalg.norm(list(ratio.parts.values())), rtol=1e-6)
    assert "temperature" in found


def test_film_states_in_one_line_which_physics_carries_it(sinking):
    with erlif.open_film(sinking / "film.nc") as film:
        lines = [line for line in summarise(film).splitlines() if "what carries the film" in line]
        assert str(film.attrs["physics"]) in lines[0]
    assert "Squeeze carries the film of a pin that is free sideways" in lines[0]
    assert "strong" in lines[0]


def test_the_transient_film_takes_the_true_viscosity(sinking):
    """0.1 Pa s; a guided pin has other films, and none."""
    source = read_film(sinking / "film.nc")
    with erlif.open_film(sinking / "film.nc") as film:
        kept, stated = film.load(), float(re.search(r'viscosity = "(\S+) Pa s"', film.settings)[1])
    attrs = kept.film_over_predicted.attrs
    assert abs(attrs["viscosity"] - 0.1) < 2.5 * attrs["viscosity_std"]
    assert attrs["viscosity_std"] < 0.02
    npt.assert_allclose(attrs["viscosity_given"], stated)
    line = next(one for one in describe_other_factors(kept).splitlines() if "transient" in one)
    assert f"takes {attrs['viscosity']:.3f} ±" in line
    options = source.settings.prediction.model_copy(update={"sideways": "guided"})
    guided = source.settings.model_copy(update={"prediction": options})
    assert state_physics(kept, guided, source.frames)[1] == {}


def test_a_tilt_that_moves_is_part_of_the_verdict(sinking):
    """A range of 2 a, of a sine; the errors of the tilt alone are no motion."""
    source = read_film(sinking / "film.nc")
    with erlif.open_film(sinking / "film.nc") as film:
        kept = film.load()
    assert "rocks" not in str(kept.attrs["physics"])
    tilt = kept.pin_tilt.values.copy()
    tilt[:, 0] += 0.08 * np.sin(np.arange(len(tilt)) * 2 * np.pi / len(tilt) + np.pi / 4)
    rocking = kept.assign(pin_tilt=(kept.pin_tilt.dims, tilt))
    text, _ = state_physics(rocking, source.settings, source.frames)
    said = re.match(
        r"The pin rocks by (\S+) nm/mm, which no model has; in its middle squeeze", text
    )
    npt.assert_allclose(float(said[1]), np.ptp(1e3 * tilt[:, 0]), rtol=0.05)


@pytest.mark.usefixtures("two_models")
def test_minima_determine_the_viscosity_where_positions_are_absent(sinking, tmp_path):
    path = tmp_path / "film.nc"
    with erlif.open_film(sinking / "film.nc") as film:
        write_beside(sinking, film.assign(pin_displacement=np.nan * film.pin_displacement), path)
    viscosity = fit_film(path).fit.estimates["viscosity"]
    assert abs(viscosity.value - 0.1) < 3 * viscosity.std
    assert viscosity.std < 0.3 * 0.1


def test_run_without_a_film_is_refused(lab):
    with pytest.raises(ErlifError, match="Run erlif process"):
        fit_film(lab.run)


def test_a_film_that_rises_under_its_load_is_carried_by_no_model(sinking, tmp_path, monkeypatch):
    """The films of a guided pin, which take half a minute, are left out."""
    path = tmp_path / "film.nc"
    with erlif.open_film(sinking / "film.nc") as film:
        place = film.pin_displacement.values.copy()
        place[:, 0] -= np.linspace(0.0, 5.0, len(place))
        moved = film.assign(pin_displacement=(film.pin_displacement.dims, place))
        write_beside(sinking, moved, path)
    asked = []

    def compare_quickly(*measured, sideways, **options):
        asked.append(sideways)
        return compare_models(*measured, sideways=["free"], **options)

    monkeypatch.setattr("erlif.pipeline.physics.fit.compare_models", compare_quickly)
    found = fit_film(path)
    assert found.carrier is None
    assert found.verdict.startswith("No model fits: ")
    assert asked == [["free", "guided"], ["free", "guided", "spring"]]


@pytest.mark.usefixtures("two_models")
def test_a_film_about_another_load_line_than_that_of_its_orbit_is_reported(
    sinking, found, tmp_path
):
    """The rig states its line, from which the positions of this film are turned by 3 mm."""
    place, radius = tmp_path / "film.nc", np.sqrt(33.36 * 33.59)
    with erlif.open_film(sinking / "film.nc") as film:
        off = film.load()
    line = off.pin_displacement.attrs["load_line"]
    cosine, sine = np.cos(3 / radius), np.sin(3 / radius)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    off["pin_displacement"] = off.pin_displacement.copy(data=off.pin_displacement.values @ turn.T)
    off["pin_displacement"].attrs["load_line"] = line + 3.0
    off.attrs["settings"] = re.sub(r"(?m)^load_line = .*$", "", off.attrs["settings"])
    write_beside(sinking, off, place)

    assert "load_line" not in " ".join(map(str, found.fit.notes))
    other = fit_film(place).fit
    estimate = other.estimates["load_line"]
    npt.assert_allclose(estimate.value, 1e-3 * line, atol=3 * estimate.std)
    notes = " ".join(map(str, other.notes))
    assert f"are about {line + 3:.2f} mm" in notes
    assert 'Set load_line = "' in notes
