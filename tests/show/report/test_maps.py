"""Embedded maps read back as the film, to the rounding that the page names."""

import json

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene
from scenes.embedded import decode_map
from scenes.long_film import phase_map, phases, write_long_film

from erlif.core.errors import ErlifError
from erlif.io.files import open_film
from erlif.show.plots.files import DRAWN
from erlif.show.report import page as pages
from erlif.show.report import write_report
from erlif.show.report.maps import MapCoding, choose_maps, embed_map, finest_coding, spread_evenly

FINE = MapCoding(1, 1e-3)


def decoded(film, trigger, coding=FINE):
    shape = film.thickness.values[0, :: coding.stride, :: coding.stride].shape
    text = embed_map(film, trigger=trigger, coding=coding)
    return decode_map(text, shape=shape, coding=coding)


def read_data(page):
    """Rows and columns, coding and triggers of the maps of a page."""
    data = json.loads(page.texts["film-data"])
    (film,) = data["films"]
    coding = MapCoding(data["coding"]["stride"], data["coding"]["step"])
    return (film["height"], film["width"]), coding, film["numbers"]


def test_maps_of_the_page_read_back_as_the_film(page, film):
    shape, coding, numbers = read_data(page)
    assert coding == FINE
    assert numbers == list(range(scene.TRIGGERS))
    for k in numbers:
        found = decode_map(page.texts[f"map-{k}"], shape=shape, coding=coding)
        npt.assert_array_equal(found.flags, film.flags.values[k])
        npt.assert_allclose(found.thickness, film.thickness.values[k], atol=0.5001e-3)
        # circles of the joint are thinnest at the attitude, which lies on a column of the scene
        npt.assert_allclose(found.predicted.min(), scene.sunken_film()[k], atol=2e-3)


def test_prediction_that_is_not_known_stays_unknown(film):
    predicted = np.full(film.thickness.shape[1:], 5.0)
    predicted[3, 4], predicted[5, 6] = np.nan, 70.0  # beyond the counts of 16 bits
    text = embed_map(film, trigger=0, coding=FINE, predicted=predicted)
    found = decode_map(text, shape=predicted.shape, coding=FINE).predicted
    assert np.isnan(found[[3, 5], [4, 6]]).all()
    assert np.isfinite(found).sum() == found.size - 2
    npt.assert_allclose(found[0, 0], 5.0)
    assert decoded(film, 0).predicted is None


def test_standard_deviations_are_medians_of_blocks(film, changed):
    """Codes keep a standard deviation to 3 %."""
    found = decoded(film, 0)
    block = film.thickness_std.values[0][8:12, 20:24]
    median = np.sort(block.ravel())[7]  # the lower one of sixteen
    npt.assert_allclose(found.std[2, 5], median, rtol=0.03)
    npt.assert_allclose(found.std_shared[2, 5], 0.02, rtol=0.03)
    for std in (1e-4, 100.0):  # over six decades
        changed.thickness_std.values[:] = std
        npt.assert_allclose(decoded(changed, 0).std[5, 5], std, rtol=0.03)


def test_block_without_valid_pixels_has_no_standard_deviation(film, changed):
    found = decoded(film, 1)
    assert np.isnan(found.thickness[20:24, 30:34]).all()
    changed.flags.values[1, 20:24, 28:32] = 128
    found = decoded(changed, 1)
    assert np.isnan(found.std[5, 7])
    assert np.isfinite(found.std[5, 5])


def test_steps_grow_where_sixteen_bits_would_not_reach(changed):
    assert finest_coding(60.0) == FINE
    coding = finest_coding(400.0)
    assert 65535 * coding.step > 400.0
    assert 65535 * (coding.step - 1e-3) < 400.0 * 1.01
    changed.thickness.values[:] = 399.9
    found = decoded(changed, 0, coding).thickness
    npt.assert_allclose(found[np.isfinite(found)], 399.9, atol=0.51 * coding.step)


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
    _, _, kept = read_data(page)
    assert 50 <= len(kept) < TRIGGERS
    stated = page.texts["viewer"]
    assert f"the maps of {len(kept)} of 300 triggers" in stated
    assert "to be at most 1 MB" in stated
    assert all(way in stated for way in ("erlif view FILM", "--trigger", "--max-size"))


def test_kept_maps_are_those_of_their_triggers(small, long_film, read_page):
    """The film is the formula, rounded to a tenth of its standard deviation of 50 nm."""
    page = read_page(small.read_text(encoding="utf-8"))
    shape, coding, numbers = read_data(page)
    assert FASTEST in numbers
    with open_film(long_film) as film:
        stored = film.thickness.load()
    for trigger in numbers[::20]:
        found = decode_map(page.texts[f"map-{trigger}"], shape=shape, coding=coding)
        truth = phase_map(int(phases(TRIGGERS)[trigger]), SHAPE)["thickness"]
        npt.assert_allclose(stored[trigger], truth, atol=5e-3)
        kept = stored[trigger, :: coding.stride, :: coding.stride]
        npt.assert_allclose(found.thickness, kept, atol=0.51 * coding.step)


def test_triggers_that_the_film_lacks_and_sizes_without_room_are_refused(film_path, tmp_path):
    triggers, size = r"Expected triggers from 0 to 5.*--trigger", r"0.5 MB or more.*--max-size"
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
