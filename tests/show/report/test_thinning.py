"""A page holds what fits into its size, and names what it leaves out."""

from __future__ import annotations

import json

import numpy.testing as npt
import pytest
from scenes.embedded import decode_map
from scenes.long_film import phase_map, phases, write_long_film

from erlif.core.errors import ErlifError
from erlif.io.files import open_film
from erlif.show.plots.files import DRAWN
from erlif.show.report import page as pages
from erlif.show.report import write_report
from erlif.show.report.maps import MapCoding, embed_map
from erlif.show.report.thinning import choose_maps, spread_evenly

TRIGGERS, SHAPE = 300, (96, 128)
FASTEST = 75  # a quarter turn after the first trigger
THICKEST = 16.0


@pytest.fixture(scope="module")
def long_film(tmp_path_factory):
    """A film whose maps take about 6 MB as text."""
    path = tmp_path_factory.mktemp("long") / "film.zarr"
    return write_long_film(path, triggers=TRIGGERS, shape=SHAPE)


@pytest.fixture(scope="module")
def small(long_film):
    """A page of at most 1 MB, without figures."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pages, "DRAWN", {})
        return write_report(long_film, long_film.with_name("small.html"), max_size=1.0)


def test_page_states_what_it_leaves_out_and_how_to_see_it(small, read_page):
    page = read_page(small.read_text(encoding="utf-8"))
    kept = json.loads(page.texts["film-data"])["numbers"]
    assert 50 <= len(kept) < TRIGGERS
    stated = page.texts["viewer"]
    assert f"the maps of {len(kept)} of 300 triggers" in stated
    assert "to be at most 1 MB" in stated
    assert all(way in stated for way in ("erlif view FILM", "--triggers", "--max-size"))


def test_kept_maps_are_those_of_their_triggers(small, long_film, read_page):
    """The film is the formula, rounded to a tenth of its standard deviation of 50 nm."""
    page = read_page(small.read_text(encoding="utf-8"))
    data = json.loads(page.texts["film-data"])
    coding = MapCoding(data["coding"]["stride"], data["coding"]["step"])
    shape = (data["height"], data["width"])
    assert FASTEST in data["numbers"]
    with open_film(long_film) as film:
        stored = film.thickness.load()
    for trigger in data["numbers"][::20]:
        found = decode_map(page.texts[f"map-{trigger}"], shape=shape, coding=coding)
        truth = phase_map(int(phases(TRIGGERS)[trigger]), SHAPE)["thickness"]
        npt.assert_allclose(stored[trigger], truth, atol=5e-3)
        kept = stored[trigger, :: coding.stride, :: coding.stride]
        npt.assert_allclose(found.thickness, kept, atol=0.51 * coding.step)


def test_triggers_that_the_film_lacks_and_sizes_without_room_are_refused(film_path, tmp_path):
    triggers, size = r"Expected triggers from 0 to 5.*--triggers", r"0.5 MB or more.*--max-size"
    options = [({"triggers": chosen}, triggers) for chosen in ((5, 300), (9, 3), (-1, 4))]
    options += [({"max_size": given}, size) for given in (-3.0, float("nan"), 0.4)]
    for option, message in options:
        with pytest.raises(ErlifError, match=message):
            write_report(film_path, tmp_path / "a.html", **option)
    assert list(tmp_path.iterdir()) == []


def test_steps_grow_before_pixels_are_left_out(film):
    size = len(embed_map(film, trigger=2, coding=MapCoding(1, 1e-3)))
    kept = choose_maps(film, room=5.9 * size, thickest=THICKEST, opening=2, triggers=range(6))
    assert (len(kept.triggers), kept.coding.stride) == (6, 1)
    # a twentieth of the standard deviation of a pixel leaves its error the same to 0.01 %
    assert 1e-3 < kept.coding.step <= 0.05 * float(film.thickness_std[2].max())
    few = choose_maps(film, room=5e3, thickest=THICKEST, opening=2, triggers=range(6))
    assert 2 in few.triggers
    assert len(few.triggers) < 6


def test_evenly_chosen_triggers_are_as_many_as_allowed():
    for count in (1, 2, 3, 7, 50, 99):
        chosen = spread_evenly(range(1000), count, kept=333)
        assert 333 in chosen
        assert len(chosen) in (count - 1, count) or count == 1
        assert list(chosen) == sorted(set(chosen))


def test_large_figures_are_left_out_with_a_reason(film_path, tmp_path, monkeypatch, read_page):
    few = {name: DRAWN[name] for name in ("speed_against_angle", "thickness_map")}
    monkeypatch.setattr(pages, "DRAWN", few)
    monkeypatch.setattr("erlif.show.report.page._FIGURES", 0.15)
    path = write_report(film_path, tmp_path / "a.html", max_size=0.5)
    page = read_page(path.read_text(encoding="utf-8"))
    assert path.stat().st_size <= 0.5e6
    assert len(page.all("figure")) < len(few)
    assert "too large for this page" in page.texts["figures"]
