"""Mean and minimum film thickness of a region, with their uncertainties."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.gap import (
    RANGE,
    WHOLE,
    X,
    Y,
    known_calibration,
    known_gap,
    noisy_ratios,
    true_log_ratio,
)

from erlif.calibration import RunCurve, Systematics
from erlif.thickness import measure_thickness
from erlif.trend import FilmNumber, Region, summarise_film

EVEN = np.full((Y.size, X.size), 6.0)


def summarise(ratios, *, calibration=None, region=WHOLE):
    calibration = calibration or known_calibration()
    maps = measure_thickness(ratios, calibration)
    return summarise_film(ratios, maps, calibration, region=region)


def test_means_are_those_of_the_region_alone():
    region = Region(slice(20, 100), slice(30, 90))
    found = summarise(noisy_ratios(known_gap(2.0), 1e-3, np.random.default_rng(1)), region=region)
    of_region = known_gap(2.0)[20:100, 30:90].mean()
    npt.assert_allclose(found.mean.value, of_region, atol=1e-3)
    npt.assert_allclose(found.gap.mean.value, of_region, atol=1e-3)


def test_the_gap_has_a_mean_where_part_of_the_film_is_beyond_the_range():
    """Without noise: mean of the whole parabola, part of which lies above 16 um."""
    film = known_gap(13.0)
    found = summarise(noisy_ratios(film, 1e-4, np.random.default_rng(4)))
    assert found.beyond_range > 0.1
    assert found.mean.value < film.mean() - 0.3
    npt.assert_allclose(found.gap.mean.value, film.mean(), atol=0.02)


@pytest.mark.parametrize("minimum", [2.0, 13.0])
def test_mean_inverse_is_that_of_the_region_also_where_no_film_is_measured(minimum):
    """A bubble over 30 by 40 pixels of the thin line, and a part above the range of 16 um."""
    film = known_gap(minimum)
    ratios = noisy_ratios(film, 1e-4, np.random.default_rng(4))
    ratios.flags[40:70, 100:140] = 1
    found = summarise(ratios)
    assert found.measured < 0.97
    assert abs(found.inverse.value * (film**-1).mean() ** -1 - 1) > 0.005
    npt.assert_allclose(found.region_inverse.value, (1 / film).mean(), rtol=1e-3)


def test_without_a_gap_the_inverse_of_what_is_not_measured_is_not_known():
    """Uniform between none and twice the rest: a standard deviation of its share over root 3."""
    film = known_gap(2.0)
    found = summarise(noisy_ratios(film, 1e-4, np.random.default_rng(4)))
    lost = replace(
        found, gap=found.gap._replace(unseen=FilmNumber.unknown(3)), measured=0.7
    ).region_inverse
    assert lost.value == found.inverse.value
    npt.assert_allclose(lost.random_std, 0.3 * found.inverse.value / np.sqrt(3), rtol=1e-3)


def test_mean_has_no_bias_where_the_inverse_is_curved():
    """Noise of 3 % biases the inverse of single pixels at 6 um by more than 0.05 um."""
    ratios = noisy_ratios(EVEN, 0.03, np.random.default_rng(3))
    raw = float(measure_thickness(ratios, known_calibration()).thickness.mean()) - 6.0
    assert raw > 0.05
    assert abs(summarise(ratios).mean.value - 6.0) < 0.25 * raw


def test_random_error_of_independent_pixels_falls_with_the_root_of_their_number():
    """Noise of the log ratio over its slope, divided by the root of 32 000 pixels."""
    film, step = 6.0, 1e-4
    slope = (true_log_ratio(film + step) - true_log_ratio(film - step)) / (2 * step)
    found = summarise(noisy_ratios(EVEN, 0.01, np.random.default_rng(5)))
    npt.assert_allclose(found.mean.random_std, 0.01 / slope / np.sqrt(EVEN.size), rtol=0.01)


def test_error_of_the_displacement_is_correlated_over_a_block():
    """8 x 8 px move together: the error of a mean is eight times that of independent pixels."""
    ratios = noisy_ratios(EVEN, 0.01, np.random.default_rng(5))
    plain = summarise(ratios).mean.random_std
    ratios.log_ratio_var_shared.values[:] = 0.01**2
    npt.assert_allclose(summarise(ratios).mean.random_std, plain * np.hypot(1, 8), rtol=0.02)


def test_total_error_bars_add_the_calibration_in_quadrature():
    """First-order propagation of the covariance through the gradients."""
    found = summarise(noisy_ratios(known_gap(3.0), 0.01, np.random.default_rng(6)))
    covariance = known_calibration().covariance
    for number in (found.mean, found.gap.minimum, found.gap.mean):
        shared = number.gradient @ covariance @ number.gradient
        own = number.random_std**2 + number.surface_std**2
        npt.assert_allclose(number.std(covariance) ** 2, own + shared)


@pytest.mark.parametrize("parameter", range(3))
def test_gradients_are_the_change_with_the_calibration(parameter):
    """Invert the same ratios with a calibration that is slightly off."""
    ratios = noisy_ratios(known_gap(3.0), 0.002, np.random.default_rng(5))
    base = summarise(ratios)
    changed = list(known_calibration().parameters)
    changed[parameter] += 2e-4
    moved = summarise(ratios, calibration=known_calibration(*changed))
    for before, after in (
        (base.mean, moved.mean),
        (base.gap.minimum, moved.gap.minimum),
        (base.gap.mean, moved.gap.mean),
    ):
        expected = 2e-4 * before.gradient[parameter]
        npt.assert_allclose(after.value - before.value, expected, rtol=0.03)


def test_share_beyond_the_range_is_that_of_the_gap():
    """A gap that is partly thicker than the calibrated range."""
    film = known_gap(14.0)
    found = summarise(noisy_ratios(film, 1e-4, np.random.default_rng(4)))
    npt.assert_allclose(found.beyond_range, (film > RANGE[1]).mean(), atol=0.01)


@pytest.mark.parametrize(("minimum", "noise"), [(9.5, 0.02), (5.0, 0.05)])
def test_mean_is_that_of_the_valid_pixels_where_much_lies_beyond_the_range(minimum, noise):
    """No bias by the pixels that noise moves across the limit."""
    film, calibration = known_gap(minimum), known_calibration()
    errors = []
    for seed in range(20):
        ratios = noisy_ratios(film, noise, np.random.default_rng([9, seed]))
        maps = measure_thickness(ratios, calibration)
        found = summarise_film(ratios, maps, calibration, region=WHOLE)
        mean = film[maps.flags.values == 0].mean()
        errors.append((found.mean.value - mean) / found.mean.random_std)
    assert found.beyond_range > 0.05
    assert abs(np.mean(errors)) < 4 / np.sqrt(20)
    assert np.std(errors) < 1.6


def test_mean_remains_where_the_minimum_is_not_determined():
    """One row of blocks leaves the tilt of the gap open."""
    ratios = noisy_ratios(known_gap(3.0), 0.01, np.random.default_rng(10))
    ratios.flags.values[8:] = 128
    found = summarise(ratios)
    assert np.isnan(found.gap.minimum[:3]).all()
    assert np.isfinite(found.mean[:3]).all()


def test_ratios_that_no_film_has_give_no_mean():
    """Ratios tenfold those of the films, as below a shadow in a flat: extrapolated to 1e3 um."""
    ratios = noisy_ratios(EVEN, 0.01, np.random.default_rng(5))
    maps = measure_thickness(ratios, known_calibration())
    ratios.log_ratio.values[:] += np.log(10.0)
    found = summarise_film(ratios, maps, known_calibration(), region=WHOLE)
    assert np.isnan(found.mean[:3]).all()


def test_mean_has_no_bias_by_a_texture_that_the_cameras_do_not_share():
    """Focused unlike: the ratio scatters by 6 %, where its stated variance is that of 1 %."""
    rng = np.random.default_rng(21)
    film = known_gap(6.0)
    ratios = noisy_ratios(film, 0.06, rng)
    ratios["log_ratio_var"] = 0 * ratios.log_ratio_var + 1e-4
    inside = np.s_[:, 40:160]  # films below 11 um, of which all pixels are measurable
    part = Region(slice(0, Y.size), slice(40, 160))
    assert film[inside].max() < 11
    found = summarise(ratios, region=part)
    scatter = 0.06 / np.sqrt(film[inside].size) / 0.02  # of a slope of 0.02 1/um at most
    assert abs(found.mean.value - film[inside].mean()) < 4 * scatter


def test_a_mean_beyond_the_calibrated_range_is_none():
    """Half of the pixels of a film of 16.2 um read less than 16 um by their noise."""
    ratios = noisy_ratios(EVEN + 10.2, 0.002, np.random.default_rng(22))
    assert np.isnan(summarise(ratios).mean.value)


SHAPES = {
    "field x": lambda x, y: np.sqrt(3) * x,
    "field y": lambda x, y: np.sqrt(3) * y,
    "field xx": lambda x, y: np.sqrt(5) * (3 * x**2 - 1) / 2,
    "field xy": lambda x, y: 3 * x * y,
    "field yy": lambda x, y: np.sqrt(5) * (3 * y**2 - 1) / 2,
}


@pytest.mark.parametrize("name", SHAPES)
def test_a_change_over_the_field_moves_every_number_as_its_gradient(name):
    """The ratio is changed by a Legendre polynomial of rms 1 over root 5, and measured again."""
    y, x = np.meshgrid(np.linspace(-1, 1, Y.size), np.linspace(-1, 1, X.size), indexing="ij")
    systematics = Systematics.of({"field": 0.005}, parameters=3, frame=x.shape)
    curve = RunCurve.of(replace(known_calibration(), systematics=systematics))
    place = 3 + [one.name for one in systematics.parameters].index(name)

    part, step = Region(slice(20, 150), slice(30, 180)), 2e-4
    ratios = noisy_ratios(known_gap(3.0), 1e-3, np.random.default_rng(5))
    base = summarise(ratios, calibration=curve, region=part)
    ratios["log_ratio"] = ratios.log_ratio + step * SHAPES[name](x, y) / np.sqrt(5)
    moved = summarise(ratios, calibration=curve, region=part)
    for before, after in (
        (base.mean, moved.mean),
        (base.inverse, moved.inverse),
        (base.gap.minimum, moved.gap.minimum),
        (base.gap.mean, moved.gap.mean),
    ):
        change, expected = after.value - before.value, -step * before.gradient[place]
        # 2 % of what such a change of the ratio is at 3 um, by the slope of the film in a block
        npt.assert_allclose(change, expected, rtol=0.05, atol=8e-5)
