"""A page about several runs: table, comparison and maps, with the numbers of the films."""

import json
import re

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.core.errors import ErlifError, OutputError
from erlif.io.files import open_film
from erlif.show.report import write_runs_report

HOSTILE = "<script>alert(1)</script>"


@pytest.fixture(scope="module")
def second_path(film_path, tmp_path_factory):
    """The film of another run, thicker by 0.5 um, with a warning and a hostile name."""
    path = tmp_path_factory.mktemp("second") / "film.nc"
    with open_film(film_path) as film:
        other = film.load().copy(deep=True)
    other["film_min"] = other.film_min + 0.5
    settings = other.attrs["settings"].replace("a film <known> & small", HOSTILE)
    other.attrs.update(settings=settings, notes="warning: <b>one</b>\nnone")
    other.attrs.update(input_hashes=json.dumps({"run.toml": "cd" * 32}))
    other.to_netcdf(path, engine="h5netcdf")
    return path


@pytest.fixture(scope="module")
def source(film_path, second_path):
    """The page as text."""
    path = write_runs_report([film_path, second_path], second_path.with_name("runs.html"))
    return path.read_text(encoding="utf-8")


@pytest.fixture
def runs(source, read_page):
    return read_page(source)


def test_table_has_the_numbers_of_the_films(runs, film):
    _, (one, two) = runs.saved()
    npt.assert_allclose(float(one["film_min [um]"]), film.film_min.min(), rtol=1e-8)
    npt.assert_allclose(float(two["film_min [um]"]), film.film_min.min() + 0.5, rtol=1e-8)
    assert float(one["highest load [N]"]) == pytest.approx(scene.LOAD, rel=1e-6)
    assert float(one["speed_exponent [1]"]) == scene.POWER
    share = float((film.flags == 0).mean())
    npt.assert_allclose(float(one["valid share [1]"]), share, rtol=1e-8)
    assert (one["warnings"], two["warnings"]) == ("0", "1")

    # the page has the same numbers, with the digits of their errors
    thinnest = int(np.argmin(film.film_min.values))
    value, std = float(film.film_min[thinnest]), float(film.film_min_std[thinnest])
    assert f"{value:.3f} ± {std:.3f}" in runs.texts["runs"]
    assert 0.0095 < std < 0.0995  # two digits of the error
    assert "0.600 ± 0.010" in runs.texts["runs"]


def test_names_of_runs_stay_text_and_nothing_is_loaded(source, runs):
    assert runs.open == []
    assert runs.all("script") == []
    names = [attrs["id"] for attrs in runs.all("figure")]
    assert names == ["figure-compared", "figure-run-1", "figure-run-2"]
    assert HOSTILE in runs.texts["runs"]
    assert not re.search(r"https?://|url\(|@import", re.sub(r"data:[^\"]*", "", source))
    assert all(attrs["src"].startswith("data:image/") for attrs in runs.all("img"))


def test_what_is_left_out_has_a_reason(film_path, second_path, tmp_path, monkeypatch, read_page):
    """Maps without room, and runs that are too many or cannot be compared."""

    def refuse(films):
        raise ErlifError("Expected <one> mechanism. Compare others.")

    monkeypatch.setattr("erlif.show.report.runs._FRAME", 500_000)
    monkeypatch.setattr("erlif.show.report.runs.compare", refuse)
    for most, words in ((12, "not compared: Expected <one> mechanism."), (1, "at most 1 runs")):
        monkeypatch.setattr("erlif.show.report.runs._MOST_COMPARED", most)
        path = write_runs_report([film_path, second_path], tmp_path / f"{most}.html", max_size=0.5)
        page = read_page(path.read_text(encoding="utf-8"))
        assert words in page.texts["compared"]
        assert "Maps of the last 2 of 2 runs are left out" in page.texts["maps"]
        assert len(page.saved()[1]) == 2


def test_bad_input_is_refused_and_nothing_is_written(film_path, tmp_path):
    with pytest.raises(OutputError, match="does not exist"):
        write_runs_report([film_path, tmp_path / "none.nc"], tmp_path / "a.html")
    with pytest.raises(ErlifError, match=r"0\.5 MB"):
        write_runs_report([film_path, film_path], tmp_path / "a.html", max_size=0.1)
    again = film_path.parent / ".." / film_path.parent.name / film_path.name
    with pytest.raises(ErlifError, match=f"{film_path.name} is named 2 times"):
        write_runs_report([film_path, again], tmp_path / "a.html")
    assert list(tmp_path.iterdir()) == []
