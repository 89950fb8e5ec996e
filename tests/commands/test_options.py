"""Options that several commands share."""

from pathlib import Path

import pytest

from erlif.commands.options import expect_suffix
from erlif.core.errors import OutputError


def test_a_name_with_another_suffix_is_refused_with_the_ones_that_fit():
    with pytest.raises(OutputError, match=r"\.nc or \.zarr .* film\.csv"):
        expect_suffix(Path("out/film.csv"), ".nc", ".zarr")


def test_the_advice_names_the_option_of_the_command():
    with pytest.raises(OutputError, match="Name it so with -o"):
        expect_suffix(Path("film.csv"), ".nc")
    with pytest.raises(OutputError, match="Name it so with --html"):
        expect_suffix(Path("page.txt"), ".html", option="--html")
