"""A film that a command may write beside."""

import pytest


@pytest.fixture
def own(film, tmp_path):
    """A copy of the film in a directory of its own."""
    path = tmp_path / "lab" / "film.nc"
    path.parent.mkdir()
    path.write_bytes(film.read_bytes())
    return path
