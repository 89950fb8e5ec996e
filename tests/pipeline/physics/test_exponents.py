"""The power of speed over load that minimum and mean film follow."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.film import run_settings
from scenes.results import make_result

from erlif.pipeline.physics.exponents import (
    describe_exponents,
    note_moved_mean,
    note_steepness,
)
from erlif.pipeline.plane import ObjectPlane


@pytest.fixture
def power_law():
    """Triggers whose minimum follows the power 0.62 and whose mean follows 0.4."""
    speed, load = np.linspace(0.5, 2.5, 12), np.full(12, 222.0)
    film = xr.Dataset({"rocker_speed": ("trigger", speed), "joint_load": ("trigger", load)})
    nothing = np.zeros(3)
    results = [
        make_result(
            minimum=3 * value**0.62, mean=6 * value**0.4, random=0.01, surface=0.0, gradient=nothing
        )
        for value in speed
    ]
    return film, results


def test_exponents_are_those_of_minimum_and_mean(power_law, calibration):
    found = xr.Dataset(describe_exponents(*power_law, calibration))
    npt.assert_allclose([found.speed_exponent, found.speed_exponent_mean], [0.62, 0.4], rtol=1e-6)
    assert found.speed_exponent.attrs["triggers_used"] == 12


def test_exponents_follow_the_logged_speed_where_there_is_one(power_law, calibration):
    """A logged speed with the power m of the computed one: film ~ v^0.62 = (v^m)^(0.62/m)."""
    film, results = power_law
    load = film["joint_load"].values
    logged = load * (np.abs(film.rocker_speed.values) / load) ** 1.25
    known = film.assign(sliding_speed=("trigger", logged, {"source": "log"}))
    found = xr.Dataset(describe_exponents(known, results, calibration))
    npt.assert_allclose(found.speed_exponent, 0.62 / 1.25, rtol=1e-6)
    assert found.speed_exponent.attrs["speed"] == "sliding_speed"


@pytest.mark.parametrize(
    ("beyond", "whole", "power"), [(0.019, 0, 0.4), (0.3, 5, 0.4), (0.3, 4, None)]
)
def test_a_mean_of_a_part_of_the_region_has_no_exponent(
    power_law, calibration, beyond, whole, power
):
    """Triggers beyond the range by more than 2 % have no part in it, as in `erlif compare`."""
    film, results = power_law
    parts = [
        replace(one, statistics=replace(one.statistics, beyond_range=beyond if k >= whole else 0.0))
        for k, one in enumerate(results)
    ]
    found = xr.Dataset(describe_exponents(film, parts, calibration))
    npt.assert_allclose(found.speed_exponent, 0.62, rtol=1e-6)
    if power is None:
        assert np.isnan(found.speed_exponent_mean)
        assert found.speed_exponent_mean.attrs["triggers_used"] == whole
    else:
        npt.assert_allclose(found.speed_exponent_mean, power, rtol=1e-6)
        assert found.speed_exponent_mean.attrs["triggers_used"] == (whole or 12)


@pytest.mark.parametrize(("swing", "moves"), [(0.02, False), (4.0, True)])
def test_a_mean_that_follows_the_place_of_the_minimum_has_no_exponent(calibration, swing, moves):
    """A minimum of 5 um at every speed, which moves by a swing [mm] as the speed rises."""
    speed = np.linspace(0.4, 2.5, 12)
    side = swing * (speed / 2.5) / np.sqrt(33.36 * 33.59)
    plane = ObjectPlane(run_settings(), (64, 80))
    line = plane.view.load_line
    angle = (plane.along[plane.within] - line) / plane.view.radius
    films = 230 - 225 * np.cos(angle - side[:, np.newaxis]).mean(axis=1)
    results = [make_result(mean=one, random=0.005, gradient=np.zeros(3)) for one in films]
    place = 225 * np.stack([np.cos(side), np.sin(side)], axis=1)
    columns = {"rocker_speed": speed, "joint_load": np.full(12, 222.0)}
    film = xr.Dataset({name: ("trigger", one) for name, one in columns.items()})
    film["pin_displacement"] = ("trigger", "axis"), place, {"load_line": line}

    found = xr.Dataset(describe_exponents(film, results, calibration, plane=plane))
    assert np.isnan(found.speed_exponent_mean) == moves
    assert ("geometric" in found.speed_exponent_mean.attrs) == moves
    assert [note.subject for note in note_moved_mean(found)] == ["film_mean"] * moves
    if moves:  # the minimum is constant: all of the exponent is that of its place
        attrs = found.speed_exponent_mean.attrs
        npt.assert_allclose(attrs["geometric"], attrs["fitted"], rtol=1e-3)


def test_marks_of_the_surfaces_widen_the_exponent_of_the_minimum_alone(power_law, calibration):
    film, results = power_law
    plain = xr.Dataset(describe_exponents(film, results, calibration))
    marked = []
    for one in results:
        gap = one.statistics.gap
        gap = gap._replace(minimum=gap.minimum._replace(surface_std=0.2))
        marked.append(replace(one, statistics=replace(one.statistics, gap=gap)))
    found = xr.Dataset(describe_exponents(film, marked, calibration))
    assert found.speed_exponent_std > 2 * plain.speed_exponent_std
    assert found.speed_exponent_mean_std == plain.speed_exponent_mean_std


def test_central_film_has_an_exponent_where_there_is_one(power_law, calibration):
    film, results = power_law
    assert "speed_exponent_central" not in describe_exponents(film, results, calibration)
    films = 4 * film.rocker_speed.values**0.67
    changed = []
    for one, value in zip(results, films, strict=True):
        gap = one.statistics.gap
        gap = gap._replace(central=gap.central._replace(value=value))
        changed.append(replace(one, statistics=replace(one.statistics, gap=gap)))
    film = film.assign(film_central=("trigger", films))
    found = xr.Dataset(describe_exponents(film, changed, calibration))
    npt.assert_allclose([found.speed_exponent_central, found.speed_exponent], [0.67, 0.62], 1e-6)


def pin_speed(crank, angle):
    """Of the pin of a crank [cm] on a rod of 44 cm, over the speed of the crank."""
    ratio = crank / 44
    return 1 + ratio * np.cos(angle) / np.sqrt(1 - (ratio * np.sin(angle)) ** 2)


@pytest.mark.parametrize(
    ("stated", "steep"), [(16.0, False), (15.0, False), (8.0, False), (3.0, True), (1.6, True)]
)
def test_a_film_steeper_than_its_speed_allows_is_of_other_links(stated, steep):
    """Films follow the power 0.62 of the speed of a crank of 16 cm."""
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    columns = {
        "rocker_speed": pin_speed(stated, angle),
        "crank_angle": np.degrees(angle),
        "film_min": 5 * pin_speed(16.0, angle) ** 0.62,
    }
    film = xr.Dataset({name: ("trigger", values) for name, values in columns.items()})
    found = note_steepness(film)
    assert len(found) == steep
    assert all("lengths of the links" in note.text for note in found)
    assert not note_steepness(film.drop_vars("crank_angle"))
    assert not note_steepness(film.assign(film_min=film.film_min[::-1].copy() * np.nan))
    rounded = 2.0 + 4e-16 * np.arange(film.sizes["trigger"])  # of a disc
    assert not note_steepness(film.assign(rocker_speed=("trigger", rounded)))
