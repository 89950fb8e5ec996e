"""The example film as a file, and what it holds."""

import pytest

from erlif.io.files import open_film
from erlif.show.plots import write_example


@pytest.fixture(scope="package")
def film_path(tmp_path_factory):
    """Six triggers of 24 x 64 pixels."""
    return write_example(tmp_path_factory.mktemp("film") / "film.nc")


@pytest.fixture(scope="package")
def film(film_path):
    """The film of `film_path`; never to be changed."""
    with open_film(film_path) as opened:
        yield opened.load()
