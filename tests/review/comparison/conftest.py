"""Runs made by formula, with errors that follow the stated model."""

import numpy as np
import pytest

from erlif.review.comparison import read_run
from erlif.show.plots import example_film

FRAMES = '{{"camera1/*.tif": "{}"}}'


@pytest.fixture(scope="package")
def film():
    """Six triggers of 24 x 64 pixels; never to be changed."""
    return example_film()


@pytest.fixture(scope="package")
def record(film):
    return read_run(film)


@pytest.fixture(scope="package")
def other(film):
    """The same film 0.5 um thicker, of other frames."""
    changed = film.assign(
        thickness=film.thickness + np.float32(0.5),
        film_min=film.film_min + 0.5,
        film_mean=film.film_mean + 0.5,
    )
    return changed.assign_attrs(input_hashes=FRAMES.format("b"))
