"""Refusals have an error of the package, and name what they are given."""

import pytest

from erlif.core.errors import FrameError
from erlif.show.refusals import refusal


def test_a_refusal_names_what_was_found():
    error = refusal("no_run", name="film.nc")
    assert type(error) is FrameError
    assert "the run of film.nc" in str(error)
    with pytest.raises(KeyError, match="name"):
        refusal("no_run")
