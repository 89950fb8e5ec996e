"""The contact that the curvatures of a run allow, on gaps that are known."""

import numpy as np
from scenes.gap import (
    WHOLE,
    S,
    X,
    Y,
    Z,
    ball,
    exact_ratios,
    known_calibration,
    known_gap,
    noisy_ratios,
)

from erlif.trend import FilmCurve, sum_blocks
from erlif.trend.contact import choose_contact, has_plateau
from erlif.trend.gap import GapShape, find_gap_minimum


def fit(ratios):
    """The gap of a point contact."""
    curve, sums = FilmCurve.of(known_calibration()), sum_blocks(ratios, WHOLE)
    return find_gap_minimum(sums, curve, region=WHOLE, sliding_along_x=True, contact=GapShape.POINT)


def choose(*films, noise=0.0135):
    """The gap that films of one run choose."""
    rng = np.random.default_rng(11)
    triggers = [noisy_ratios(film, noise, rng) for film in films]
    return choose_contact([{GapShape.POINT: fit(one)} for one in triggers])


def test_gap_is_chosen_by_the_curvatures_that_the_films_have():
    assert choose(ball(1.1), ball(2.0)) is GapShape.POINT
    assert choose(ball(2.0, bend=(0.0, 2.0))) is GapShape.POINT
    assert choose(known_gap(1.1), known_gap(2.0)) is GapShape.LINE
    assert choose(1.1 + 0.2 * S + 0.1 * Z, 2.0 + 0.2 * S + 0 * Z) is GapShape.PLANE
    assert choose(np.full((Y.size, X.size), 60.0)) is GapShape.LINE


def test_noise_averages_out_over_the_triggers_of_a_run_and_marks_do_not():
    """A curvature of one standard deviation in each of sixteen triggers is four of the mean."""
    one = fit(exact_ratios(ball(3.0)))
    one = one._replace(bend=np.array([0.0, 0.1]))
    small, large = np.full(2, 1e-8), np.full(2, 0.01)
    noisy = one._replace(bend_random_var=large, bend_surface_var=small)
    marked = one._replace(bend_random_var=small, bend_surface_var=large)
    assert choose_contact([{GapShape.POINT: noisy}] * 16) is GapShape.POINT
    assert choose_contact([{GapShape.POINT: noisy}] * 8) is GapShape.PLANE
    assert choose_contact([{GapShape.POINT: marked}] * 16) is GapShape.PLANE


def test_plateau_is_chosen_where_most_triggers_have_one():
    level = fit(exact_ratios(ball(2.0)))._replace(misfit=5.0)
    flat = {GapShape.POINT: level, GapShape.PLATEAU: level._replace(misfit=0.0)}
    round_one = {GapShape.POINT: level._replace(misfit=0.1)}
    round_one[GapShape.PLATEAU] = round_one[GapShape.POINT]
    none = {GapShape.POINT: level, GapShape.PLATEAU: level}
    assert [has_plateau(one) for one in (flat, round_one, none)] == [True, False, False]
    assert choose_contact([flat, flat, round_one]) is GapShape.PLATEAU
    assert choose_contact([flat, round_one, none]) is GapShape.POINT
