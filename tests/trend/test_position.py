"""The position of the pin in known gaps of exact circles: values, covariance and form."""

from dataclasses import fields, replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.fixture import assert_covers
from scenes.gap import (
    AXIAL_ORIGIN,
    BORE,
    LOAD_LINE,
    PIN,
    TURNED,
    VIEW,
    WHOLE,
    circle_gap,
    exact_ratios,
    exchange_axes,
    known_calibration,
    noisy_ratios,
)

from erlif.calibration import RunCurve, record_calibration
from erlif.core.errors import ConfigError
from erlif.rig import RigSettings
from erlif.rig.film import draw_marks
from erlif.show.plots import example_film
from erlif.trend import FittedNumbers, find_pin_position, pin_covariance

ON_THE_BORE = np.array([1, np.sqrt(BORE / PIN)] * 2)
"""Numbers of the formula over those of circles, whose gap has the slope -ey/R2 on the bore."""


def find(film_or_ratios, *, calibration=None, view=VIEW, region=WHOLE):
    given = film_or_ratios
    ratios = exact_ratios(given) if isinstance(given, np.ndarray) else given
    return find_pin_position(ratios, calibration or known_calibration(), region=region, view=view)


def assert_near(found, expected, tolerance):
    error = np.abs(np.subtract(found, expected))
    assert (error <= tolerance).all(), error


@pytest.mark.parametrize(
    "truth", [(227.0, 0.0, 0.0, 0.0), (228.5, 12.0, 0.03, -0.2), (224.0, -15.0, -0.05, 0.3)]
)
def test_position_of_an_exact_circle_comes_back(truth):
    """To the terms of the fourth order in phi, 2 nm, and the width of a block."""
    found = find(circle_gap(*truth))
    assert_near(found.value, truth * ON_THE_BORE, [4e-3, 2e-2, 5e-4, 5e-3])
    # the form of circles has no bend; their curvature is that of the formula to h/R1
    assert_near(found.form.value, 0, [3e-4, 5e-5])


def test_load_line_and_axial_origin_only_turn_and_shift_the_numbers():
    """The same gap from a load line 0.05 rad further, and from 2 mm further along the axis."""
    film = circle_gap(227.0, 5.0, 0.02, 0.1)
    here = find(film).value
    turned = find(film, view=replace(VIEW, load_line=LOAD_LINE + 0.05 * VIEW.radius)).value
    cos, sin = np.cos(0.05), np.sin(0.05)
    expected = [cos * here[0] + sin * here[1], cos * here[1] - sin * here[0]]
    npt.assert_allclose(turned[:2], expected, atol=3e-3)

    shifted = find(film, view=replace(VIEW, axial_origin=AXIAL_ORIGIN + 2.0)).value
    npt.assert_allclose(shifted[:2], here[:2] + 2.0 * here[2:], atol=1e-3)
    npt.assert_allclose(shifted[2:], here[2:], atol=1e-4)


def test_image_with_x_and_y_exchanged_gives_the_same_position():
    ratios = noisy_ratios(circle_gap(227.0, 5.0, 0.02, 0.1), 0.01, np.random.default_rng(6))
    view = replace(VIEW, sliding_along_x=False)
    found = find(exchange_axes(ratios), view=view, region=TURNED)
    npt.assert_allclose(found.value, find(ratios).value, rtol=1e-6, atol=1e-9)


def draw_positions(rng):
    """Films of 1.5 to 6 um, off the load line by up to 3 degrees, tilts of the thesis's rig."""
    return np.array(
        [
            230 - rng.uniform(1.5, 6.0),
            rng.uniform(-12, 12),
            rng.uniform(-0.03, 0.03),
            rng.uniform(-0.2, 0.2),
        ]
    )


def pulls_of(draws, marks=None, rows=None, columns=None):
    """Errors over standard deviations of positions and form, with a new calibration each."""
    covariance = known_calibration().full_covariance
    root = np.linalg.cholesky(covariance)
    pulls = []
    for seed in range(draws):
        rng = np.random.default_rng([31, seed])
        truth = draw_positions(rng)
        film = circle_gap(*truth)
        if marks is not None:
            film = np.maximum(film + draw_marks(marks, rng)(columns, rows), 0.05)
        fitted = known_calibration().parameters + root @ rng.standard_normal(3)
        found = find(noisy_ratios(film, 0.0135, rng), calibration=known_calibration(*fitted))
        error = np.concatenate([found.value - truth * ON_THE_BORE, found.form.value])
        parts = found.covariance(covariance), found.form.covariance(covariance)
        pulls.append(error / np.sqrt(np.concatenate([np.diag(part) for part in parts])))
    return pulls


def test_covariance_covers_noise_and_calibration():
    assert_covers(pulls_of(60))


@pytest.mark.slow
def test_covariance_covers_turned_and_scratched_surfaces():
    rows, columns = np.indices(circle_gap(227.0, 0.0).shape, dtype=float)
    assert_covers(pulls_of(60, RigSettings(), rows + 40, columns + 60))


def test_random_covariance_is_the_scatter():
    """Scatter of 100 positions of one gap, 7 % of it known; correlations to 0.15."""
    film = circle_gap(227.0, 4.0, 0.01, 0.1)
    found = [find(noisy_ratios(film, 0.0135, np.random.default_rng([32, n]))) for n in range(100)]
    scatter = np.cov(np.array([one.value for one in found]).T)
    claimed = np.mean([one.random_cov for one in found], axis=0)
    npt.assert_allclose(np.sqrt(np.diag(claimed) / np.diag(scatter)), 1, atol=0.21)

    def correlations(cov):
        std = np.sqrt(np.diag(cov))
        return cov / std / std[:, None]

    npt.assert_allclose(correlations(claimed), correlations(scatter), atol=0.3)


@pytest.mark.parametrize("parameter", range(3))
def test_gradients_are_the_change_with_the_calibration(parameter):
    """To 5 % and a hundredth of the random error, through which the weights change a little."""
    ratios = noisy_ratios(circle_gap(227.0, 4.0, 0.01, 0.1), 0.0135, np.random.default_rng(5))
    base = find(ratios)
    changed = list(known_calibration().parameters)
    changed[parameter] += 2e-4
    moved = find(ratios, calibration=known_calibration(*changed))
    for before, after in (base, moved), (base.form, moved.form):
        expected = 2e-4 * before.gradient[:, parameter]
        tolerance = 0.05 * np.abs(expected) + 0.01 * np.sqrt(np.diag(before.random_cov))
        assert_near(after.value - before.value, expected, tolerance)


def test_position_is_missing_where_the_blocks_do_not_determine_it():
    """A column and a row of blocks leave the side tilt open."""
    for corner in (slice(None), slice(8, None)):
        ratios = noisy_ratios(circle_gap(227.0, 3.0), 0.01, np.random.default_rng(10))
        ratios.flags.values[corner, corner] = 128
        found = find(ratios)
        for part in found, found.form:
            for one in fields(FittedNumbers):
                assert np.isnan(getattr(part, one.name)).all()
        assert found.gradient.shape == (4, 3)
        assert found.form.gradient.shape == (2, 3)


def test_load_line_on_the_other_side_of_the_joint_is_refused():
    with pytest.raises(ConfigError, match="load_line"):
        find(circle_gap(227.0, 0.0), view=replace(VIEW, load_line=100.0))


def make_film_of(positions):
    """The variables of a film that hold these positions."""
    calibration = known_calibration()
    shared = calibration.full_covariance
    numbers = ("trigger", "parameter", "parameter_other")
    return xr.Dataset(
        {
            "pin_position_cov": (numbers, [one.covariance(shared) for one in positions]),
            "pin_position_cov_random": (numbers, [one.random_cov for one in positions]),
            "pin_position_gradient": (
                ("trigger", "parameter", "calibration_parameter"),
                [one.gradient for one in positions],
            ),
        },
        attrs=example_film().attrs | {"calibration": record_calibration(RunCurve.of(calibration))},
    )


def test_mean_of_many_positions_keeps_the_errors_of_surfaces_and_calibration():
    """Eight times the same gap: noise falls by eight, the rest does not."""
    one = find(noisy_ratios(circle_gap(227.0, 4.0), 0.0135, np.random.default_rng(51)))
    whole = pin_covariance(make_film_of([one] * 8))
    mean = np.tile(np.eye(4), 8) / 8
    shared = one.gradient @ known_calibration().full_covariance @ one.gradient.T
    expected = one.random_cov / 8 + one.surface_cov + shared
    npt.assert_allclose(mean @ whole @ mean.T, expected, rtol=1e-6, atol=1e-10)


def test_covariance_of_all_triggers_has_that_of_each_on_its_diagonal():
    found = [
        find(noisy_ratios(circle_gap(228.0 - n, 4.0 * n), 0.0135, np.random.default_rng([52, n])))
        for n in range(3)
    ]
    whole = pin_covariance(make_film_of(found))
    assert np.linalg.eigvalsh(whole).min() > 0
    for n, one in enumerate(found):
        here = slice(4 * n, 4 * n + 4)
        expected = one.covariance(known_calibration().full_covariance)
        npt.assert_allclose(whole[here, here], expected, rtol=1e-6, atol=1e-10)
