"""Single values of a log."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from erlif.pipeline.audit.columns import find_lost, find_single, note_columns, without_single

ROWS = np.arange(50)
LOADS = {
    "even": np.full(50, 222.0),
    "noisy": 222 + 3 * np.random.default_rng(1).normal(size=50),
    "crank": 222 * (1 + 0.4 * np.cos(ROWS / 8)),
    "ramp": np.linspace(20, 400, 50),
    "steps": np.repeat([100.0, 20.0, 300.0, 40.0, 200.0], 10),
    "peaks of a drive": 50 + 400 * np.maximum(np.sin(ROWS / 4), 0) ** 8,
    "rounded": np.where(ROWS % 7 == 0, 222.1, 222.0),
}


@pytest.mark.parametrize("name", LOADS)
def test_a_load_that_truly_varies_has_no_single_value(name):
    assert find_single(LOADS[name]).size == 0
    assert find_lost(LOADS[name]).size == 0


@pytest.mark.parametrize("row", [0, 1, 24, 49])
@pytest.mark.parametrize("name", LOADS)
def test_a_load_a_thousand_times_the_others_is_found(name, row):
    load = LOADS[name].copy()
    load[row] *= 1000
    assert find_single(load).tolist() == [row]


@pytest.mark.parametrize("rows", [range(20, 30), range(10), range(2, 50, 5)])
def test_rows_without_load_are_found(rows):
    load = LOADS["crank"].copy()
    load[list(rows)] = 0.5
    assert find_lost(load).tolist() == list(rows)


def log(**columns):
    return xr.Dataset({name: ("frame", np.asarray(one)) for name, one in columns.items()})


def notes(table, vogel=None):
    settings = SimpleNamespace(oil=SimpleNamespace(vogel=vogel))
    return list(note_columns(SimpleNamespace(run=SimpleNamespace(log=table, settings=settings))))


def test_load_and_temperature_are_searched():
    load, temperature = LOADS["noisy"].copy(), np.full(50, 25.0)
    load[7], temperature[33] = 9000.0, 33.0
    found = notes(log(joint_load=load, temperature=temperature, number=ROWS))
    assert [note.subject for note in found] == ["temperature", "load"]
    assert all(note.level == "warning" for note in found)
    assert found[1].text.startswith("row 7 of the log: 9000, where all others are 2")


def test_a_column_of_unknown_meaning_may_have_single_values():
    """A sync pulse, and a level that counts something."""
    assert (
        notes(log(joint_load=LOADS["noisy"], sync=1 * (ROWS == 7), torque=3 + 90.0 * (ROWS == 7)))
        == []
    )


@pytest.mark.parametrize("vogel", [None, object()])
def test_a_temperature_counts_where_the_viscosity_follows_it(vogel):
    (note,) = notes(log(temperature=25.0 + 8 * (ROWS == 33)), vogel)
    assert ("theory count them" in note.text) == (vogel is not None)
    (note,) = notes(log(joint_load=220.0 + 9000 * (ROWS == 33)), vogel)
    assert "theory count them" in note.text


def test_rows_with_load_in_a_run_without_one_are_not_lost():
    load = np.where(ROWS < 30, 0.5, 220.0)
    assert find_lost(load).size == 0


def test_conditions_are_those_of_the_other_rows():
    temperature = np.full(50, 25.0)
    temperature[33] = 400.0
    kept = without_single(log(temperature=temperature))
    assert kept.temperature.values.tolist() == [25.0] * 49
