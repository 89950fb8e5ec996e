"""Bushings with lobes, wear, roughness or a liner, photographed by the rig."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from scenes.kept import kept_orbit, name_of
from scenes.measured import statistics_of

import erlif
from conftest import FULL, Laboratory
from erlif.core.errors import ConfigError
from erlif.io.files import region_of
from erlif.models.film import HAMROCK_DOWSON_LINE
from erlif.pipeline.physics import fit
from erlif.pipeline.physics.predict import read_film
from erlif.prediction.comparison import HELD, REGIME_MAP
from erlif.rig import RigSettings
from erlif.rig.film import bore_height
from erlif.rig.journal import follow_pin
from erlif.trend import cut_through_minimum, place_of_minimum

RIG = RigSettings(
    width=160,
    height=128,
    spacing=4.0,
    fixture_frames=6,
    dark_pages=8,
    flat_pages=4,
    bubbles=2,
    length=30.0,
    lobes=(-4.0, 4.5),
    lobe=(200.0, 20.0),
    axial_centre=0.3,
    film="reynolds",
    tilt=0.0,
    load=30.0,
    elapsed=2.1,
)
"""Twelve triggers; the film on the crests sinks from 11 to 5 um within the cycle."""

EXPECTED_WITHIN = 0.75
"""Share of 12 triggers within two standard deviations, of 0.954: three times the binomial less."""


def follow(time, rig, deflections=None):
    return kept_orbit(name_of(rig), lambda: follow_pin(time, rig, deflections))


@pytest.fixture(scope="module", autouse=True)
def coarse():
    """Squeezed films on half the cells, predictions without error, films without their physics.

    Other tests hold cells and error; one test asks for the physics.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("erlif.pipeline.film.state_physics", lambda *film: ("", {}))
        patch.setattr("erlif.models.reynolds.squeeze_tables._AXIAL", 8)
        patch.setattr("erlif.prediction.triggers.find_band", lambda one, at, *a, **b: 0 * one(at))
        yield


@pytest.fixture(scope="module")
def lab(tmp_path_factory) -> Laboratory:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("erlif.rig.journal.follow_pin", follow)
        return Laboratory.simulated(tmp_path_factory.mktemp("lobed"), seed=1, rig=RIG)


@pytest.fixture(scope="module")
def film(lab):
    return erlif.process(lab.run, output=lab.film, workers=1)


@pytest.fixture(scope="module")
def pressure(film):
    return erlif.pressure_from_film(film)


def within_two(error, std):
    return np.mean(np.abs(error) < 2 * std)


@pytest.mark.slow
def test_minimum_film_and_pin_are_those_of_the_rig(lab, film):
    truth = lab.truth
    assert within_two(film.film_min - truth.film_min.values, film.film_min_std) > EXPECTED_WITHIN
    true = np.stack([truth.pin_displacement_load, truth.pin_displacement_side], axis=1)
    std = np.sqrt(np.diagonal(film.pin_position_cov.values, axis1=1, axis2=2))
    error = film.pin_displacement.values - true
    assert within_two(error, std[:, :2]) > EXPECTED_WITHIN
    assert within_two(film.pin_tilt.values, std[:, 2:]) > EXPECTED_WITHIN
    # the formulas are those of a straight bore, which this one is not
    for name in ("film_over_hamrock_dowson", "film_over_theory"):
        assert np.isinf(film[name].attrs["formula_error"])
        assert film[name].attrs["formula_of"] == "of a straight bore"


@pytest.mark.slow
def test_film_along_the_axis_is_that_of_the_rig_within_its_bars(lab, film):
    """At some 500 axial places of 12 triggers, whose noise and marks are independent."""
    pulls = []
    low, high = region_of(film).x
    for trigger, true in enumerate(lab.truth.film.values):
        found = cut_through_minimum(film, trigger=trigger, exchanged=True)
        off = np.abs(film.x - place_of_minimum(film, trigger=trigger)["x"])
        mean = true[:, off < 0.05 * (high - low)].mean(axis=1)
        std = np.hypot(found.thickness_std, found.thickness_std_shared)
        pulls.append(((found.thickness - mean) / std).values)
    pulls = np.concatenate(pulls)
    pulls = pulls[np.isfinite(pulls)]
    assert pulls.size > 400
    assert 0.93 < np.mean(np.abs(pulls) < 2) < 0.98


@pytest.mark.slow
def test_predicted_film_is_that_of_the_lobes(lab, film):
    """By finite volumes, against the over-relaxed pressures of the rig."""
    np.testing.assert_allclose(film.film_predicted_min, lab.truth.film_min, rtol=0.01)
    assert "bore in [joint]" in film.film_predicted_min.attrs["notes"]


@pytest.mark.slow
def test_pressure_of_the_lobed_film_carries_the_load(lab, pressure):
    """To twice its stated error; no load is put in."""
    found = pressure
    assert (found.pressure_measured == 1).all()
    error = found.load_from_pressure - lab.truth.joint_load.values
    assert within_two(error, found.load_from_pressure_std) > EXPECTED_WITHIN
    assert (found.load_from_pressure_std < 2.0).all()  # N of 30


@pytest.mark.slow
def test_a_straight_gap_describes_no_lobes(lab):
    run = lab.copy_run(
        "straight",
        ("[joint.bore]\n", "[joint.none]\n"),
        ('[joint.none]\nlobes = ["-4 mm", "4.5 mm"]\n', ""),
        ('lobe_radius = "200 mm"\nlobe_height = "20 um"\n', ""),
    )
    assert np.isnan(statistics_of(run).film_min).sum() >= 10  # no smooth gap describes the map


@pytest.mark.slow
def test_measured_profile_of_the_lobes_gives_the_same_film(lab, film):
    """Of the circles of the rig, at 50 um: to the 2 nm between arc and chord, of all numbers."""
    run = lab.copy_run(
        "profile",
        ('lobes = ["-4 mm", "4.5 mm"]\n', 'profile = "bore.csv"\n'),
        ('lobe_radius = "200 mm"\nlobe_height = "20 um"\n', ""),
    )
    place = np.linspace(-15, 15, 601)
    rows = [
        f"{one:.3f},{height:.5f}"
        for one, height in zip(place, -bore_height(RIG, place), strict=True)
    ]
    (run / "bore.csv").write_text("\n".join(["axial_mm,height_um", *rows]), encoding="utf-8")
    measured = erlif.process(run, workers=1)
    for name in ("film_min", "pin_displacement", "film_predicted_min", "film_predicted_mean"):
        np.testing.assert_allclose(measured[name], film[name], atol=8e-3, err_msg=name)
    np.testing.assert_allclose(measured.film_min_std, film.film_min_std, rtol=0.02)
    digest = hashlib.sha256((run / "bore.csv").read_bytes()).hexdigest()
    whole = hashlib.sha256(bytes.fromhex(digest)).hexdigest()
    assert whole in str(measured.attrs)

    # of the film alone, without the file
    (run / "bore.csv").unlink()
    assert erlif.plots.film_along_axis(measured, trigger=3)


@pytest.mark.slow
def test_fit_finds_the_viscosity_of_the_rig(lab, film):
    """Within twice its stated error; a guided pin on this bore is no rival."""
    found = fit.fit_film(lab.film)
    viscosity = found.fit.estimates["viscosity"]
    assert abs(viscosity.value - RIG.viscosity) < 2 * viscosity.std < 0.06 * RIG.viscosity
    assert found.carrier == HELD["free"]
    assert set(found.not_fitted) == {HAMROCK_DOWSON_LINE, REGIME_MAP}
    source = read_film(lab.film)
    stated, _ = fit.state_physics(film, source.settings, source.frames)
    assert found.verdict.split(" Second")[0] == stated.split(" Second")[0]


@pytest.mark.slow
def test_load_line_is_found_in_the_orbit(lab, film):
    given = film.pin_displacement.attrs["load_line"]
    run = lab.copy_run("line", (f'load_line = "{given:g} mm"\n', ""))
    line = statistics_of(run, theory=True).pin_displacement.attrs
    assert line["load_line_source"] == "fitted"
    assert abs(line["load_line"] - given) < 2 * line["load_line_std"]


PLACE = np.linspace(-1.0, 1.0, 121)
FEW = replace(RIG, spacing=8.0)
"""Six triggers."""

WAVY = replace(
    FEW,
    lobes=None,
    profile=tuple((18 * PLACE**2 + 3 * np.cos(2 * np.pi * PLACE / 0.6) + 2 * PLACE).tolist()),
    roughness=0.4,
    rough=True,
    sideways="guided",
    load=45.0,
)
"""A worn bore with waves of 9 mm, whose roughness is in flow and picture."""

LINED = replace(FEW, lobes=None, liner=(2.0, 0.5, 0.4), load=120.0)
"""A straight bore, lined with 2 mm that yield by 0.8 um, under films of 8 to 6 um."""


@pytest.fixture(scope="module", params=[WAVY, LINED], ids=["wavy", "lined"])
def other(request, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        if request.param is WAVY:
            patch.setattr("erlif.rig.journal.follow_pin", follow)
        lab = Laboratory.simulated(tmp_path_factory.mktemp("other"), seed=1, rig=request.param)
    return lab, request.param, erlif.process(lab.run, output=lab.film, workers=1)


@pytest.mark.slow
def test_film_and_viscosity_of_a_worn_rough_or_lined_bore_are_found(other, monkeypatch):
    """The prediction of a lined one takes the highest yield, of 0.8 um, over the whole region."""
    lab, rig, film = other
    if rig is LINED and not FULL:  # the fit of a guided pin there takes as long as all the rest
        compare = fit._compare_models
        monkeypatch.setattr(fit, "_compare_models", lambda *a, **b: compare(*a[:3], ("free",)))
    error = film.film_min - lab.truth.film_min.values
    assert within_two(error, film.film_min_std) > EXPECTED_WITHIN
    atol = 0.15 if rig is LINED else 0.05  # um
    np.testing.assert_allclose(film.film_predicted_min, lab.truth.film_min, atol=atol)
    found = fit.fit_film(lab.film)
    viscosity = found.fit.estimates["viscosity"]
    assert abs(viscosity.value - rig.viscosity) < 2 * viscosity.std < 0.1 * rig.viscosity
    assert found.carrier == HELD[rig.sideways]
    reasons = [found.not_fitted[name] for name in (HAMROCK_DOWSON_LINE, REGIME_MAP)]
    assert all(("liner" if rig is LINED else "rough") in one for one in reasons)
    if rig is LINED:
        source = read_film(lab.film)
        assert fit.state_physics(film, source.settings, source.frames) == ("", {})
        with pytest.raises(ConfigError, match="includes the yield of a liner"):
            erlif.pressure_from_film(film)
