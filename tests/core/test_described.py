"""A dataset of results has units and names of all its variables."""

from erlif.core.described import describe


def test_variables_carry_units_and_names():
    found = describe(
        {"depth": ("angle", [1.0, 2.0], "m", "worn depth"), "peak": ((), 2.0, "m", "")},
        {"angle": ("angle", [0.0, 1.0], "rad", "place")},
    )
    assert found.depth.attrs == {"units": "m", "long_name": "worn depth"}
    assert found.peak.attrs == {"units": "m"}
    assert found.angle.attrs == {"units": "rad", "long_name": "place"}
