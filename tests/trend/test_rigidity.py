"""Errors of a run from the gap of its joint, on simulated cells of exact circles."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import find_films, with_systematics

from erlif.ratio import LightCells, cell_centres
from erlif.show.plots import example_calibration
from erlif.trend import PinView, estimate_errors
from erlif.trend.factor_kind import FactorKind
from erlif.trend.pattern import PatternSize
from erlif.trend.texture import Texture

SHAPE, PITCH = (256, 320), 0.06
PIN, BORE = 33.36, 33.59
"""Rows and columns, size of a pixel and radii. [px, px, mm, mm]"""
VIEW = PinView(PIN * 1e-3, BORE * 1e-3, PITCH, load_line=10.0, axial_origin=7.65)
WIDTHS = {"ratio": 0.01, "temperature": 0.005, "bleaching": 0.01, "size": 0.005}
PLAIN = example_calibration()
K, P, Q = PLAIN.parameters
CALIBRATION = with_systematics(PLAIN, **WIDTHS)
PASSED = np.linspace(0, 1, 30)
FILMS = np.array([3.0, 6.0, 8.0])


def gap_of_circles(minimum, *, side=0.0, tilt=0.0, bore=BORE):
    """Distance between two circles along the radius of the bore, in each cell. [um]"""
    x, z = (PITCH * centre for centre in cell_centres(SHAPE))
    phi = (x - 10.0) / np.sqrt(PIN * BORE)
    towards = bore - PIN - 1e-3 * (minimum + tilt * (z - 7.65) / 7.65)
    across = 1e-3 * side
    along = towards * np.cos(phi) + across * np.sin(phi)
    beside = -towards * np.sin(phi) + across * np.cos(phi)
    return 1e3 * (bore - along - np.sqrt(PIN**2 - beside**2))


def draw_errors(rng):
    """One error of each kind by its width: of the ratio, of the dyes, and of the fixture."""
    ratio = 0.01 * rng.standard_normal() + 0.005 * rng.standard_normal()
    rising = 0.01 * rng.standard_normal() + 0.005 * rng.standard_normal()
    absorption, size = 0.01 * rng.standard_normal(), 0.005 * rng.standard_normal()
    return ratio, rising, absorption, size


def log_ratio(film, passed, errors, dyes=(K, P, Q)):
    """That of a film by the narrow-band law; the fixture was thicker than its profile by size."""
    (ratio, rising, absorption, size), (k, p, q) = errors, dyes
    h = film * (1 + size) * (1 - absorption * passed)
    law = np.log(k * p * np.expm1(-q * h) / (q * np.expm1(-p * h)))
    return law + ratio + rising * passed


def draw_roundness(rng):
    """Departure of pin and bore from circles: 0.5 um at the edge, and marks of 0.1 um. [um]"""
    x, z = (PITCH * centre for centre in cell_centres(SHAPE))
    u, v = (one / np.abs(one).max() for one in (x - 10.0, z - 7.65))
    smooth = (u**2, v**2, u**3, u**2 * v, u * v**2, v**3, u**4)
    return 0.5 * rng.standard_normal(7) @ smooth + 0.1 * rng.standard_normal(u.size)


def draw_run(rng, errors, *, films=(3.0, 7.0), bore=BORE, form=0.0, dyes=(K, P, Q), noise=1e-3):
    """Record of a run with these errors; the pin moves, tilts and turns aside."""
    minimum = np.mean(films) + np.ptp(films) / 2 * np.cos(3 * np.pi * PASSED)
    gaps = np.array(
        [
            gap_of_circles(film, side=rng.normal(0, 5), tilt=rng.normal(0, 0.2), bore=bore)
            for film in minimum
        ]
    )
    gaps = gaps + form
    ratio = log_ratio(gaps, PASSED[:, None], errors, dyes)
    ratio = ratio + noise * rng.standard_normal(gaps.shape)
    light = np.log((1 - np.exp(-P * gaps)) / P) + 0.05 * rng.standard_normal((len(gaps), 1))
    return LightCells(light, ratio, np.zeros(gaps.shape), np.full(gaps.shape, noise**2))


def estimate(record, calibration=CALIBRATION, **changes):
    options = {"passed": PASSED, "clearance_std": 2.0} | changes
    return estimate_errors(record, cell_centres(SHAPE), calibration, VIEW, **options)


def true_shift(errors, passed, dyes=(K, P, Q)):
    """Measured less true film where a run has these errors, by the plain curve. [um]"""
    return find_films(PLAIN, log_ratio(FILMS, passed, errors, dyes)) - FILMS


def test_the_errors_that_remain_follow_their_covariance():
    """Of 60 runs drawn from all that is taken as unknown: shift of three films at the end.

    The clearance is known to 2 um by its radii, and to 1 % of 230 um at best.
    """
    rng, pulls, gains = np.random.default_rng(5), [], []
    curve = CALIBRATION.at(1.0)
    for _ in range(60):
        errors, dyes = draw_errors(rng), rng.multivariate_normal((K, P, Q), PLAIN.covariance)
        bore = BORE + 1e-3 * np.hypot(2.0, 2.3) * rng.standard_normal()
        record = draw_run(rng, errors, bore=bore, form=draw_roundness(rng), dyes=dyes)
        found, shift = estimate(record), true_shift(errors, 1.0, dyes)
        std = found.film_std(FILMS, curve)
        pulls.append((shift - found.film_shift(FILMS + shift, curve)) / std)
        gains.append(found.film_std(FILMS, curve, before=True) / std)

    # sixty runs give the scatter to 9 %
    npt.assert_allclose(np.std(pulls, axis=0), 1, atol=3.2 * 0.09)
    npt.assert_allclose(np.mean(pulls, axis=0), 0, atol=3.5 / np.sqrt(60))
    assert np.min(gains) > 1.3


class Still(Texture):
    """A pattern in cells that are points."""

    def in_cells(self, centres):
        apart = sum(np.subtract.outer(at, at) ** 2 for at in centres)
        return self.found.size**2 * np.exp(-apart / self.found.length**2)


@pytest.mark.slow
def test_the_errors_that_remain_beside_a_pattern_follow_their_covariance():
    """Thirty runs, each with another pattern of 1 % over 60 px; without it as unknown 2 or more.

    The pattern is found within its own covariance.
    """
    rng, curve = np.random.default_rng(7), CALIBRATION.at(1.0)
    texture = Still(PatternSize(0.01, std=1e-3, length=60.0, gain=100.0), FactorKind(5.0))
    covariance = texture.in_cells(cell_centres(SHAPE))
    pulls, squares = {"known": [], "left out": []}, []
    for _ in range(30):
        errors, form = draw_errors(rng), draw_roundness(rng)
        still = rng.multivariate_normal(np.zeros(len(covariance)), covariance)
        record = draw_run(rng, errors, form=form)
        record = record._replace(log_ratio=record.log_ratio + still)
        shift = true_shift(errors, 1.0)
        for name, unknown in (("known", texture), ("left out", None)):
            if (found := estimate(record, texture=unknown)) is None:
                continue
            std = found.film_std(FILMS, curve)
            pulls[name].append((shift - found.film_shift(FILMS + shift, curve)) / std)
            if found.pattern is not None:
                off = still - found.pattern.value
                squares.append(off @ np.linalg.solve(found.pattern.covariance, off) / off.size)
    known = np.array(pulls["known"])
    assert len(known) == 30
    npt.assert_allclose(np.std(known, axis=0), 1, atol=3.2 * 0.13)
    npt.assert_allclose(np.mean(known, axis=0), 0, atol=3.5 / np.sqrt(30))
    assert 0.85 < np.mean(squares) < 1.15
    assert (np.std(pulls["left out"], axis=0) > 1.8).all()


def test_a_scale_of_the_ratio_is_found_and_taken_out():
    errors = (0.02, 0.0, 0.0, 0.0)
    found = estimate(draw_run(np.random.default_rng(1), errors))
    systematics = CALIBRATION.systematics.with_errors(found.covariance, found.value)
    corrected = replace(CALIBRATION, systematics=systematics)
    before, after = (
        curve.inverse.look_up(log_ratio(FILMS, 0.5, errors)) - FILMS
        for curve in (PLAIN, corrected.at(0.5))
    )
    npt.assert_array_less(0.2, before)
    npt.assert_array_less(np.abs(after), 3 * found.film_std(FILMS, CALIBRATION.at(0.5)))
    npt.assert_array_less(np.abs(after), 0.4 * before)


def test_noise_of_the_flats_is_no_error_of_all_films():
    """It is the same in all frames, other in each cell; the curve of 20 sound runs is right."""
    rng, shifts = np.random.default_rng(9), []
    for _ in range(20):
        record = draw_run(rng, (0.0,) * 4)
        flats = 1e-3 * rng.standard_normal(record.log_ratio.shape[1])
        found = estimate(record._replace(log_ratio=record.log_ratio + flats))
        shifts.append(found.film_shift(FILMS, CALIBRATION.at(0.5)))
    scatter = np.std(shifts, axis=0) / np.sqrt(len(shifts))
    npt.assert_array_less(np.abs(np.mean(shifts, axis=0)), 3.5 * scatter)


def test_a_pin_that_stays_determines_less():
    """At one minimum film it only turns aside and tilts a little.

    An error that is the same for all films is a displacement of the pin; the others are compared.
    """
    good = replace(PLAIN, covariance=0.01 * PLAIN.covariance)
    open_terms = with_systematics(good, ratio=0.01, wall=0.02)
    still, moving = (
        estimate(draw_run(np.random.default_rng(2), (0.0,) * 4, films=films), open_terms)
        for films in ((5.0, 5.0), (2.0, 8.0))
    )
    by_error = open_terms.film_gradient(FILMS)
    apart = by_error[:, 2] - by_error[:, 0]
    one, other = (apart @ found.covariance @ apart for found in (still, moving))
    assert 2 * other < one


def test_radii_that_are_wrong_within_their_digits_stay_within_the_errors():
    """The bore is 4 um larger than stated, of a clearance that is known to 4 um."""
    record = draw_run(np.random.default_rng(3), (0.0,) * 4, bore=BORE + 4e-3)
    found, curve = estimate(record, clearance_std=4.0), CALIBRATION.at(0.5)
    npt.assert_array_less(np.abs(found.film_shift(FILMS, curve)), 2 * found.film_std(FILMS, curve))


@pytest.mark.parametrize("share", [0.3, -0.3])
def test_errors_far_beyond_their_widths_are_not_estimated(share):
    record = draw_run(np.random.default_rng(4), (share, 0.0, 0.0, 0.0))
    assert estimate(record) is None


def test_the_second_moment_holds_the_shift():
    found = estimate(draw_run(np.random.default_rng(6), (0.02, 0.0, 0.0, 0.0)))
    curve = CALIBRATION.at(0.5)
    by_error = curve.film_gradient(FILMS)
    std = np.sqrt(np.einsum("if,ij,jf->f", by_error, found.second_moment, by_error))
    expected = np.hypot(found.value @ by_error, found.film_std(FILMS, curve))
    npt.assert_allclose(std, expected, rtol=1e-9)
