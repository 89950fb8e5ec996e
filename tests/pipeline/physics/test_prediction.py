"""The transient prediction in the film: what it needs, where it stands, what it may not break."""

import tomllib

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.film import CRANK, LOAD, RUN_TOML, minimum_film

import erlif
from erlif.core.errors import ConfigError
from erlif.io.settings import RunSettings
from erlif.pipeline.physics.prediction import (
    NO_PREDICTION,
    build_motion,
    film_along_sliding,
    join_theories,
    predict_run,
    swinging_joint,
    swings,
    try_prediction,
)
from erlif.pipeline.plane import ObjectPlane

SLIDER = {"kind": "slider-crank", "crank": "5 cm", "coupler": "20 cm", "crank_speed": "60 rpm"}
PLACE = 0.06 * np.arange(300)
VOGEL = {"a": "0.05 mPa s", "b": "1100 K", "c": "-115 degC"}


def settings(*, without=(), mechanism=None, oil=None, axis="sliding", **options):
    raw = tomllib.loads(RUN_TOML)
    raw = {name: table for name, table in raw.items() if name not in without}
    raw["optics"] |= {"x_axis": axis, "pixel_pitch": "60 um"}
    raw["thickness"]["roi"] = {"x": [3.0, 14.94], "y": [0.0, 3.0]}
    raw |= {"mechanism": mechanism} if mechanism else {}
    raw |= {"oil": oil} if oil else {}
    return RunSettings.model_validate(raw | {"prediction": options})


def frames(**columns):
    number = CRANK.size
    columns = {"joint_load": np.full(number, LOAD)} | columns
    found = {name: ("frame", values) for name, values in columns.items()}
    return xr.Dataset(
        {
            "trigger": ("frame", np.arange(number)),
            "cycle": ("frame", np.zeros(number, int)),
            "crank_angle": ("frame", CRANK),
            "used": ("frame", np.ones(number, bool)),
        }
        | found
    )


def film():
    std = np.full(CRANK.size, 0.05)
    return xr.Dataset({"film_min": ("trigger", minimum_film()), "film_min_std": ("trigger", std)})


def plane(one):
    """300 columns of 60 um, of which 50 to 249 are in the region of interest."""
    return ObjectPlane(one, (100, PLACE.size))


def test_a_joint_swings_with_a_crank_rocker_and_an_oil():
    assert swings(settings())
    for other in (settings(without=["oil"]), settings(without=["joint", "oil"])):
        assert not swings(other)
        assert try_prediction(plane(other), film(), frames()) is NO_PREDICTION
    slider = settings(mechanism=SLIDER)
    assert not swings(slider)
    with pytest.raises(ConfigError, match="crank-rocker"):
        build_motion(slider, frames())


def test_the_load_line_is_that_of_the_settings_else_that_of_the_positions():
    place = ("trigger", "axis"), np.zeros((CRANK.size, 2)), {"load_line": 9.2}
    about = film().assign(pin_displacement=place)
    for expected, options, measured in [
        (9.6, {"load_line": "9.6 mm"}, about),
        (9.2, {}, about),
        (8.97, {}, film()),
    ]:
        one = plane(settings(start_film="20 um", **options))
        attrs = predict_run(one, measured, frames()).triggers.attitude.attrs
        assert attrs["load_line"] == pytest.approx(expected)


def test_the_predicted_map_is_thinnest_at_its_attitude_from_the_load_line():
    one = settings(load_line="7 mm", start_film="20 um")
    predicted = predict_run(plane(one), film(), frames()).triggers
    along = film_along_sliding(one, predicted, PLACE)
    thinnest = 7 + 0.58425 * predicted.attitude.values
    npt.assert_allclose(PLACE[along.argmin(axis=1)], thinnest, atol=0.031)


def test_settings_reach_the_solver():
    """A start film is kept, a guided pin stays on its line, and a long joint sinks less."""
    ends = {}
    for name, options in {
        "free": {},
        "guided": {"sideways": "guided"},
        "held": {"sideways": "900 kN/mm"},
        "long": {"long": True},
        "against": {"direction": "against"},
    }.items():
        one = settings(start_film="60 um", **options)
        ends[name] = predict_run(plane(one), film(), frames()).triggers
    for one in ends.values():
        npt.assert_allclose(one.film_predicted_min[0], 60.0, rtol=1e-6)
    npt.assert_allclose(ends["guided"].attitude, 0.0, atol=1e-9)
    # the film pushes sideways with a few times the load, up to 1.2 um against this spring
    aside = np.radians(ends["held"].attitude.values) * 170
    assert 0.1 < np.abs(aside).max() < 5 * LOAD / 900
    assert ends["long"].film_predicted_min[-1] > ends["free"].film_predicted_min[-1] + 0.5
    npt.assert_allclose(ends["against"].attitude, -ends["free"].attitude, atol=1e-6)


def test_a_warmer_oil_sinks_faster():
    """0.129 Pa s at 25 degC, 0.077 Pa s at 35 degC by Vogel's law: 1.68 times the rate."""
    oil = {"vogel": VOGEL, "pressure_viscosity": "0 1/Pa"}
    one, lost = settings(oil=oil, start_film="20 um"), []
    for temperature in (25.0, 35.0):
        warm = frames(temperature=np.full(CRANK.size, temperature))
        found = predict_run(plane(one), film(), warm).triggers.film_predicted_min.values
        lost.append((1e-3 / found[-1]) ** 0.5 - (1e-3 / 20.0) ** 0.5)
    assert lost[1] / lost[0] == pytest.approx(np.exp(1100 / 140 - 1100 / 150), rel=0.02)


def steady():
    attrs = {"units": "um", "regime": "isoviscous-rigid", "reason": "governs", "notes": ""}
    return xr.Dataset(
        {
            "film_theory": ("trigger", np.full(CRANK.size, 131.0), attrs),
            "film_hamrock_dowson": ("trigger", np.full(CRANK.size, 1.9), {"units": "um"}),
        }
    )


def test_the_transient_film_is_the_theory_and_the_steady_ones_stay_for_reference():
    one = settings()
    predicted = predict_run(plane(one), film(), frames()).triggers
    found = join_theories(one, steady(), predicted)
    npt.assert_array_equal(found.film_predicted_min, predicted.film_predicted_min)
    npt.assert_array_equal(found.film_theory, 131.0)
    assert found.film_predicted_min.attrs["regime"] == "transient Reynolds, pin free sideways"
    assert "fitted to the measured minima" in found.film_predicted_min.attrs["notes"]
    # 24.426 degrees, half of 60/114 s, and 33.36 mm times half the swing (thesis, Appendix A)
    reason = "swings by 24.4 deg in 0.263 s and carries oil 7.11 mm to and fro"
    for name in ("film_theory", "film_hamrock_dowson"):
        assert reason in found[name].attrs["comment"]


def test_deflecting_surfaces_are_named_as_a_limit():
    one = settings(sideways="12 N/mm", start_film="20 um")
    elastic = steady()
    elastic.film_theory.attrs["regime"] = "piezoviscous-elastic"
    predicted = predict_run(plane(one), film(), frames()).triggers
    attrs = join_theories(one, elastic, predicted).film_predicted_min.attrs
    assert "takes the surfaces as rigid" in attrs["notes"]
    assert "20 um at the first frame, as given" in attrs["notes"]
    assert attrs["regime"].endswith("pin held sideways by 12 N/mm")


def test_a_film_is_kept_whose_prediction_fails(lab):
    lab.edit("run/run.toml", ("[joint]", '[prediction]\nstart_film = "1 mm"\n[joint]'))
    film = erlif.process(lab.run)
    assert "film_predicted_min" not in film
    assert np.isfinite(film.film_min).all()
    assert film.film_theory.attrs["regime"].startswith("isoviscous")
    assert "[prediction]: the film over the cycle is not predicted" in film.attrs["notes"]


@pytest.mark.parametrize(
    ("chosen", "words"),
    [
        (settings(without=["oil"]), r"the pressure .* run.toml has no \[oil\]"),
        (settings(without=["oil", "joint"]), r"no \[joint\] and \[oil\]"),
        (settings(mechanism=SLIDER), 'this run has kind "slider-crank"'),
    ],
)
def test_what_a_joint_lacks_to_swing_is_named(chosen, words):
    with pytest.raises(ConfigError, match=words):
        swinging_joint(chosen, "the pressure")
