"""The smooth gap through the ratio of a region: minimum, error bars and outliers."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import assert_covers, share_within
from scenes.gap import (
    RADIUS,
    TURNED,
    WHOLE,
    S,
    X,
    Y,
    Z,
    ball,
    exact_ratios,
    exchange_axes,
    known_calibration,
    known_gap,
    noisy_ratios,
    true_log_ratio,
)

from erlif.core.products import RatioImages
from erlif.rig import RigSettings
from erlif.rig.film import Gap, draw_marks
from erlif.trend import FilmCurve, Region, choose_contact, sum_blocks
from erlif.trend.gap import MISFIT, GapShape, find_gap_minima, find_gap_minimum

PLACE = np.array([0.1 * 0.5 + 0.5, -0.2 * 0.5 + 0.5]) * [X.size - 1, Y.size - 1]
"""Column and row at which `ball` is thinnest. [px]"""


def fit(ratios, *, calibration=None, region=WHOLE, **options):
    curve = FilmCurve.of(calibration or known_calibration())
    sums = sum_blocks(ratios, region)
    return find_gap_minimum(sums, curve, region=region, **{"sliding_along_x": True} | options)


@pytest.mark.parametrize("minimum", [1.0, 3.0, 8.0])
@pytest.mark.parametrize("centre", [4.0, 7.0, 9.5])
def test_minimum_of_a_parabola_with_a_tilt_is_found(minimum, centre):
    """Without noise the closed form comes back to the width of a block, 8 px."""
    found = fit(exact_ratios(known_gap(minimum, centre=centre)))
    npt.assert_allclose(found.minimum.value, minimum, atol=1e-3)


@pytest.mark.parametrize(("centre", "edge"), [(-5.0, 0), (20.0, -1)])
def test_minimum_outside_the_region_is_that_of_the_nearest_edge(centre, edge):
    """The log ratio is bent within 0.48 mm of a slope of 1.6 um/mm, by up to 10 nm."""
    film = known_gap(2.0, centre=centre)
    expected = 2.0 + (X[edge] - centre) ** 2 / (2 * RADIUS)
    npt.assert_allclose(fit(exact_ratios(film)).minimum.value, expected, atol=1e-3)

    # thickest in the middle
    film = 6.0 - (X - 5.0)[None, :] ** 2 / (2 * RADIUS) + 0 * Y[:, None]
    expected = 6.0 - (X[-1] - 5.0) ** 2 / (2 * RADIUS)
    npt.assert_allclose(fit(exact_ratios(film)).minimum.value, expected, atol=1e-3)


def test_many_blocks_are_merged_without_a_change_of_the_minimum():
    """65 by 65 blocks of 8 px: the last squares of both directions are smaller."""
    s = np.linspace(-1, 1, 520)
    film = 3.0 + (s - 0.2)[None, :] ** 2 + 0.3 * (s + 1)[:, None]
    whole = Region(slice(0, 520), slice(0, 520))
    found = fit(exact_ratios(film), region=whole)
    npt.assert_allclose(found.minimum.value, 3.0, atol=1e-3)


@pytest.mark.parametrize("tilt", [-0.2, 0.2])
@pytest.mark.parametrize("region", [WHOLE, Region(slice(16, 112), slice(40, 168))])
def test_place_of_the_minimum_is_that_of_the_true_gap(region, tilt):
    """Vertex of the parabola at 7 mm, 116.7 px; across, the edge towards which the gap falls."""
    film = known_gap(3.0, tilt=tilt)
    part = film[region.rows, region.columns]
    row, column = np.unravel_index(part.argmin(), part.shape)
    found = fit(exact_ratios(film), region=region).place
    npt.assert_allclose(found, [region.columns.start + column, region.rows.start + row], atol=0.6)


@pytest.mark.parametrize("minimum", [0.3, 2.0, 6.0])
def test_minimum_has_no_bias_through_noise_and_range_limits(minimum):
    """At 0.3 um half the pixels of the thin line fall below the range."""
    rng = np.random.default_rng(1)
    found = np.array(
        [fit(noisy_ratios(known_gap(minimum), 0.0135, rng)).minimum.value for _ in range(12)]
    )
    assert abs(found.mean() - minimum) < 4 * found.std(ddof=1) / np.sqrt(12) + 1e-3
    assert found.std(ddof=1) < 0.03


def test_random_error_bar_is_the_scatter_of_the_minimum():
    rng = np.random.default_rng(2)
    results = [fit(noisy_ratios(known_gap(3.0), 0.0135, rng)) for _ in range(60)]
    scatter = np.std([found.minimum.value for found in results], ddof=1)
    claimed = np.mean([found.minimum.random_std for found in results])
    npt.assert_allclose(claimed, scatter, rtol=0.3)  # 60 values give the scatter to 9 %


def pairwise_noise(rng):
    """Noise of std 0.01 that 2 x 2 pixels share: a mean has four times the variance."""
    coarse = 0.01 * rng.standard_normal((Y.size // 2, X.size // 2))
    return np.kron(coarse, np.ones((2, 2)))


def test_noise_that_neighbours_share_is_part_of_the_random_error():
    """Scatter of 20 minima, 16 % of it known; independent pixels would claim half of it."""
    found = []
    for seed in range(20):
        ratios = exact_ratios(known_gap(3.0))
        ratios.log_ratio.values[:] += pairwise_noise(np.random.default_rng([4, seed]))
        ratios.log_ratio_var.values[:] = 0.01**2
        found.append(fit(RatioImages(ratios.assign(noise_correlation=4.0))))
    scatter = np.std([one.minimum.value for one in found], ddof=1)
    npt.assert_allclose(np.mean([one.minimum.random_std for one in found]), scatter, rtol=0.48)


def test_waviness_of_the_surface_has_a_surface_error():
    """A wave of 0.1 um amplitude and 3 mm length along sliding, three periods in the region."""
    wave = 0.1 * np.sin(2 * np.pi * X / 3.0)[None, :]
    smooth, wavy = (
        fit(noisy_ratios(known_gap(3.0) + add, 0.005, np.random.default_rng(6)))
        for add in (0.0, wave)
    )
    assert wavy.minimum.surface_std > 5 * smooth.minimum.surface_std
    assert abs(wavy.minimum.value - 3.0) < 3 * wavy.minimum.surface_std
    npt.assert_allclose(wavy.minimum.random_std, smooth.minimum.random_std, rtol=0.5)


def test_scratches_do_not_move_the_minimum():
    """Lines of 3 px and 0.4 um over a tenth of the image raise the mean film by 40 nm."""
    film = known_gap(3.0)
    for column in range(3):
        film[:, column::30] += 0.4
    found = fit(noisy_ratios(film, 0.005, np.random.default_rng(8)))
    assert abs(found.minimum.value - 3.0) < 0.03


def test_image_with_x_and_y_exchanged_gives_the_same_minimum():
    ratios = noisy_ratios(known_gap(3.0), 0.01, np.random.default_rng(6))
    one = fit(ratios)
    found = fit(exchange_axes(ratios), region=TURNED, sliding_along_x=False)
    npt.assert_allclose(found.minimum.value, one.minimum.value, rtol=1e-6)
    npt.assert_allclose(found.place, one.place[::-1], rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "part", "value"),
    [
        ("flags", np.s_[8:], 128),
        ("flags", np.s_[:, 24:], 128),
        ("flags", np.s_[:], 128),
        ("log_ratio", np.s_[:], true_log_ratio(np.array(60.0))),
    ],
)
def test_minimum_is_missing_where_the_blocks_do_not_determine_a_gap(name, part, value):
    """One row of blocks leaves the tilt open, three columns the curvature."""
    ratios = noisy_ratios(known_gap(3.0), 0.01, np.random.default_rng(10))
    ratios[name].values[part] = value
    found = fit(ratios)
    assert np.isnan(
        [found.minimum.value, found.minimum.random_std, found.minimum.surface_std]
    ).all()
    assert np.isnan(found.minimum.gradient).all()
    assert np.isnan(found.place).all()
    assert found.minimum.gradient.shape == (3,)


@pytest.mark.parametrize("minimum", [1.1, 3.0])
def test_minimum_of_a_point_contact_is_found(minimum):
    found = fit(exact_ratios(ball(minimum)), contact=GapShape.POINT)
    npt.assert_allclose(found.minimum.value, minimum, atol=2e-3)
    npt.assert_allclose(found.place, PLACE, atol=0.6)
    npt.assert_allclose(found.bend, [3.0, 2.0], rtol=5e-3)

    # the image turned: the curvature along sliding stays the first
    turned = exchange_axes(exact_ratios(ball(minimum)))
    turned = fit(turned, region=TURNED, sliding_along_x=False, contact=GapShape.POINT)
    npt.assert_allclose(turned.minimum.value, found.minimum.value, rtol=1e-6)
    npt.assert_allclose(turned.bend, found.bend, rtol=1e-6)


def test_minimum_of_a_plane_lies_in_its_lowest_corner():
    found = fit(exact_ratios(3.0 + 0.2 * S - 0.3 * Z), contact=GapShape.PLANE)
    npt.assert_allclose(found.minimum.value, 2.5, atol=1e-3)
    npt.assert_allclose(found.place, [0, Y.size - 1])


@pytest.mark.parametrize(
    ("film", "contact"),
    [
        (ball(1.1), GapShape.LINE),
        (1.1 + 3 * ((S - 0.1) ** 2 + (Z + 0.2) ** 2) ** 2, GapShape.POINT),
    ],
)
def test_a_gap_that_does_not_describe_the_map_has_no_minimum(film, contact):
    found = fit(noisy_ratios(film, 0.0135, np.random.default_rng(12)), contact=contact)
    assert found.misfit > 10 * MISFIT
    assert np.isnan(
        [found.minimum.value, found.minimum.random_std, found.minimum.surface_std, *found.place]
    ).all()
    assert np.isnan(found.minimum.gradient).all()


def test_a_small_departure_leaves_the_minimum_with_its_error():
    """A line contact lacks a curvature across sliding of 0.1 um."""
    film = ball(1.1, bend=(3.0, 0.1))
    found = fit(noisy_ratios(film, 0.0135, np.random.default_rng(13)))
    assert found.misfit > MISFIT
    assert abs(found.minimum.value - 1.1) < 3 * found.minimum.surface_std < 0.1


def rig_of(contact):
    """Settings of a rig whose gap is of this kind; a ball sees a smaller field."""
    field = 4.8 if contact == "ball" else 19.2
    contact = "pin" if contact == "bent pin" else contact
    return RigSettings(contact=contact, field_width=field, ball_radius=200.0)


@pytest.mark.slow
@pytest.mark.parametrize("contact", ["ball", "plane", "pin", "bent pin"])
def test_error_bar_covers_the_gap_that_each_contact_has(contact):
    """Sixty runs of two triggers with surfaces of the virtual rig, their gap chosen by the run.

    Waves average out better over a plane, and in the mean, than the error bar takes them to.
    """
    rig, inside = rig_of(contact), np.indices((Y.size, X.size), dtype=float)
    y, x = inside + np.array([48, 60])[:, None, None]
    z = np.linspace(-1, 1, Y.size)[:, None]
    bend, contacts = 0.0, tuple(GapShape)
    if contact == "bent pin":
        bend, contacts = 0.5 * z**2 - 0.4 * z**3, (GapShape.LINE, GapShape.JOURNAL)
    curve, pulls, kinds = FilmCurve.of(known_calibration()), [], []
    for seed in range(60):
        rng = np.random.default_rng([14, seed])
        marks, minima, truth = draw_marks(rig, rng), [], []
        for film in (1.1, 2.1):
            gap = Gap(rig, film, marks)
            true = gap(x, y) + bend
            sums = sum_blocks(noisy_ratios(true, 0.0135, rng), WHOLE)
            truth.append(((gap.smooth(x, y) + bend).min(), true.mean()))
            options = {"region": WHOLE, "sliding_along_x": True, "contacts": contacts}
            minima.append(find_gap_minima(sums, curve, **options))
        chosen = choose_contact(minima)
        kinds.append(chosen)
        found = minima[seed % 2][chosen]
        pulls.append(
            [
                (one.value - true) / np.hypot(one.random_std, one.surface_std)
                for one, true in zip((found.minimum, found.mean), truth[seed % 2], strict=True)
            ]
        )
    expected = {"ball": GapShape.POINT, "plane": GapShape.PLANE, "pin": GapShape.LINE}
    assert kinds.count(expected.get(contact, GapShape.JOURNAL)) > 0.9 * len(kinds)
    lowest, mean = np.transpose(pulls)
    if contact != "plane":
        assert_covers(lowest)
    for each in (mean, lowest):
        for width, share in ((1, 0.683), (2, 0.954)):
            spread = np.sqrt(share * (1 - share) / len(each))
            assert share_within(each, width) > share - 3 * spread
    assert np.std(lowest) > 0.6
    assert np.sqrt(np.mean(mean**2)) > 0.35


@pytest.mark.parametrize(
    ("film", "contact"),
    [
        (np.maximum(-1.0 + 6 * S**2 + 5 * Z**2, 0.3), GapShape.POINT),
        (np.maximum(-0.6 + 6 * S**2 + 0 * Z, 0.3), GapShape.LINE),
    ],
)
def test_a_contact_that_is_flattened_has_no_negative_minimum(film, contact):
    """The smooth gap outside the flat passes below zero, with errors of some nm."""
    found = fit(noisy_ratios(film, 0.0135, np.random.default_rng(5)), contact=contact)
    assert np.isnan(found.minimum.value)
    assert found.misfit > MISFIT
