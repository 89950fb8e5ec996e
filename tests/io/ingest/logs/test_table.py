"""Names with units, and columns with text in them."""

import math

import numpy as np
import pint
import pytest

from erlif.io.ingest.logs.table import UNITS, LogColumn, find_scale, is_unit, split_unit


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("Encoder [deg]", ("Encoder", "deg")),
        ("Force (N)", ("Force", "N")),
        ("Winkel_[°]", ("Winkel", "°")),
        ("Kraft / kN", ("Kraft", "kN")),
        ("Temperatur in °C", ("Temperatur", "°C")),
        ("angle_deg", ("angle_deg", "")),
        ("Dev1/ai0", ("Dev1/ai0", "")),
        ("[deg]", ("[deg]", "")),
    ],
)
def test_the_unit_is_parted_from_the_name(name, parts):
    assert split_unit(name) == parts


def test_a_column_is_text_where_a_cell_is_neither_empty_nor_a_number():
    values = np.array([1.5, np.nan, 2.0])
    np.testing.assert_array_equal(LogColumn("a", "", values, {1: ""}).free(), values)
    np.testing.assert_array_equal(LogColumn("a", "", values, {1: "nan"}).free(), values)
    assert LogColumn("a", "", values, {1: "off"}).free().tolist() == ["1.5", "off", "2"]


REGISTRY = pint.UnitRegistry()


@pytest.mark.parametrize(
    ("quantity", "unit"),
    [
        (quantity, unit)
        for quantity, units in UNITS.items()
        for unit in units
        if unit not in ("tick", "1")
    ],
)
def test_every_unit_agrees_with_pint(quantity, unit):
    scale = find_scale(quantity, unit)
    result = scale.unit.replace(" s-1", "/s")
    for value in (0.0, 1.0, 37.0):
        expected = REGISTRY.Quantity(value, unit.replace("rev", "turn")).to(result).magnitude
        assert math.isclose(value * scale.factor + scale.offset, expected, abs_tol=1e-9)


@pytest.mark.parametrize(
    ("quantity", "spelled", "unit"),
    [
        ("angle", "°", "degree"),
        ("angle", "Degrees", "degree"),
        ("temperature", "°C", "degree_Celsius"),
        ("temperature", "C", "degree_Celsius"),
        ("speed", "1/min", "rad s-1"),
        ("time", "sec", "s"),
        ("temperature", "Deg C", "degree_Celsius"),  # of NI-DAQmx, as the next
        ("pulse_energy", "Volts", "V"),
    ],
)
def test_usual_spellings_are_accepted(quantity, spelled, unit):
    assert find_scale(quantity, spelled).unit == unit


def test_a_unit_of_another_quantity_is_none():
    assert find_scale("load", "deg") is None
    assert find_scale("angle", "grad") is None  # 400 in a turn or 360, by country
    assert is_unit("V")
    assert not is_unit("Force")
