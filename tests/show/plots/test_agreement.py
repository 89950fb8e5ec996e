"""The panel of the ratios draws what the film holds, with its medians."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.show.plots import film_over_theory
from erlif.show.plots.agreement import has_ratio


@pytest.fixture
def ratios(film):
    """The ratio to the regime map, without its first trigger, and no other."""
    values = np.linspace(0.4, 0.6, film.sizes["trigger"])
    values[0] = np.nan
    return film.assign(
        film_over_theory=("trigger", values, {"factor": 0.5}),
        film_over_theory_std=("trigger", 0.1 * values),
        film_over_predicted=("trigger", values * np.nan, {"factor": np.nan}),
        film_over_predicted_std=("trigger", values * np.nan),
    )


def test_points_and_median_are_those_of_the_film(ratios):
    points = film_over_theory(ratios)
    drawn = np.sort(np.concatenate([one.get_ydata() for one in points]))
    npt.assert_allclose(drawn, ratios.film_over_theory.values[1:])
    ax = points[0].axes
    assert ax.get_legend().get_texts()[0].get_text() == "over regime map: 0.5"
    assert len(ax.get_legend().get_texts()) == 1


def test_a_film_without_a_ratio_has_no_panel(film, ratios):
    assert has_ratio(ratios)
    assert not has_ratio(film)
    assert not has_ratio(ratios.assign(film_over_theory=ratios.film_over_theory * np.nan))
