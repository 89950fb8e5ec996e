"""Units of log columns against their definitions."""

import math

import pint
import pytest

from erlif.io.ingest.logs.units import UNITS, find_scale, is_unit

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
