"""Numbers of frames by the names of their files."""

import pytest

from erlif.io.ingest import Page
from erlif.io.ingest.numbering import find_missing, frame_numbers


@pytest.mark.parametrize(
    ("names", "numbers"),
    [
        (["f_2.tif", "f_10.tif"], [2, 10]),
        (["run7_cam1_003.tif", "run7_cam1_004.tif"], [3, 4]),
        (["7_a.tif", "7_b.tif"], [0, 1]),  # all the same number
        (["a.tif", "b.tif"], [0, 1]),  # no numbers
        (["a.tif", "5.tif"], [0, 5]),
    ],
)
def test_a_frame_has_the_last_number_of_its_name_or_its_position(tmp_path, names, numbers):
    assert frame_numbers([Page(tmp_path / name, 0) for name in names]) == numbers


@pytest.mark.parametrize(
    ("numbers", "missing"),
    [
        ([0, 1, 2, 3], []),
        ([0, 1, 3, 4, 7, 8], [2, 5, 6]),
        ([10, 20, 30, 50], [40]),
        ([0, 5, 6, 20], []),  # numbers that count something else
        ([3, 1], []),
    ],
)
def test_gaps_in_equal_steps_are_found(numbers, missing):
    assert find_missing(numbers) == missing
