"""Options that several commands share."""

from pathlib import Path

import pytest

from erlif.commands.options import expect_suffix
from erlif.core.errors import OutputError


def test_a_name_with_another_suffix_is_refused_with_the_ones_that_fit():
    with pytest.raises(OutputError, match=r"\.nc or \.zarr .* film\.csv"):
        expect_suffix(Path("out/film.csv"), ".nc", ".zarr")
