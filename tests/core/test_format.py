"""Format version of the files that erlif writes."""

from pathlib import Path

import pytest

from erlif.core import variables
from erlif.core.flags import Flag
from erlif.core.format import ATTRIBUTE, FORMAT_VERSION, is_later, is_version_after

LISTED = Path(__file__).parents[1] / "reference" / f"format_{FORMAT_VERSION}.txt"
TABLES = ("film", "frames", "registration", "calibration", "prediction", "pressure")


def test_dims_units_and_flags_stay_in_a_format_version():
    """A row that changes needs another FORMAT_VERSION and its own list; a new row is added."""
    rows = [f"flag {flag.name} {flag.value}" for flag in Flag]
    rows += [
        f"{table} {one.name} ({', '.join(one.dims)}) {one.units}".rstrip()
        for table in TABLES
        for one in getattr(variables, table.upper()).values()
    ]
    listed = LISTED.read_text(encoding="utf-8").splitlines()
    changed = sorted(set(listed) ^ set(rows))
    assert not changed


@pytest.mark.parametrize("found", [0, -1, 1.5, "two", float("nan")])
def test_a_version_that_is_no_whole_number_is_damage(found):
    with pytest.raises(ValueError, match=r"version|invalid|NaN"):
        is_later({ATTRIBUTE: found})


@pytest.mark.parametrize(
    ("one", "two", "after"),
    [
        ("0.1.1", "0.1.0", True),
        ("1.0", "0.9.9", True),
        ("0.10.0", "0.9.0", True),
        ("0.1.0.dev3", "0.1.0", False),
        ("0.1.0", "0.1.0", False),
        ("", "0.1.0", False),
        ("unknown", "0.1.0", False),
    ],
)
def test_versions_are_compared_by_their_numbers(one, two, after):
    assert is_version_after(one, two) == after
