"""A function given the wrong product names the one it wants and how to get it."""

import inspect

import numpy as np
import pytest
import xarray as xr

import erlif
from erlif.core.errors import ErlifError
from erlif.io.files.kinds import KINDS
from erlif.io.files.wanted import PRODUCTS, takes
from erlif.pipeline.physics.fit import fit_film
from erlif.show import plots
from erlif.show.report import write_report

STEPS = ("erlif.", "film.erlif", "Name", "Make one with")
"""How a next step begins."""


@pytest.fixture(scope="module")
def products():
    film = plots.example_film()
    return {
        "film": film,
        "calibration": plots.example_calibration(),
        "frames": plots.example_frames(),
        "registration": plots.example_registration(),
        "images": plots.example_images(film, trigger=1),
        "pressure": plots.example_pressure(),
        "prediction": xr.Dataset({"film_predicted": film.thickness, "film_min": film.film_min}),
        "array": film.thickness,
        "number": 3,
    }


def refuse(call, *words):
    with pytest.raises(ErlifError) as found:
        call()
    text = str(found.value)
    assert any(step in text for step in STEPS), text
    for word in words:
        assert word in text
    return text


def drawings():
    """Each figure with the arguments that are products, by the kind of the first."""
    for name in plots.__all__:
        function = getattr(plots, name)
        if not inspect.isfunction(function) or name.startswith(("example", "write", "find")):
            continue
        first = next(iter(inspect.signature(function).parameters), "")
        if first in PRODUCTS and hasattr(function, "__wrapped__"):
            yield function, PRODUCTS[first]


def test_every_figure_refuses_another_product(products):
    found = list(drawings())
    assert {"thickness_map", "ratio_against_thickness", "displacement_map"} <= {
        draw.__name__ for draw, _ in found
    }
    assert len(found) > 30
    for draw, kind in found:
        needed = {
            one.name: products.get(PRODUCTS.get(one.name, ""), 0)
            for one in inspect.signature(draw).parameters.values()
            if one.default is one.empty
        }
        for given in {"film", "calibration", "array"} - {kind}:
            wrong = needed | {next(iter(needed)): products[given]}
            refuse(lambda: draw(**wrong), f"Expected {KINDS[kind].words}")  # noqa: B023


def test_a_path_is_opened_where_a_film_is_wanted(film):
    drawn = plots.thickness_map(str(film), trigger=1)
    assert drawn.get_array().shape == (96, 128)
    assert "6 triggers" in erlif.summarise(film)
    assert plots.drift_of_frames(film)


RUN, FIXTURE = "data_samples/straight_bushing", "calibration/wedge"
CALLS = [
    (lambda p: erlif.process(p["film"]), "a run directory", "got a film"),
    (lambda p: erlif.process(FIXTURE), "run.toml", "fixture.toml"),
    (lambda p: erlif.process(RUN, calibration=p["film"]), "calibration=", "got a film"),
    (lambda p: erlif.process(RUN, output=p["film"]), "output=", "got a film"),
    (lambda p: erlif.calibrate(p["calibration"]), "a fixture directory", "got a calibration"),
    (lambda p: erlif.calibrate(RUN), "fixture.toml", "run.toml"),
    (lambda p: erlif.check(p["film"]), "a directory", "got a film"),
    (lambda p: erlif.budget(p["film"]), "a run directory", "got a film"),
    (lambda p: erlif.budget(RUN, calibration=p["number"]), "a calibration", "got int"),
    (lambda p: erlif.predict(p["film"]), "of a film", "got a film"),
    (lambda p: fit_film(p["prediction"]), "of a film", "got a prediction"),
    (lambda p: erlif.pressure_from_film(p["prediction"]), "a film", "got a prediction"),
    (lambda p: erlif.pressure_from_film(RUN), "film file", "directory"),
    (lambda p: erlif.summarise(p["calibration"]), "a film", "got a calibration"),
    (lambda p: erlif.batch([p["film"]]), "a run directory", "got a film"),
    (lambda p: erlif.init(p["film"]), "a directory", "got a film"),
    (lambda p: erlif.simulate(p["film"]), "directory", "got Dataset"),
    (lambda p: erlif.simulate("nowhere", rig={"width": 64}), "RigSettings", "got dict"),
    (lambda p: erlif.open_film(p["film"]), "path", "got a film"),
    (lambda p: erlif.open_calibration(p["calibration"]), "a path", "got a calibration"),
    (lambda p: erlif.open_calibration(FIXTURE), "calibration file", "directory"),
    (lambda p: erlif.save_calibration(p["film"], "a.nc"), "a calibration", "got a film"),
    (lambda p: write_report(p["film"], "a.html"), "path of a film", "got a film"),
    (lambda p: erlif.pipeline.restore_images(p["film"], RUN, trigger=0), "of a film", "got a film"),
]


@pytest.mark.parametrize(("call", "wanted", "given"), CALLS)
def test_what_is_wanted_and_what_was_given_are_named(products, call, wanted, given):
    with pytest.raises(ErlifError) as found:
        call(products)
    text = str(found.value)
    assert wanted in text
    assert given in text
    assert text.endswith((".", "calibration.nc", "FIXTURE_DIR", "RUN_DIR", "film.nc")), text


def test_a_file_of_another_kind_is_named(tmp_path):
    small = xr.Dataset({"film_predicted": (("trigger", "y", "x"), np.ones((1, 2, 2)))})
    small.to_netcdf(tmp_path / "prediction.nc", engine="h5netcdf")
    with pytest.raises(ErlifError, match="open_dataset"):
        erlif.open_film(tmp_path / "prediction.nc")


def test_the_file_of_an_open_film_is_named_where_a_path_is_wanted(film):
    with erlif.open_film(film) as opened:
        refuse(lambda: write_report(opened, "a.html"), f"Name its file: {film}")


def test_a_call_that_lacks_an_argument_is_refused_as_by_python():
    @takes(film="film")
    def draw(film, *, trigger):
        return trigger

    with pytest.raises(TypeError, match="trigger"):
        draw(xr.Dataset())
    refuse(lambda: draw(None, trigger=3), "a film as film=, got None")
