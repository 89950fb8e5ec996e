"""The list of remedies in the terminal."""

import numpy as np
import pytest
import xarray as xr

from erlif.commands.lines import wrap
from erlif.core.remedies import REMEDIES
from erlif.show.report.remedies import print_remedies


def table(last, gap=0):
    """Films of 1 and 4 um with all remedies, of which the last leaves `last` at 4 um. [um]"""
    keys = ["", *REMEDIES]
    std = np.full((len(keys), 2), 123.456)
    std[-1] = np.nan, last
    attrs = {"target": np.array([0.01, 0.04]), "within": 1.0}
    attrs |= {"largest": "lag", "largest_std": 0.051}
    coords = {"remedy": keys, "target_film": [1.0, 4.0]}
    return xr.DataArray(std, coords, attrs=attrs | {"gap": [gap] * len(keys)})


@pytest.mark.parametrize("gap", [0, 1])
def test_all_remedies_fit_the_terminal(gap):
    lines = wrap(print_remedies(table(0.03, gap), "the middle of the wanted range")).splitlines()
    assert max(map(len, lines)) <= 80
    assert any(line.startswith("* With") for line in lines) == bool(gap)


def test_a_film_that_is_not_covered_has_a_dash():
    assert print_remedies(table(0.03), "the median").count("    -  ") == 1
    assert "Reached at 4 um; not at 1 um." in print_remedies(table(0.03), "the median")


def test_what_is_left_is_stated_with_its_largest_term():
    text = print_remedies(table(0.06), "the median film")
    assert "Reached at no film." in text
    expected = "No list reaches it: 60 nm are left, most of it by lag of the cameras (51 nm)."
    assert expected in text
