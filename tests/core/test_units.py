"""Quantities with units: definitions, refusals of what would be misread, arbitrary text."""

import contextlib
import math
import pickle
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.core import units
from erlif.core.units import Quantity, parse_quantity

TABLE = tomllib.loads(Path(__file__).with_name("units.toml").read_text("utf-8"))


@pytest.mark.parametrize(("text", "unit", "value", "factor"), TABLE["known"])
def test_quantity_is_converted_to_the_requested_unit(text, unit, value, factor):
    value *= {"1": 1, "pi": math.pi}[factor]
    assert parse_quantity(text, unit) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(("text", "unit", "words"), TABLE["refused"])
def test_text_that_would_be_misread_is_refused(text, unit, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        parse_quantity(text, unit)


@pytest.mark.parametrize(("unit", "example"), [("rad", "5 deg"), ("delta_degC", "1 K")])
def test_the_example_of_a_message_has_the_unit_of_the_manual(unit, example):
    with pytest.raises(ValueError, match=f'such as "{example}"; got'):
        parse_quantity("5", unit)
    assert math.isfinite(parse_quantity(example, unit))


UNITS = [
    *("m", "rad", "rad/s", "N", "Pa", "Pa s", "1/Pa", "nm", "DN", "electron/DN"),
    *("electron", "degC", "delta_degC"),
]


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(UNITS))
def test_number_in_the_requested_unit_is_unchanged(value, unit):
    assert parse_quantity(f"{value!r} {unit}", unit) == value


def test_usual_units_are_converted_as_pint_converts_them():
    for unit, usual in units._USUAL.items():
        if unit == "HB":  # pint has no hardness
            continue
        # pint counts a turn as 6.28 and so 1 rpm as 0.105 Hz
        for name in set(usual) - ({"rpm"} if unit == "Hz" else set()):
            spelled = name.replace("mm3", "mm^3").replace("mm2", "mm^2")
            reference = units._registry().Quantity(3.7, spelled).to(unit).magnitude
            assert parse_quantity(f"3.7 {name}", unit) == pytest.approx(reference, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [("60 um", "m", 60e-6), ("5.5 cm", "m", 0.055), ("12.4 1/GPa", "1/Pa", 12.4e-9)],
)
def test_decimal_fractions_of_usual_units_are_exact(text, unit, value):
    assert parse_quantity(text, unit) == value


PIECES = [
    *("m", "cm", "/", "*", "**", "^", "(", ")", "-", "N", "Pa", "s", "1/", "°"),
    *("µ", "·", "²", "K", "0", "if", "px", "'", "\\"),
]


@settings(max_examples=150)
@given(
    st.one_of(
        st.text(max_size=12),
        st.lists(st.sampled_from([*PIECES, "5", ".5", "1e3", " "]), max_size=7).map("".join),
    ),
    st.sampled_from(UNITS),
)
def test_any_text_gives_a_finite_number_or_a_value_error(text, unit):
    with contextlib.suppress(ValueError):
        assert math.isfinite(parse_quantity("5 " + text, unit))


ENDLESS = [
    *("60 um^9^9^9", "60 um^(9^9^9)", "60 um^-9^9^9", "60 um*9999999999^9999999999"),
    *("5 m^9 ^9 ^9 ^9", "5 m^(2)^(99)^(99)^(99)", "5 mm/9^9^9^9", "5 um 9^9^9", "1 min^99999999"),
    *("5 m·9⁹⁹⁹⁹⁹⁹⁹", "5 m⁹^9^9", "5 m^9⁹⁹⁹", "5 (((((9^9)^9)^9)^9)^9)m"),
]


def test_powers_without_end_are_refused_at_once():
    """In a process with bounds on memory and time: python does not interrupt a power."""
    program = (
        "import resource, sys\n"
        "resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31))\n"
        "from erlif.core.units import parse_quantity\n"
        "for text in sys.argv[1:]:\n"
        "    try: parse_quantity(text, 'm')\n"
        "    except ValueError as error: print(error)\n"
    )
    command = [sys.executable, "-c", program, *ENDLESS]
    done = subprocess.run(command, capture_output=True, text=True, timeout=20, check=True)
    refused = done.stdout.splitlines()
    assert len(refused) == len(ENDLESS)
    assert all(repr(text) in line for text, line in zip(ENDLESS, refused, strict=True))


@pytest.mark.parametrize(
    ("text", "value"),
    [("8.8 g/cm^3", 8800), ("880 kg m^-3", 880), ("880 kg·m⁻³", 880), ("880 kg / m ^ 3", 880)],
)
def test_powers_of_units_are_read(text, value):
    assert parse_quantity(text, "kg/m^3") == pytest.approx(value)


def test_quantity_keeps_its_text_and_computes_as_a_float():
    load = Quantity(222.4, "50 lbf")
    assert load == 222.4
    assert type(load * 2) is float
    copy = pickle.loads(pickle.dumps(load))
    assert (copy, copy.text) == (222.4, "50 lbf")


@pytest.mark.parametrize(
    ("text", "period"), [("12 1/min", "5 s"), ("30 rpm", "2 s"), ("4 Hz", "0.25 s")]
)
def test_a_number_per_time_is_refused_with_its_period(text, period):
    with pytest.raises(ValueError, match=f'its period is "{period}"'):
        parse_quantity(text, "s")


@pytest.mark.parametrize("text", ["100 cSt", "100 mm^2/s"])
def test_a_kinematic_viscosity_is_refused_with_what_it_lacks(text):
    with pytest.raises(ValueError, match="multiply it by the density"):
        parse_quantity(text, "Pa s")
