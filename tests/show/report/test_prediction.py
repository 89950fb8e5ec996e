"""The lines on the predicted film."""

from dataclasses import replace

import numpy as np
import xarray as xr

from erlif.core.notes import warn
from erlif.prediction import Estimate, FilmModel, ModelComparison, MotionFit
from erlif.prediction.least_squares import Minimum
from erlif.show.report.prediction import (
    describe_band,
    describe_correlation,
    describe_difference,
    summarise_comparison,
)

SPEED = np.array([-3.0, -2.0, -1.0, 1.5, 2.5, 3.5])
ATTRS = {
    "title": "predicted oil-film thickness, test",
    "model": "transient Reynolds, pin guided",
    "start_film": 4.5,
    "start_film_fitted": 1,
}


def films(**columns):
    return xr.Dataset({name: ("trigger", values) for name, values in columns.items()}, attrs=ATTRS)


def test_correlations_are_those_with_the_size_of_the_speed():
    film = films(rocker_speed=SPEED, film_min=abs(SPEED), film_predicted_min=5 - abs(SPEED))
    assert describe_correlation(film) == "measured +1.00, predicted -1.00"
    assert describe_correlation(film.drop_vars("film_min")) == "predicted -1.00"
    assert describe_correlation(film.drop_vars("rocker_speed")) == ""


def test_the_difference_has_no_mean_where_the_start_is_fitted():
    film = films(film_min=[3.0, np.nan, 1.0], film_predicted_min=[2.0, 2.0, 4.0])
    assert describe_difference(film) == "rms 2.24 um, start film fitted"
    given = film.assign_attrs(start_film_fitted=0)
    assert describe_difference(given) == "mean -1 um, rms 2.24 um"
    assert describe_difference(film.drop_vars("film_min")) == ""


def test_the_largest_error_of_the_prediction_is_stated_where_there_is_one():
    film = films(film_predicted_min=SPEED, film_predicted_min_std=0.02 * abs(SPEED))
    assert describe_band(film) == "± 0.07 um at most: viscosity, load, clearance"
    assert describe_band(film.drop_vars("film_predicted_min_std")) == ""
    assert describe_band(films(film_predicted_min_std=np.full(6, np.nan))) == ""


def comparison(viscosity, inflation=1.0):
    none = np.zeros(0)
    minimum = Minimum(*[none] * 6, inflation, log_likelihood=0.0)
    estimates = {
        "viscosity": viscosity,
        "start_film": Estimate(6.268e-6, 14e-9, 6.24e-6, 6.30e-6, "m"),
    }
    fit = MotionFit("free", estimates, (), minimum, none, none)
    candidates = (
        FilmModel("a pin that is free sideways", 0.0, 4, 1.0, 37.6e-9),
        FilmModel("a guided pin", 1020.7, 4, 300.0, 9.67e-6),
    )
    return ModelComparison(candidates, "Squeeze carries the film.", fit)


def test_the_verdict_stands_first_then_models_then_values_with_their_errors():
    """A limit of the data is given as one."""
    for viscosity, words in (
        ((0.1198, 0.0006, 0.1186, 0.121), "viscosity: 0.11980 ± 0.00060 Pa s"),
        ((36.9, 84.8, 7.69, np.inf), "viscosity: above 7.69 (95 %) Pa s"),
        ((1e8, 3e15, 0.0, np.inf), "viscosity: not determined"),
        ((0.2, 0.3, 0.0, np.inf), "viscosity: not determined"),
    ):
        text = summarise_comparison(comparison(Estimate(*viscosity, "Pa s")))
        lines = text.splitlines()
        assert lines[0] == "Squeeze carries the film."
        assert lines[2].split() == ["a", "pin", "that", "is", "free", "sideways", "0", "0.0376"]
        assert lines[3].split() == ["a", "guided", "pin", "1021", "9.67"]
        assert words in text
        assert "film at the first frame: 6.268 ± 0.014 um" in text


def test_nothing_is_printed_of_a_fit_that_does_not_describe_the_film():
    """Neither its numbers nor what limits them."""
    found = comparison(Estimate(0.00066, 2e-6, 0.0, np.inf, "Pa s"), inflation=151.0)
    note = warn("fit", "The film does not change enough to determine the viscosity")
    text = summarise_comparison(replace(found, fit=replace(found.fit, notes=(note,))))
    assert len(text.splitlines()) == 4
    assert "viscosity" not in text


def test_a_warning_of_a_fit_is_named_as_one():
    found = comparison(Estimate(0.12, 0.001, 0.118, 0.122, "Pa s"))
    note = warn("fit", "The residuals are large")
    text = summarise_comparison(replace(found, fit=replace(found.fit, notes=(note,))))
    assert text.splitlines()[-1] == "  warning: fit: The residuals are large"


def test_models_that_could_not_be_fitted_are_listed_with_the_reason():
    found = comparison(Estimate(0.12, 0.001, 0.118, 0.122, "Pa s"))
    why = {"a pin on a sideways spring": "no film carries the load"}
    lines = summarise_comparison(replace(found, not_fitted=why)).splitlines()
    assert lines[4].endswith("not fitted: no film carries the load")
    assert lines[4].split("  ")[1] == "a pin on a sideways spring"


def test_errors_of_given_numbers_stand_beside_that_of_the_fit():
    parts = {"fit": 0.0006, "clearance": 0.007, "load_line": 0.0016}
    found = comparison(Estimate(0.1598, 0.0072, 0.146, 0.174, "Pa s", parts))
    text = summarise_comparison(found)
    words = "viscosity: 0.1598 ± 0.0072 Pa s: fit 0.0006, clearance 0.007, load line 0.0016"
    assert words in text.splitlines()[-2]


def test_the_load_line_of_a_guided_pin_is_not_printed():
    """Photographed with a line of 0.75 mm, it was found at 2.818 ± 0.028 mm."""
    found = comparison(Estimate(0.12, 0.001, 0.118, 0.122, "Pa s"))
    line = {"load_line": Estimate(2.818e-3, 28e-6, 2.76e-3, 2.87e-3, "m")}
    for held in ("free", "guided"):
        fit = replace(found.fit, sideways=held, estimates=dict(found.fit.estimates) | line)
        text = summarise_comparison(replace(found, fit=fit))
        assert ("load line" in text) == (held == "free")
        assert "viscosity: 0.1200 ± 0.0010 Pa s" in text
