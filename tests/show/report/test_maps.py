"""Embedded maps read back as the film, to the rounding that the page names."""

from __future__ import annotations

import json

import numpy as np
import numpy.testing as npt
from scenes import film as scene
from scenes.embedded import decode_map

from erlif.show.report.maps import MapCoding, embed_map, finest_coding

FINE = MapCoding(1, 1e-3)


def decoded(film, trigger, coding=FINE):
    shape = film.thickness.values[0, :: coding.stride, :: coding.stride].shape
    text = embed_map(film, trigger=trigger, coding=coding)
    return decode_map(text, shape=shape, coding=coding)


def test_maps_of_the_page_read_back_as_the_film(page, film):
    data = json.loads(page.texts["film-data"])
    coding = MapCoding(data["coding"]["stride"], data["coding"]["step"])
    assert coding == FINE
    for k in range(scene.TRIGGERS):
        found = decode_map(
            page.texts[f"map-{k}"], shape=(data["height"], data["width"]), coding=coding
        )
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


def test_standard_deviations_are_medians_of_blocks(film):
    """Codes keep a standard deviation to 3 %."""
    found = decoded(film, 0)
    block = film.thickness_std.values[0][8:12, 20:24]
    median = np.sort(block.ravel())[7]  # the lower one of sixteen
    npt.assert_allclose(found.std[2, 5], median, rtol=0.03)
    npt.assert_allclose(found.std_shared[2, 5], 0.02, rtol=0.03)
    changed = film.load().copy(deep=True)
    for std in (1e-4, 100.0):  # over six decades
        changed.thickness_std.values[:] = std
        npt.assert_allclose(decoded(changed, 0).std[5, 5], std, rtol=0.03)


def test_block_without_valid_pixels_has_no_standard_deviation(film):
    found = decoded(film, 1)
    assert np.isnan(found.thickness[20:24, 30:34]).all()
    changed = film.load().copy(deep=True)
    changed.flags.values[1, 20:24, 28:32] = 128
    found = decoded(changed, 1)
    assert np.isnan(found.std[5, 7])
    assert np.isfinite(found.std[5, 5])


def test_steps_grow_where_sixteen_bits_would_not_reach(film):
    assert finest_coding(60.0) == FINE
    coding = finest_coding(400.0)
    assert 65535 * coding.step > 400.0
    assert 65535 * (coding.step - 1e-3) < 400.0 * 1.01
    changed = film.load().copy(deep=True)
    changed.thickness.values[:] = 399.9
    found = decoded(changed, 0, coding).thickness
    npt.assert_allclose(found[np.isfinite(found)], 399.9, atol=0.51 * coding.step)
