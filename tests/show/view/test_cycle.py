"""Numbers of the triggers as JSON."""

import json

import numpy as np

from erlif.show.plots import example_film
from erlif.show.view.cycle import describe_cycle


def test_the_numbers_are_those_of_the_film():
    film = example_film()
    cycle = json.loads(json.dumps(describe_cycle(film), allow_nan=False))
    for name in ("film_mean", "film_min_std", "load", "film_theory"):
        np.testing.assert_allclose(cycle["columns"][name], film[name].values, rtol=1e-5)
    assert cycle["stroke"] == film.stroke.values.astype(int).tolist()


def test_a_film_at_rest_has_the_number_of_its_triggers():
    cycle = describe_cycle(
        example_film()[["film_mean"]].reset_coords(drop=True).drop_vars("trigger")
    )
    assert cycle["axes"] == {"trigger": "trigger"}
    assert cycle["columns"]["trigger"] == [0, 1, 2, 3, 4, 5]
    assert cycle["stroke"] == [0] * 6


def test_a_theory_that_is_the_transient_prediction_is_drawn_once():
    film = example_film()
    same = film.assign(film_theory=film.film_predicted_min)
    other = film.assign(film_theory=film.film_predicted_min + 1)
    assert "film_theory" not in describe_cycle(same)["films"]
    assert "film_theory" in describe_cycle(same)["columns"]
    assert "film_theory" in describe_cycle(other)["films"]
