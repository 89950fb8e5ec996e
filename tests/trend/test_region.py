"""The region of interest in rows and columns."""

import numpy as np
import pytest

from erlif.core.errors import ConfigError
from erlif.trend import Region, find_region

X, Y = 0.06 * np.arange(200), 0.06 * np.arange(160)


def test_bounds_between_pixels_keep_the_pixels_inside():
    region = find_region(X, Y, roi=((3, 9), (2, 8)))
    rows, columns = region.rows, region.columns
    assert (X[columns][0], X[columns][-1]) == (pytest.approx(3.0), pytest.approx(9.0))
    assert (Y[rows][0], Y[rows][-1]) == (pytest.approx(2.04), pytest.approx(7.98))


def test_bounds_beyond_the_image_end_with_it():
    region = find_region(X, Y, roi=((-5, 100), (4, 100)))
    assert region == Region(rows=slice(67, 160), columns=slice(0, 200))


@pytest.mark.parametrize(
    "roi", [((30, 40), (0, 5)), ((0, 5), (-9, -3)), ((0, 1.8), (0, 5)), ((0, 5), (2, 3.8))]
)
def test_region_of_few_pixels_is_refused_with_the_size_of_the_image(roi):
    with pytest.raises(ConfigError, match="at least 32 x 32 pixels") as refused:
        find_region(X, Y, roi=roi)
    assert "x 0 to 11.94 mm and y 0 to 9.54 mm" in str(refused.value)
