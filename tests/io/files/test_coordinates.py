"""Angle, stroke and time are coordinates of a film, whichever version wrote it."""

import shutil

import h5py
import xarray as xr

import erlif
from erlif.io.files import set_coordinates

PLACES = {"encoder_angle", "crank_angle", "stroke", "time"}


def test_a_film_opened_without_erlif_has_its_coordinates(film):
    with xr.open_dataset(film, engine="h5netcdf") as opened:
        assert set(opened.coords) >= PLACES
        assert set(opened.thickness.isel(trigger=2).coords) >= {*PLACES, "x", "y", "trigger"}
        assert "crank_angle" in opened.film_min.coords
    with xr.open_dataset(film, engine="h5netcdf", group="frames") as frames:
        assert set(frames.coords) >= {"trigger", "cycle", "time"}


def test_each_map_names_its_coordinates(film):
    with h5py.File(film) as file:
        for name in ("thickness", "thickness_std", "flags", "film_min"):
            assert set(file[name].attrs["coordinates"].decode().split()) == PLACES


def test_a_film_of_an_earlier_version_gets_its_coordinates_when_it_is_opened(film, tmp_path):
    old = shutil.copy(film, tmp_path / "old.nc")
    with h5py.File(old, "r+") as file:
        for entry in file.values():
            entry.attrs.pop("coordinates", None)
    with xr.open_dataset(old, engine="h5netcdf") as plain:
        assert not PLACES & set(plain.coords)
    with erlif.open_film(old) as found:
        assert set(found.coords) >= PLACES


def test_closing_a_film_with_its_coordinates_closes_its_file():
    film = xr.Dataset({"stroke": ("trigger", [1])})
    closed = []
    film.set_close(lambda: closed.append(True))
    set_coordinates(film).close()
    assert closed == [True]


def test_variables_on_other_dims_stay_variables():
    film = xr.Dataset({"time": ("sample", [0.1]), "stroke": ("trigger", [1])})
    assert set(set_coordinates(film).coords) == {"stroke"}
