"""Tables as CSV, read by the csv module."""

import csv

import numpy as np

from erlif.core.progress import silent
from erlif.io.conversion.table import write_map_table, write_trigger_table
from erlif.io.files import open_film


def read(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_a_table_of_triggers_gives_every_number_back(film, tmp_path):
    write_trigger_table(film, tmp_path / "film.csv")
    rows = read(tmp_path / "film.csv")
    assert len(rows) == 6
    for name, unit in (("film_min", "um"), ("rocker_speed", "rad s-1"), ("joint_load", "N")):
        found = [float(row[f"{name} [{unit}]"]) for row in rows]
        assert found == film[name].values.tolist()  # to the last bit
    assert [row["trigger"] for row in rows] == ["0", "1", "2", "3", "4", "5"]


def test_words_of_triggers_stand_in_the_table(film, tmp_path):
    words = np.array(["rigid", 'a "b", c', "", "d", "e", "f"], object)
    write_trigger_table(film.assign(regime=("trigger", words)), tmp_path / "film.csv")
    assert [row["regime"] for row in read(tmp_path / "film.csv")] == words.tolist()


def test_a_map_has_a_row_for_each_pixel(film, tmp_path):
    seen = []
    write_map_table(
        film, tmp_path / "map.csv", trigger=2, progress=lambda what, n, total: seen.append(n)
    )
    rows = read(tmp_path / "map.csv")
    assert len(rows) == 24 * 64
    assert seen[-1] == 24

    last = rows[-1]
    assert (last["x [mm]"], last["y [mm]"]) == ("15.75", "5.75")
    assert np.float32(last["thickness [um]"]) == film.thickness.values[2, -1, -1]
    flags = np.array([int(row["flags"]) for row in rows]).reshape(24, 64)
    np.testing.assert_array_equal(flags, film.flags.values[2])
    assert all((row["thickness [um]"] == "NaN") == (row["flags"] != "0") for row in rows)


def test_positions_have_no_rounding_error(film, tmp_path):
    tenths = film.assign_coords(x=("x", 0.1 * np.arange(64), {"units": "mm"}))
    write_map_table(tenths, tmp_path / "map.csv", trigger=0, progress=silent)
    assert read(tmp_path / "map.csv")[3]["x [mm]"] == "0.3"


def test_a_film_in_zarr_has_the_table_of_that_in_netcdf(film, film_path, tmp_path):
    """Names of regimes are texts of another type in zarr; its variables have no order."""
    store = tmp_path / "film.zarr"
    shuffled = film[sorted(film.data_vars, reverse=True)].drop_encoding()
    shuffled.to_zarr(store, zarr_format=3, consolidated=False)
    for path in (film_path, store):
        with open_film(path) as opened:
            write_trigger_table(opened, tmp_path / f"{path.suffix}.csv")
    found = (tmp_path / ".zarr.csv").read_bytes()
    assert found == (tmp_path / ".nc.csv").read_bytes()
    regimes = [row["film_regime"] for row in read(tmp_path / ".zarr.csv")]
    assert regimes == film.film_regime.values.tolist()
