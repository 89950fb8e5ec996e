"""Films that are read trigger by trigger."""

import numpy as np
import pytest

from erlif.core.errors import ErlifError, FrameError
from erlif.show.plots import example_film
from erlif.show.view import films
from erlif.show.view.films import check_one_grid, open_films


@pytest.fixture
def reader(example_path):
    (found,) = open_films([example_path])
    yield found
    found.close()


def test_maps_are_those_of_the_film(reader):
    for name in ("thickness", "thickness_std", "thickness_std_shared"):
        values, flags = reader.read(name, 4)
        np.testing.assert_array_equal(values, example_film()[name].values[4])
        np.testing.assert_array_equal(flags, example_film().flags.values[4])


def test_few_maps_stay_in_memory(example_path, monkeypatch):
    monkeypatch.setattr(films, "KEPT", 10 * 24 * 64 * 4)
    (reader,) = open_films([example_path])
    for trigger in (*range(6), 5):
        reader.read("thickness", trigger)
    reader.close()
    kept = reader._read.cache_info()
    assert (kept.currsize, kept.hits) == (10, 2)


def test_images_are_those_behind_the_map(film, small_rig):
    (found,) = open_films([film], [small_rig.run])
    ratio, flags = found.read("log_ratio", 1)
    light, none = found.read("camera2", 1)
    found.close()
    assert np.isfinite(ratio[flags == 0]).all()  # the film is the inverse of the ratio
    assert not none.any()
    assert 10 < np.nanmedian(light) < 4096


def test_what_a_film_lacks_is_refused(reader, example_path, tmp_path):
    for layer, trigger in (("thickness", 6), ("thickness", -1), ("joint_load", 0)):
        with pytest.raises(ErlifError, match="Choose one of them"):
            reader.read(layer, trigger)
    assert "log_ratio" not in reader.layers
    with pytest.raises(FrameError, match="--run-dir"):
        reader.read("log_ratio", 0)
    for run_dirs, message in (([tmp_path], "--run-dir"), ([tmp_path] * 2, "at most one --run-dir")):
        with pytest.raises(ErlifError, match=message):
            open_films([example_path], run_dirs)


def test_films_of_two_grids_have_no_difference(reader, film):
    (other,) = open_films([film])
    with pytest.raises(ErlifError, match="on one grid"):
        check_one_grid(reader, other)
    other.close()
    check_one_grid(reader, reader)
