"""Format version of the files that erlif writes."""

import pytest

from erlif.core.format import ATTRIBUTE, FORMAT_VERSION, is_later


def test_files_of_this_and_of_earlier_versions_are_read():
    assert not any(is_later({ATTRIBUTE: n}) for n in range(1, FORMAT_VERSION + 1))


def test_a_file_without_a_version_is_of_the_first():
    assert not is_later({"title": "ERLIF calibration"})


@pytest.mark.parametrize("found", [0, -1, 1.5, "two", float("nan")])
def test_a_version_that_is_no_whole_number_is_damage(found):
    with pytest.raises(ValueError, match=r"version|invalid|NaN"):
        is_later({ATTRIBUTE: found})
