"""Central and minimum film of contacts with a plateau: solved ones, and drawn ones with marks."""

import functools

import numpy as np
import pytest
from oracles.point_contact import solve_point
from scenes.fixture import K
from scenes.gap import exact_ratios, exchange_axes, known_calibration, noisy_ratios
from scipy.interpolate import RegularGridInterpolator

from conftest import FULL
from erlif.rig import RigSettings
from erlif.rig.film import Gap, draw_marks
from erlif.trend import FilmCurve, GapShape, Region, find_gap_minima, has_plateau, sum_blocks

SHAPE = (200, 200)


def find(ratios, *, along_x=True):
    rows, columns = ratios.log_ratio.shape
    whole, curve = Region(slice(0, rows), slice(0, columns)), FilmCurve.of(known_calibration())
    options = {"region": whole, "sliding_along_x": along_x, "contacts": tuple(GapShape)}
    return find_gap_minima(sum_blocks(ratios, whole), curve, **options)


def own_std(number):
    return np.hypot(number.random_std, number.surface_std)


def photograph(film, *, rig, marks=0.0, rng=None):
    """Film of the rig on its picture; its centre is `thin_line` off the middle. [um]"""
    y, x = np.indices((rig.height, rig.width), dtype=float)
    rng = np.random.default_rng(3) if rng is None else rng
    return Gap(rig, film, draw_marks(rig, rng))(x, y)


def flattened(radius, over, *, size=SHAPE[0], ball=30.0, **changes):
    """Rig whose plateau has a radius of so many pixels, 1.5 mm."""
    common = {"width": size, "height": size, "field_width": 1.5 * size / radius, "marks": 0.0}
    common |= {"contact": "ball", "ball_radius": ball, "thin_line": 0.1, "plateau": (1.5, over)}
    return RigSettings(**(common | changes))


@functools.cache
def solved(U, W, G):
    """Isoviscous-elastic film over Rx, by Newton on Reynolds' equation and the half-space."""
    return solve_point(U, W, G, cells=(48, 20))


def solved_film(solution, central, pixels):
    """Map [um] of a solution that is scaled to a central film; `pixels` in the radius of Hertz."""
    radius = (1.5 * 5e-5) ** (1 / 3)
    across = np.concatenate([-solution.across[:1], solution.across])
    film = np.hstack([solution.film[:, :1], solution.film]) * central / solution.central
    at = RegularGridInterpolator((solution.along, across), film, method="cubic")
    y, x = (np.indices(SHAPE) - 99.5) * radius / pixels
    return at((x, np.abs(y)))


@pytest.mark.parametrize("along_x", [True, False])
def test_soft_contact_that_is_solved_has_its_central_and_minimum_film(along_x):
    """The solution is converged to 3 % in the minimum and 1 % at the centre (docs/theory)."""
    solution = solved(5e-9, 5e-5, 1e-3)
    film = solved_film(solution, 4.0, 60)
    ratios = noisy_ratios(film, 0.02, np.random.default_rng(2))
    found = find(ratios if along_x else exchange_axes(ratios), along_x=along_x)
    assert has_plateau(found)
    gap = found[GapShape.PLATEAU]
    true = 4.0 * solution.minimum / solution.central
    assert abs(gap.minimum.value - true) < 2 * np.hypot(own_std(gap.minimum), 0.03 * true)
    assert abs(gap.central.value - 4.0) < 2 * np.hypot(own_std(gap.central), 0.04)
    assert own_std(gap.minimum) < 0.1 * true
    assert own_std(gap.central) < 0.04 * 4.0

    # the oil moves to larger x: the constriction is there, symmetric about the axis
    place = gap.place if along_x else gap.place[::-1]
    low = np.argwhere(film == film.min())[:, ::-1]
    folded = np.array([place[0], 99.5 + abs(place[1] - 99.5)])
    assert np.abs(low - folded).max(axis=1).min() < 12


def test_errors_of_drawn_contacts_cover_their_films():
    """Contacts of 45 to 75 pixels, with marks: 68 and 95 % to three standard deviations."""
    rng, pulls, count = np.random.default_rng(4), [], 48 if FULL else 24
    for _ in range(count):
        film, over = rng.uniform(0.8, 3.0), rng.uniform(1.1, 2.2)
        rig = flattened(
            rng.uniform(45, 75),
            over,
            ball=rng.uniform(15, 60),
            thin_line=rng.uniform(-0.2, 0.2),
            marks=rng.uniform(0, 0.04),
        )
        ratios = noisy_ratios(photograph(film, rig=rig, rng=rng), 0.02, rng)
        gap = find(ratios)[GapShape.PLATEAU]
        both = (gap.minimum, film), (gap.central, over * film)
        pulls.append([(one.value - true) / own_std(one) for one, true in both])
    for pull in np.abs(pulls).T:
        pull = pull[np.isfinite(pull)]
        assert pull.size > count * 5 / 6
        for share, low in ((0.68, 1), (0.95, 2)):
            assert abs((pull < low).mean() - share) < 3 * np.sqrt(share * (1 - share) / pull.size)


def test_noise_does_not_lower_the_minimum():
    """Of four noises that double, the mean over 12 pictures stays that of the film without noise.

    The lowest of the blocks' films would be 0.1 to 0.5 um lower.
    """
    rig = flattened(60, 1.6)
    film, rng = photograph(2.0, rig=rig), np.random.default_rng(5)
    quiet = find(exact_ratios(film))[GapShape.PLATEAU].minimum.value
    for noise in (0.02, 0.04, 0.08):
        found = [find(noisy_ratios(film, noise, rng))[GapShape.PLATEAU] for _ in range(12)]
        values = np.array([one.minimum.value for one in found])
        scatter = values.std(ddof=1)
        assert abs(values.mean() - quiet) < 3 * scatter / np.sqrt(12) + 0.02
        assert 0.5 < np.median([one.minimum.random_std for one in found]) / scatter < 1.7


def test_contact_that_the_picture_cuts_has_a_central_film_and_no_minimum():
    rig = flattened(60, 1.5)
    film = photograph(2.0, rig=rig)[:, 50:]
    gap = find(noisy_ratios(film, 0.02, np.random.default_rng(6)))[GapShape.PLATEAU]
    assert np.isnan(gap.minimum.value)
    assert np.isnan(gap.place).all()
    assert abs(gap.central.value - 3.0) < 3 * own_std(gap.central) < 0.2


def test_central_film_of_an_undeformed_ball_is_its_minimum():
    rig = flattened(60, 1.0, plateau=(0.0, 1.0), ball=150.0)
    found = find(noisy_ratios(photograph(2.0, rig=rig), 0.02, np.random.default_rng(7)))
    assert not has_plateau(found)
    gap = found[GapShape.PLATEAU]
    assert gap.central == gap.minimum
    assert abs(gap.central.value - 2.0) < 3 * own_std(gap.central)


@pytest.mark.parametrize("wave", ["dent", "steps", "plane"])
def test_other_surfaces_have_no_plateau(wave):
    y, x = np.indices(SHAPE) / 100 - 1
    film = {
        "dent": 3 + 4 * np.exp(-8 * (x**2 + y**2)),
        "steps": 3 + 2.0 * (x > 0.2),
        "plane": 3 + 0.5 * x + 0.2 * y,
    }[wave]
    assert not has_plateau(find(noisy_ratios(film, 0.02, np.random.default_rng(8))))


def test_films_of_a_calibration_that_is_off_move_with_its_gradient():
    """Of 1 % of the ratio, the measured change is that of the gradient."""
    film = photograph(2.0, rig=flattened(60, 1.5))
    ratios = exact_ratios(film)
    before = find(ratios)[GapShape.PLATEAU]
    ratios.log_ratio.values[:] -= 0.01
    after = find(ratios)[GapShape.PLATEAU]
    for name in ("central", "minimum"):
        one, other = getattr(before, name), getattr(after, name)
        change = 0.01 * one.gradient[0] * K
        np.testing.assert_allclose(other.value - one.value, change, rtol=0.1)
