"""Errors of the films by source: they add up to the stated ones, and the largest is named."""

import re

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.film import run_settings
from scenes.preparing import UNREAD
from scenes.results import make_statistics

from erlif.calibration import RunCurve
from erlif.pipeline.physics.errors import describe_errors, name_largest_error, shared_errors
from erlif.pipeline.physics.systematics import add_systematics
from erlif.show.plots import example_calibration


def with_systematics(text):
    """The calibration of the example with the systematics of settings; no frame is sampled."""
    plain = RunCurve.of(example_calibration())
    return add_systematics(plain, run_settings(text), UNREAD, (), [])


def test_sources_of_error_add_up_and_the_largest_is_named():
    calibration = with_systematics('\n[systematics]\nwall = "5 %"\n')
    parameters = len(calibration.full_covariance)
    rng = np.random.default_rng(1)
    statistics = []
    for k in range(3):
        gradient = calibration.film_gradient(4.0 + k) + 1e-3 * rng.normal(size=parameters)
        statistics.append(make_statistics(mean=4.0 + k, gradient=gradient))

    film = xr.Dataset(describe_errors(statistics, calibration))
    for name, numbers in (
        ("film_mean_error", [one.mean for one in statistics]),
        ("film_min_error", [one.gap.minimum for one in statistics]),
    ):
        total = np.sqrt((film[name] ** 2).sum("error_term"))
        stated = [one.std(calibration.full_covariance) for one in numbers]
        npt.assert_allclose(total, stated, rtol=1e-9)

    # surfaces of one size, which all triggers share, and the calibration, without the noise
    apart = np.sqrt((shared_errors(statistics, calibration) ** 2).sum(axis=1))
    rest = film.film_min_error.where(film.error_term != "noise", 0.0)
    npt.assert_allclose(apart, np.sqrt((rest**2).sum("error_term")), rtol=1e-9)

    nothing = make_statistics(gradient=np.full(parameters, np.nan), surface=np.nan)
    assert np.isnan(describe_errors([nothing], calibration)["film_mean_error"]).all()
    assert np.isnan(shared_errors([nothing], calibration)).all()

    # what a gap leaves of a map that has another form is no mark of the surfaces
    departing = make_statistics(gradient=gradient, misfit=2.0)
    both = xr.Dataset(describe_errors([statistics[0], departing], calibration)).film_min_error
    assert both.sel(error_term="form").values.tolist() == [0.0, 0.04]
    assert both.sel(error_term="marks").values.tolist() == [0.04, 0.0]
    assert "form" not in film.error_term

    film["film_mean"] = "trigger", np.array([4.0, 5.0, 6.0])
    text = name_largest_error(film, run_settings(), calibration, calibration)
    of_wall = 1e3 * float(film.film_mean_error.sel(error_term="wall")[1])  # nm
    assert "reflectance of the wall" in text
    assert f"{of_wall:.0f} nm at 5 um" in text


@pytest.mark.parametrize(
    ("term", "text", "source"),
    [
        ("wall", "", "Not stated in [systematics]. "),
        ("wall", '\n[systematics]\nwall = "2 %"\n', "As stated in [systematics]. "),
        ("position", "", ""),  # fixture.toml states it, which the run does not know
    ],
)
def test_largest_error_is_named_with_its_source(term, text, source):
    film = xr.Dataset(
        {"film_mean": ("trigger", [5.0]), "film_mean_error": (("error_term", "trigger"), [[0.1]])},
        {"error_term": [term]},
    )
    run = with_systematics(text)
    named = name_largest_error(film, run_settings(text), run, run)
    assert re.match(rf"100 nm at 5 um: [a-z ]+\. {re.escape(source)}Make ", named)
