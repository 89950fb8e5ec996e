"""Measured and predicted film: what is drawn where, on which scales."""

import numpy as np
import numpy.testing as npt
from matplotlib.collections import PolyCollection

from erlif.show.plots import (
    example_film,
    example_frames,
    film_and_prediction,
    film_less_prediction,
    film_over_run,
    predicted_map,
    prediction_figure,
    prediction_map_figure,
)

FILM = example_film()
FRAMES = example_frames()


def test_a_trigger_of_several_frames_lies_at_their_mean_turn():
    frames = FRAMES.isel(frame=[0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5])
    turns = frames.elapsed_cycles.values + np.repeat([0.0, 1.0], 6)
    frames = frames.assign(elapsed_cycles=("frame", turns))
    outward, back, line = film_over_run(FILM, frames)
    expected = FRAMES.elapsed_cycles.values + 0.5
    rising = FILM.stroke.values > 0
    npt.assert_allclose(outward.get_xdata(), expected[rising])
    npt.assert_allclose(back.get_xdata(), expected[~rising])
    drawn = line.get_xdata()
    npt.assert_array_equal(drawn[np.isfinite(drawn)], np.sort(turns))
    assert np.isnan(drawn).sum() == 3  # at the dead points of both turns


def test_the_films_of_one_turn_are_drawn_less_the_prediction():
    figure = prediction_figure(FILM, FRAMES)
    *_, line = figure.axes[1].get_lines()
    npt.assert_array_equal(line.get_ydata(), [0.0, 0.0])
    ours = film_less_prediction(FILM.assign(film_min=FILM.film_predicted_min + 0.25))
    for points in ours[:2]:
        npt.assert_allclose(points.get_ydata(), 0.25, rtol=1e-9)

    turns = FRAMES.assign(elapsed_cycles=3 * FRAMES.elapsed_cycles)
    assert prediction_figure(FILM, turns).axes[1].get_xlabel() == "turns of the crank [1]"


def test_measured_and_predicted_map_have_one_scale_and_the_difference_one_about_zero():
    figure = prediction_map_figure(FILM, trigger=2)
    measured, predicted, difference = (ax.images[0] for ax in figure.axes[:3])
    assert measured.get_clim() == predicted.get_clim()
    low, high = difference.get_clim()
    assert low == -high
    npt.assert_allclose(
        np.ma.filled(difference.get_array(), np.nan),
        FILM.thickness.values[2] - predicted_map(FILM, trigger=2),
        atol=1e-6,
    )


def test_the_predicted_map_is_the_gap_of_circles():
    x = 1e-3 * (FILM.x.values - FILM.attitude.attrs["load_line"])
    turned = x / np.sqrt(0.03336 * 0.03359) - np.radians(float(FILM.attitude[4]))
    expected = 230 * (1 - float(FILM.eccentricity[4]) * np.cos(turned))
    found = predicted_map(FILM, trigger=4)
    npt.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=1e-5)


def test_the_prediction_has_a_band_of_its_standard_deviation():
    """One polygon a stroke; its ends at a trigger are one standard deviation off the line."""
    std = 0.1 + 0 * FILM.film_predicted_min
    banded = FILM.assign(film_predicted_min_std=std)
    *_, line = film_and_prediction(banded)
    bands = [one for one in line.axes.collections if isinstance(one, PolyCollection)]
    heights = np.concatenate([one.get_paths()[0].vertices for one in bands])
    for value in FILM.film_predicted_min.values:
        for end in (value - 0.1, value + 0.1):
            assert np.isclose(heights[:, 1], end).any()


def test_the_line_has_one_key_in_both_panels():
    turns = FRAMES.assign(elapsed_cycles=3 * FRAMES.elapsed_cycles)
    (legend,) = prediction_figure(FILM, turns).legends
    names = [text.get_text() for text in legend.get_texts()]
    assert [name for name in names if "predicted" in name] == ["predicted, pin free sideways"]
