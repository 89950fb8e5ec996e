"""Films of one name distinguished by their folders."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from erlif.io.files import label_films

PLACES = [
    # the run directory, or the nearest folder above it that differs
    (["50/film.nc", "100/film.nc"], ["50", "100"]),
    (["50/run/film.nc", "100/run/film.nc"], ["50", "100"]),
    (
        ["50/run/film.nc", "100/run/film.nc", "100/again/film.nc"],
        ["50/run", "100/run", "100/again"],
    ),
    # one folder: the files
    (["a.nc", "b.nc"], ["a.nc", "b.nc"]),
    (["run/a.nc", "run/b.nc", "other/a.nc"], ["run/a.nc", "run/b.nc", "other/a.nc"]),
    # nothing else
    (["film.nc", "film.nc"], ["1", "2"]),
]


@pytest.mark.parametrize(("paths", "places"), PLACES)
def test_films_of_one_name_have_the_nearest_folder_that_differs(paths, places):
    found = label_films(["bushing"] * len(paths), [Path(each) for each in paths])
    assert found == [f"bushing ({place})" for place in places]


def test_a_name_that_stands_once_stays_and_films_in_memory_are_numbered():
    assert label_films(["a", "b"], [Path("x.nc"), Path("x.nc")]) == ["a", "b"]
    assert label_films(["a", "b", "a"], [None, None, Path("x.nc")]) == ["a (1)", "b", "a (2)"]


def test_a_relative_and_an_absolute_path_are_compared_as_the_files_they_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    paths = [Path("one/film.nc"), tmp_path / "two" / "film.nc"]
    assert label_films(["a", "a"], paths) == ["a (one)", "a (two)"]


names = st.sampled_from(["a", "a (1)", "b"])
folders = st.lists(st.sampled_from("xyz"), max_size=3).map("/".join)


@given(st.lists(st.tuples(names, folders, st.sampled_from(["film.nc", "b.nc"])), max_size=5))
def test_labels_always_differ(films):
    labels = label_films([name for name, _, _ in films], [Path("/r", *each[1:]) for each in films])
    assert len(set(labels)) == len(films)
