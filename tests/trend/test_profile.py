"""The profile along sliding and the gap of rigid bodies in it, on films made by formula."""

import tomllib

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.film import CLEARANCE, RADIUS, RUN_TOML, K, P, Q, known_calibration, true_ratio

from erlif.core.flags import Flag
from erlif.io.settings import RunSettings, to_toml
from erlif.trend import (
    RigidGap,
    average_across_sliding,
    cut_through_minimum,
    place_of_minimum,
    rigid_gap,
)

ROWS, COLUMNS = 64, 160
X, Y = 0.1 * np.arange(COLUMNS), 0.2 * np.arange(ROWS)  # mm
INSIDE = (Y >= 1) & (Y <= 11)  # the axial extent of the region of interest [mm]
CENTRE = 8.1  # mm
NOISE = 0.01  # of the log ratio
GRID = np.linspace(0.05, 40, 20000)
EXACT, CORRELATED = 1e-20 * np.eye(3), (np.diag([1e-3, 2e-3, 1e-3]) ** 2)


def bend(minimum):
    """Second derivative of the gap of two cylinders, the distance of the middles over R1 R2."""
    return (1 - minimum / CLEARANCE) / RADIUS


def parabola(minimum=3.0, *, centre=CENTRE, radius=None):
    """Gap of two cylinders, constant across sliding. (y, x) [um]"""
    second = bend(minimum) if radius is None else 1 / radius
    return np.broadcast_to(minimum + second * (X - centre) ** 2 / 2, (ROWS, COLUMNS))


def make_film(truth, *, noise=0.0, turned=False, covariance=EXACT):
    """A film of one trigger whose log ratio has the given noise, (y, x) or a standard deviation."""
    settings = tomllib.loads(RUN_TOML)
    if turned:
        settings["optics"]["x_axis"] = "axial"
        roi = settings["thickness"]["roi"]
        settings["thickness"]["roi"] = {"x": roi["y"], "y": roi["x"]}
    thickness = np.interp(np.log(true_ratio(truth)) + noise, np.log(true_ratio(GRID)), GRID)
    std = NOISE * np.interp(thickness, GRID, np.gradient(GRID, np.log(true_ratio(GRID))))
    dims = ("trigger", "x", "y") if turned else ("trigger", "y", "x")
    film = xr.Dataset(
        {
            "thickness": (dims, thickness[None].astype(np.float32)),
            "thickness_std": (dims, std[None].astype(np.float32)),
            "thickness_std_shared": (dims, np.full((1, *truth.shape), 0.02, np.float32)),
            "flags": (dims, np.zeros((1, *truth.shape), np.uint16)),
        },
        {"x": Y, "y": X} if turned else {"x": X, "y": Y},
    )
    return film.assign_attrs(
        settings=to_toml(RunSettings.model_validate(settings)),
        calibration=known_calibration(covariance),
    )


def white_noise(seed, std=NOISE):
    return std * np.random.default_rng(seed).standard_normal((ROWS, COLUMNS))


def test_profile_averages_the_axial_extent_of_the_region():
    """Rows outside are 5 um thicker; a tilt averages to its value at the middle row."""
    tilt = np.where(INSIDE, 0.02 * (Y - Y[INSIDE].mean()), 5.0)
    profile = average_across_sliding(make_film(parabola() + tilt[:, None]), trigger=0)
    npt.assert_allclose(profile.thickness, parabola()[0], atol=2e-3)


def test_cut_goes_through_the_minimum_of_a_point_contact():
    """Film 2 + r^2/2R of a ball: the mean of the region is 4.2 um, R = 1.875 mm mm/um, thicker."""
    radius, row, minimum = 1.875, 29.6, 2.0
    away = Y - 0.2 * row
    ball = minimum + ((X - CENTRE) ** 2 + away[:, None] ** 2) / (2 * radius)
    for turned in (False, True):
        column, line = (row, CENTRE / 0.1) if turned else (CENTRE / 0.1, row)
        film = make_film(ball, turned=turned)
        film = film.assign(film_min_x=("trigger", [column]), film_min_y=("trigger", [line]))
        place = place_of_minimum(film, trigger=0)
        npt.assert_allclose(sorted(place.values()), sorted([CENTRE, 0.2 * row]))
        cut = cut_through_minimum(film, trigger=0)
        at = int(np.abs(cut.position.values - CENTRE).argmin())
        # 1 mm of 10 mm: rows within 0.5 mm of the minimum
        rows = np.abs(away) <= 0.5
        npt.assert_allclose(
            cut.thickness[at], minimum + (away[rows] ** 2).mean() / 2 / radius, atol=0.01
        )
        assert float(average_across_sliding(film, trigger=0).thickness[at]) > minimum + 1.5
    unknown = film.assign(film_min_x=("trigger", [np.nan]))
    assert place_of_minimum(unknown, trigger=0) is None
    whole = average_across_sliding(unknown, trigger=0).thickness
    npt.assert_array_equal(cut_through_minimum(unknown, trigger=0).thickness, whole)


def test_profile_has_no_bias_where_the_inverse_is_curved():
    """At 10 um the mean of single pixels with noise of 3 % is biased by more than 0.1 um."""
    film = make_film(np.full((ROWS, COLUMNS), 10.0), noise=white_noise(1, 0.03))
    assert float(film.thickness.mean()) - 10.0 > 0.1
    profile = average_across_sliding(film, trigger=0)
    assert abs(float(profile.thickness.mean()) - 10.0) < 0.04


def test_error_bars_of_the_profile_are_its_scatter():
    """Independent noise of 40 films, 160 positions each."""
    pulls = []
    for seed in range(40):
        profile = average_across_sliding(make_film(parabola(), noise=white_noise(seed)), trigger=0)
        pulls.append((profile.thickness - parabola()[0]) / profile.thickness_std)
    assert 0.9 < np.std(pulls) < 1.05


def test_noise_that_rows_share_widens_the_error_bars():
    """All pixels of a column have the same error: the mean of 51 rows is no better than one."""
    noise = np.broadcast_to(white_noise(2)[:1], (ROWS, COLUMNS))
    profile = average_across_sliding(make_film(parabola(), noise=noise), trigger=0)
    pull = (profile.thickness - parabola()[0]) / profile.thickness_std
    assert 0.7 < float(pull.std()) < 1.3  # 160 values and the estimated scatter


def test_line_with_too_few_valid_pixels_is_missing():
    """51 rows lie in the region: 12 valid ones are less than a quarter, 13 are more."""
    film = make_film(parabola())
    first = int(np.argmax(INSIDE))
    assert INSIDE.sum() == 51
    film.flags.values[0, first + 12 :, 10] = Flag.NO_FILM
    film.flags.values[0, first + 13 :, 20] = Flag.NO_FILM
    profile = average_across_sliding(film, trigger=0)
    missing = np.isnan(profile.thickness.values)
    assert np.flatnonzero(missing).tolist() == [10]
    assert np.isnan(profile.thickness_std.values[10])


@pytest.mark.parametrize("flag", [Flag.BELOW_RANGE, Flag.ABOVE_RANGE])
def test_line_that_loses_pixels_to_the_range_is_missing(flag):
    """Of 51 pixels, one beyond the range is 2.0 % and accepted, two are too many."""
    film = make_film(parabola())
    film.flags.values[0, 20, 10] = flag
    film.flags.values[0, 20:22, 20] = flag
    profile = average_across_sliding(film, trigger=0)
    assert np.flatnonzero(np.isnan(profile.thickness.values)).tolist() == [20]


def test_sliding_along_y_gives_the_same_profile():
    noise = white_noise(3)
    one = average_across_sliding(make_film(parabola(), noise=noise), trigger=0)
    two = average_across_sliding(make_film(parabola(), noise=noise, turned=True), trigger=0)
    npt.assert_allclose(two.thickness, one.thickness, rtol=1e-6)
    npt.assert_array_equal(two.position, one.position)
    assert two.position.attrs["long_name"] == "y, sliding"


def fit(film):
    return rigid_gap(average_across_sliding(film, trigger=0), film)


@pytest.mark.parametrize("centre", [5.0, 8.1, 11.0])
def test_gap_of_two_cylinders_comes_back(centre):
    """Means over blocks of 0.8 mm lie (0.8 mm)^2/24R = 5 nm above the parabola."""
    gap = fit(make_film(parabola(2.0, centre=centre)))
    npt.assert_allclose(gap.minimum, 2.0, atol=0.01)
    npt.assert_allclose(gap.position_of_minimum, centre, atol=0.01)
    npt.assert_allclose(gap.radius, 4.872010, rtol=1e-6)  # m, Farzaneh (2002)
    npt.assert_allclose(gap.curvature, 0.20347, rtol=0.01)  # um/mm2, 228 um/(33.36 x 33.59 mm2)
    npt.assert_allclose(gap.rigid_curvature, 0.20347, rtol=1e-4)


@pytest.mark.parametrize("radius", [3.0, 10.0])
def test_curvature_is_that_of_the_film_whatever_the_radii(radius):
    film = make_film(parabola(2.0, radius=radius))
    npt.assert_allclose(fit(film).curvature, 1 / radius, rtol=0.02)
    npt.assert_allclose(fit(film).radius, RADIUS, rtol=1e-6)


def test_error_bar_of_the_curvature_is_its_scatter():
    found = [fit(make_film(parabola(), noise=white_noise([4, n]))) for n in range(40)]
    pulls = [(gap.curvature - bend(3.0)) / gap.curvature_std for gap in found]
    assert 0.6 < np.std(pulls) < 1.25  # 40 values give it to 11 %
    assert abs(np.mean(pulls)) < 4 / np.sqrt(40)


def test_error_of_the_calibration_is_part_of_the_curvature():
    """A film read with parameters that are off by one standard deviation moves by its share."""
    noise = white_noise(5)
    alone = fit(make_film(parabola(), noise=noise))
    both = fit(make_film(parabola(), noise=noise, covariance=CORRELATED))
    shared = np.sqrt(both.curvature_std**2 - alone.curvature_std**2)

    # the same log ratios inverted with each parameter one standard deviation off
    truth = parabola()[0]
    design = np.column_stack([np.ones_like(X), X, X**2 / 2])
    changes = []
    for n, step in enumerate(np.sqrt(np.diag(CORRELATED))):
        k, p, q = np.array([K, P, Q]) + step * np.eye(3)[n]
        ratio = k * (p / q) * np.expm1(-q * GRID) / np.expm1(-p * GRID)
        moved = np.interp(true_ratio(truth), ratio, GRID)
        changes.append(np.linalg.lstsq(design, moved - truth, rcond=None)[0][2])
    npt.assert_allclose(shared, np.linalg.norm(changes), rtol=0.3)  # equal weights here


def test_circles_at_a_distance_have_a_flatter_gap_than_touching_ones():
    """Exact circles of 33.36 and 33.59 mm, the middles 210 um apart: 20 um at least."""
    gap = RigidGap(20.0, 0.0, 4.872010, 0.2, 0.01, clearance=230.0)
    x = np.array([0.0, 4.0, 8.0])  # mm along the bushing
    angle = x / np.sqrt(33.36 * 33.59)
    across, along = 0.21 * np.sin(angle), 0.21 * np.cos(angle)
    exact = 1e3 * (33.59 - along - np.sqrt(33.36**2 - across**2))
    npt.assert_allclose(gap.thickness(x), exact, atol=0.1)
    assert RigidGap(20.0, 0.0, 4.872010, 0.2, 0.01).thickness(8.0) - exact[-1] > 0.5


def test_a_film_thicker_than_the_clearance_still_has_a_parabola():
    gap = RigidGap(300.0, 0.0, 4.872010, 0.2, 0.01, clearance=230.0)
    assert 0 < gap.rigid_curvature < 0.11 * 0.2053
    below = RigidGap(-1.0, 0.0, 4.872010, 0.2, 0.01, clearance=230.0)  # of noise
    npt.assert_allclose(below.rigid_curvature, 0.20525, rtol=1e-4)


def test_fewer_than_six_blocks_have_no_gap():
    """Six blocks of eight pixels are 48 columns."""
    film = make_film(parabola())
    film.flags.values[:, :, 41:] = Flag.NO_FILM  # a pixel of the sixth block is left
    assert fit(film) is not None
    film.flags.values[:, :, 40:] = Flag.NO_FILM
    assert fit(film) is None
