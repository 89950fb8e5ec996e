"""What both stores of maps share: finished triggers are found again, and only those."""

import numpy.testing as npt
import pytest
import xarray as xr
from scenes.stores import (
    FILM,
    GROUPS,
    contents,
    finish,
    maps_of,
    open_store,
    put,
    read_store,
    whole_film,
)


@pytest.fixture(params=["netcdf", "zarr"])
def kind(request):
    return request.param


@pytest.fixture
def whole(kind, tmp_path):
    """A film made without an interruption."""
    return whole_film(kind, tmp_path / "whole")


def test_finished_triggers_and_their_numbers_are_found_again(kind, tmp_path):
    store = open_store(kind, tmp_path)
    put(store, 0, 1)
    store.close()
    again = open_store(kind, tmp_path)
    assert [again.has(trigger) for trigger in range(4)] == [True, True, False, False]
    numbers = again.numbers(1)
    assert set(numbers) == {"mean", "drift"}
    assert numbers["mean"] == 1 / 3
    npt.assert_array_equal(numbers["drift"], [1, 2])
    again.close()


@pytest.mark.parametrize("stops", [[0], [1, 1, 3], [4]])
def test_a_film_resumed_any_number_of_times_has_the_same_bytes(kind, tmp_path, whole, stops):
    for stop in stops:
        store = open_store(kind, tmp_path / "parts")
        put(store, *(trigger for trigger in range(stop) if not store.has(trigger)))
        store.close()
    store = open_store(kind, tmp_path / "parts")
    put(store, *(trigger for trigger in range(4) if not store.has(trigger)))
    assert contents(finish(store)) == whole


def test_a_film_that_was_half_completed_is_completed_the_same(kind, tmp_path, whole):
    store = open_store(kind, tmp_path / "parts")
    put(store, 0, 1, 2, 3)
    store.finish(FILM, {"other": GROUPS["frames"], "frames": GROUPS["frames"]})
    store.close()
    again = open_store(kind, tmp_path / "parts")
    assert again.has(3)
    assert contents(finish(again)) == whole


def test_completed_film_holds_maps_coordinates_variables_groups_and_text(kind, tmp_path):
    store = open_store(kind, tmp_path)
    put(store, 0, 1, 2, 3)
    path = finish(store).rename(tmp_path / ("film.nc" if kind == "netcdf" else "film.zarr"))
    with read_store(path) as film:
        assert film.thickness.dims == ("trigger", "y", "x")
        assert film.thickness.attrs["units"] == "um"
        npt.assert_array_equal(film.flags.attrs["flag_masks"], [1, 2])
        xr.testing.assert_identical(film.drop_vars(list(maps_of(0))).load(), FILM)
        for trigger in range(4):
            expected = maps_of(trigger)
            npt.assert_allclose(film.thickness[trigger], expected["thickness"], atol=0.03)
            npt.assert_array_equal(film.flags[trigger], expected["flags"])
    with read_store(path, group="frames") as frames:
        assert frames.file_camera1.values.tolist() == ["a.tif", "ä.tif"]
