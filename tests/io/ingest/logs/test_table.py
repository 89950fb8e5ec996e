"""Names with units, and columns with text in them."""

import numpy as np
import pytest

from erlif.io.ingest.logs.table import LogColumn, split_unit


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
