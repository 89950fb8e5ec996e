"""What the page receives."""

import json
import struct

import numpy as np
import numpy.testing as npt
import pytest
from scenes.motion import DISC, SLIDER, film_of

from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.show.plots import example_film
from erlif.show.plots.prediction import predicted_map
from erlif.show.view import queries
from erlif.show.view.films import open_films
from erlif.show.view.queries import Request, describe_cycle

PIXEL = ("value", "std", "std_shared", "predicted")
MAP = {"film": "0", "trigger": "2", "layer": "thickness", "window": "0,0,64,24", "room": "640,240"}


@pytest.fixture(scope="module")
def films(example_path):
    found = open_films([example_path, example_path])
    yield found
    for one in found:
        one.close()


@pytest.fixture
def ask(films):
    """A request with some values changed."""
    return lambda **values: Request(films, {**MAP, **{k: str(v) for k, v in values.items()}})


def unpack(message):
    (length,) = struct.unpack("<I", message[:4])
    about = json.loads(message[4 : 4 + length])
    count = about["shape"][0] * about["shape"][1]
    values = np.frombuffer(message, "<f4", count, 4 + length).reshape(about["shape"])
    flags = np.frombuffer(message, np.uint16, count, 4 + length + 4 * count)
    return about, values, flags.reshape(about["shape"])


def test_a_map_arrives_as_it_is_stored(ask):
    about, values, flags = unpack(queries.pack_map(ask()))
    film = example_film().isel(trigger=2)
    npt.assert_array_equal(values, film.thickness.values)
    npt.assert_array_equal(flags, film.flags.values)
    assert about["text"].startswith("trigger 2, ")
    assert sum(about["shares"]) == pytest.approx(np.count_nonzero(film.flags) / film.flags.size)


def test_a_small_screen_receives_means(ask):
    about, values, _ = unpack(queries.pack_map(ask(room="16,6", window="16,0,64,24")))
    assert (about["step"], about["shape"], about["window"]) == (4, [6, 12], [16, 0, 64, 24])
    stored = example_film().thickness.values[2][:, 16:]
    expected = stored.astype(float).reshape(6, 4, 12, 4).mean((1, 3))
    npt.assert_allclose(values, expected, rtol=1e-6)


def test_a_difference_is_that_of_the_films(ask):
    values = unpack(queries.pack_map(ask(layer="difference", film2=1, trigger2=5)))[1]
    film = example_film().thickness.values
    npt.assert_allclose(values, film[5] - film[2], rtol=1e-6)
    _, pull, _ = unpack(queries.pack_map(ask(layer="significance", film2=1, trigger2=5)))
    npt.assert_allclose(pull, values / np.float32(0.05 * 2**0.5), rtol=1e-5)


def test_profile_region_and_pixel_agree_with_the_film(ask):
    film = example_film().isel(trigger=2)
    profile = queries.send_profile(ask(line="0,3,15.75,3", width=1))
    row = film.thickness.values[12]
    assert profile["value"][:2] == [None, None]  # outside the overlap
    npt.assert_allclose(profile["value"][2:], row[2:], rtol=1e-5)

    region = queries.send_region(ask(region="5,10,3,5"))
    inside = film.thickness.sel(x=slice(5, 10), y=slice(3, 5)).values
    assert region["count"] == inside.size
    assert region["mean"] == pytest.approx(float(inside.astype(float).mean()))
    assert region["mean_std"] == pytest.approx(0.05 / inside.size**0.5, rel=1e-5)

    pixel = queries.send_pixel(ask(place="10.05,3.04"))
    assert (pixel["column"], pixel["row"], pixel["unit"], pixel["flags"]) == (40, 12, "µm", 0)
    expected = [row[40], 0.05, 0.02, profile["predicted"][40]]
    npt.assert_allclose([pixel[name] for name in PIXEL], expected, rtol=1e-5)
    flagged = queries.send_pixel(ask(place="2.75,1"))
    assert flagged["flags"] == Flag.NO_FILM
    assert flagged["value"] is None


def test_theory_stands_beside_the_measured_film(ask):
    film = example_film()
    predicted = predicted_map(film, trigger=2)
    _, values, flags = unpack(queries.pack_map(ask(layer="predicted")))
    npt.assert_allclose(values, predicted, rtol=1e-6)
    assert not flags.any()
    _, values, flags = unpack(queries.pack_map(ask(layer="residual")))
    npt.assert_allclose(values, film.thickness.values[2] - predicted, atol=1e-5)
    npt.assert_array_equal(flags, film.flags.values[2])
    profile = queries.send_profile(ask(line="0,3,15.75,3", width=1))
    npt.assert_allclose(profile["predicted"], predicted[12], rtol=1e-5)
    assert "predicted" not in queries.send_profile(
        ask(line="0,3,15.75,3", width=1, layer="thickness_std")
    )


def test_the_first_profile_is_the_row_of_the_minimum():
    film = example_film()
    middle = 0.25 * (film.sizes["y"] - 1) / 2
    described = queries.describe_film(film, "a", "film.nc", [])
    npt.assert_allclose(described["line"], [0.0, middle, 15.75, middle])
    row = np.full(film.sizes["trigger"], 4.0)
    described = queries.describe_film(film.assign(film_min_y=("trigger", row)), "a", "film.nc", [])
    npt.assert_allclose(described["line"], [0.0, 1.0, 15.75, 1.0])


def test_maps_are_exported_in_two_formats_alone(ask):
    for kind in ("csv", "tiff"):
        assert len(queries.export(ask(kind=kind))) > 40
    with pytest.raises(ErlifError, match="Expected an export"):
        queries.export(ask(kind="exe"))


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("film", (2, -1)),
        ("trigger", (6, "")),
        ("layer", ("../film", "difference", "log_ratio")),
        ("window", ("0,0,nan,1", "0,0,1")),
        ("room", ("a,b",)),
    ],
)
def test_a_request_for_something_else_is_refused(ask, films, name, values):
    for value in values:
        with pytest.raises(ErlifError, match="Expected"):
            queries.pack_map(ask(**{name: value}))
    with pytest.raises(ErlifError, match="Expected"):
        queries.pack_map(ask(layer="difference", film2=1, trigger2=99))
    for body in (b"", b"[]", b"{}", b'{"film": 0, "region": [1, 2]}', b"\xff"):
        with pytest.raises(ErlifError, match="Reload the page"):
            queries.change_region(films, body)


def test_a_region_is_shown_before_it_is_written(film, tmp_path):
    file = tmp_path / "run.toml"
    file.write_text("[run]\nname = 'a'\n")
    films = open_films([film], [tmp_path])
    wanted = {"film": 0, "region": [1.0, 6.5, 0.0, 5.0]}

    def send(**more):
        return queries.change_region(films, json.dumps({**wanted, **more}).encode())

    shown = send()
    assert "roi" not in file.read_text()
    assert "+roi = {x = [1.0, 6.5], y = [0.0, 5.0]}" in shown["change"]
    with pytest.raises(ErlifError, match="Make the change again"):
        send(confirmed=True)
    with pytest.raises(ErlifError, match="32 x 32 pixels"):
        send(confirmed=True, before=shown["before"], region=[1, 1.2, 0, 5])
    assert "roi" not in file.read_text()
    send(confirmed=True, before=shown["before"])
    assert "roi = {x = [1.0, 6.5], y = [0.0, 5.0]}" in file.read_text()
    films[0].close()


def test_the_numbers_are_those_of_the_film():
    film = example_film()
    cycle = json.loads(json.dumps(describe_cycle(film), allow_nan=False))
    for name in ("film_mean", "film_min_std", "joint_load", "film_predicted_min"):
        np.testing.assert_allclose(cycle["columns"][name], film[name].values, rtol=1e-5)
    low, high = cycle["limits"]
    assert low < float((film.film_min - film.film_min_std).min()) < 3
    assert float((film.film_mean + film.film_mean_std).max()) < high < 5
    assert (cycle["units"]["joint_load"], cycle["units"]["film_mean"]) == ("N", "um")
    assert cycle["stroke"] == film.stroke.values.astype(int).tolist()


def test_a_film_at_rest_has_the_number_of_its_triggers():
    cycle = describe_cycle(
        example_film()[["film_mean", "film_min"]].reset_coords(drop=True).drop_vars("trigger")
    )
    assert cycle["axes"] == {"trigger": "trigger"}
    assert cycle["columns"]["trigger"] == [0, 1, 2, 3, 4, 5]
    assert cycle["stroke"] == [0] * 6


def test_a_disc_is_drawn_against_its_own_angle():
    for mechanism, axes in (
        (DISC, ["disc angle [°]", "encoder angle [°]"]),
        (SLIDER, ["drive angle [°]", "encoder angle [°]"]),
    ):
        assert list(describe_cycle(film_of(mechanism))["axes"].values())[:2] == axes
    assert next(iter(describe_cycle(example_film())["axes"])) == "encoder_angle"


def test_the_steady_theory_is_drawn_where_there_is_no_transient_one():
    film = example_film()
    assert "film_theory" not in describe_cycle(film)["films"]
    steady = film.drop_vars(["film_predicted_min", "film_predicted_mean"])
    assert "film_theory" in describe_cycle(steady)["films"]
    assert "film_theory" in describe_cycle(steady)["columns"]
