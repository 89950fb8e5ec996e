"""Lines on film, theory and speed: what is not known is left out."""

import numpy as np
import xarray as xr

from erlif.show.report.agreement import (
    describe_correlations,
    describe_delay,
    describe_factor,
    describe_following,
    describe_other_factors,
)

ATTRS = {"factor": 2.0, "factor_std_random": 0.01, "factor_std_shared": 0.02, "low": 1.9}


ATTRS |= {"high": 2.1, "outward": 2.05, "back": 1.95}


def with_ratio(name, **attrs):
    return xr.Dataset({name: ("trigger", [2.0, 2.0], ATTRS | attrs)})


def test_one_direction_and_an_unknown_viscosity_are_left_out():
    film = with_ratio("film_over_hamrock_dowson", back=np.nan).assign(film_hamrock_dowson=1.0)
    assert describe_factor(film) == (
        "2.000 ± 0.010 ± 0.020 × Hamrock-Dowson, line contact (2.65); 1.9 to 2.1"
    )
    unknown = with_ratio("film_over_hamrock_dowson", factor=np.nan)
    assert describe_factor(unknown) == describe_factor(xr.Dataset()) == ""


def test_each_theory_has_a_line_with_its_viscosity():
    viscosity = {"viscosity": 0.25, "viscosity_std": 0.02, "viscosity_given": 0.12}
    film = with_ratio("film_over_theory", **viscosity).merge(with_ratio("film_over_predicted"))
    assert describe_other_factors(film).splitlines() == [
        "regime map: 2.000 ± 0.022, 1.9 to 2.1; takes 0.25 ± 0.02, oil 0.12 Pa s",
        "transient film, start fitted: 2.000 ± 0.022, 1.9 to 2.1",
    ]


def test_the_centre_of_a_plateau_has_its_factor():
    """That of a point contact is the factor of the minimum, and is left out."""
    film = with_ratio("film_over_hamrock_dowson", formula_error=np.inf)
    film = film.merge(with_ratio("film_over_theory")).assign(film_hamrock_dowson=1.0)
    film = film.merge(with_ratio("film_central_over_theory", factor=1.5)).assign(film_central=1.0)
    plateau, point = (film.assign_attrs(contact=one) for one in ("plateau", "point"))
    assert describe_factor(plateau).endswith("; 2, h_c 1.5 × regime map")
    assert "central film, regime map: 1.500 ± 0.022" in describe_other_factors(plateau)
    assert describe_factor(point).endswith("; 2 × regime map")
    assert "central" not in describe_other_factors(point)


def test_the_error_of_the_formula_stands_beside_it_and_is_part_of_the_viscosity():
    """0.02 and 0.15 Pa s are 0.15 Pa s together; 2.65 does not hold outside its regime."""
    viscosity = {"viscosity": 0.25, "viscosity_std": 0.02, "viscosity_given": 0.12}
    known = viscosity | {"formula_error": 0.2, "viscosity_std_formula": 0.15}
    film = with_ratio("film_over_hamrock_dowson", **known).assign(film_hamrock_dowson=1.0)
    text = describe_factor(film)
    assert "× Hamrock-Dowson, line contact (2.65) ± 20 %; 1.9 to 2.1" in text
    assert text.endswith("; takes 0.2 ± 0.2, oil 0.12 Pa s")
    other = describe_other_factors(with_ratio("film_over_theory", **known))
    assert other.startswith("regime map ± 20 %: 2.000 ± 0.022, 1.9 to 2.1; takes")
    outside = known | {"formula_error": np.inf, "viscosity_std_formula": np.inf}
    film = with_ratio("film_over_hamrock_dowson", **outside).assign(film_hamrock_dowson=1.0)
    assert "(2.65), not its regime; 1.9 to 2.1" in describe_factor(film)
    assert "take" not in describe_factor(film)
    both = film.merge(with_ratio("film_over_theory", **known))
    assert describe_factor(both).endswith("; 2 × regime map")
    lobed = with_ratio("film_over_hamrock_dowson", **outside, formula_of="of a straight bore")
    assert ", of a straight bore; 1.9 to 2.1" in describe_factor(
        lobed.assign(film_hamrock_dowson=1.0)
    )


def test_correlations_and_delay_that_are_not_known_are_left_out():
    unknown = ("correlated_film", "correlated_with"), np.full((3, 1), np.nan)
    names = [f"speed_correlation{part}" for part in ("_rank", "", "_low", "_high")]
    film = xr.Dataset(dict.fromkeys(names, unknown)).assign(
        correlated_film=["film_min", "film_mean", "film_gap_mean"], correlated_with=["speed"]
    )
    assert describe_following(film) == describe_correlations(film) == describe_delay(film) == ""
    late = film.assign(speed_delay=12.4, speed_delay_std=2.0)
    assert describe_delay(late) == describe_correlations(late) == "12.4 ± 2.0° late"
