"""Format version of the files that erlif writes."""

import pytest

from erlif.core.format import ATTRIBUTE, is_later, is_version_after


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
