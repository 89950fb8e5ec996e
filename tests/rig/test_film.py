"""The true film: published numbers of the linkage, rigid circles, marks and bubbles."""

import tomllib

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.io.settings.tables import RotationSettings, SinusoidalSettings, SliderCrankSettings
from erlif.rig import RigSettings
from erlif.rig.directory import run_toml
from erlif.rig.film import (
    Bubbles,
    Gap,
    Marks,
    Wedge,
    crank_angle,
    cycle_time,
    draw_bubbles,
    draw_marks,
    list_pictures,
    list_triggers,
    rocker_angle,
    rocker_range,
    rocker_speed,
)

# linkage: the four-bar of the thesis, recomputed with two independent packages


def test_rocker_swings_between_its_dead_points_with_its_greatest_speeds():
    rig = RigSettings()
    ends = np.array(rocker_range(rig))
    npt.assert_allclose(np.degrees(ends), [47.4095, 71.8355], atol=5e-5)
    crank = crank_angle(ends, np.array([True, True]), rig)
    npt.assert_allclose(np.degrees(crank), [209.83, 29.95], atol=0.02)
    speed = rocker_speed(np.linspace(0, 2 * np.pi, 72001), rig)
    npt.assert_allclose([speed.max(), speed.min()], [2.552104, -2.540492], rtol=1e-6)


def test_four_bar_closes_and_speed_is_its_derivative():
    rig = RigSettings()
    crank = np.linspace(0, 2 * np.pi, 37)
    angle = rocker_angle(crank, rig)
    rocker_end = np.stack([rig.ground - rig.rocker * np.cos(angle), rig.rocker * np.sin(angle)])
    crank_end = rig.crank * np.stack([np.cos(crank), np.sin(crank)])
    npt.assert_allclose(np.hypot(*(rocker_end - crank_end)), rig.coupler, rtol=1e-13)
    slope = (rocker_angle(crank + 1e-5, rig) - rocker_angle(crank - 1e-5, rig)) / 2e-5
    npt.assert_allclose(rocker_speed(crank, rig), slope * 114 * 2 * np.pi / 60, atol=1e-8)


def test_triggers_fill_one_cycle_every_096_degrees():
    triggers = list_triggers(RigSettings())
    assert triggers.reading.size == 50  # the thesis: 50 pictures per cycle
    steps = np.repeat([0.96, 0, -0.96], [24, 1, 24])
    npt.assert_allclose(np.diff(triggers.reading), steps, atol=1e-12)
    angle = np.degrees(rocker_angle(np.radians(triggers.crank_angle), RigSettings()))
    npt.assert_allclose(angle, triggers.zero + triggers.reading, rtol=1e-12)
    npt.assert_array_equal(np.sign(triggers.speed), np.repeat([1, -1], 25))
    assert np.all(np.diff(triggers.time) > 0)
    assert 0 < triggers.time[0] < triggers.time[-1] < 60 / 114
    crank_turned = np.diff(np.unwrap(np.radians(triggers.crank_angle)))
    npt.assert_allclose(crank_turned, np.diff(triggers.time) * 114 * 2 * np.pi / 60, rtol=1e-9)


def test_film_law_is_a_power_of_speed_over_load():
    triggers = list_triggers(RigSettings(exponent=0.7, load_swing=0.2))
    slope, intercept = np.polyfit(
        np.log(np.abs(triggers.speed) / triggers.load), np.log(triggers.film_min), 1
    )
    npt.assert_allclose(slope, 0.7, rtol=1e-9)
    npt.assert_allclose(np.exp(intercept) * (2.552104 / 222.411) ** 0.7, 6.0, rtol=1e-5)


def test_squeeze_limits_the_film_from_below_and_a_table_replaces_the_law():
    assert list_triggers(RigSettings(film_reference=0.6)).film_min.min() == 0.3
    table = tuple(np.linspace(2, 3, 50))
    npt.assert_array_equal(list_triggers(RigSettings(film_table=table)).film_min, table)
    with pytest.raises(ModelError, match="50 triggers, got 3"):
        list_triggers(RigSettings(film_table=(1.0, 2.0, 3.0)))


# gap


@pytest.mark.parametrize("film", [1.0, 4.0, 11.0])
def test_gap_is_that_of_circles_in_each_other(film):
    """The distance of a displaced circle from the bore, along radii of the bore.

    At 11 um the parabola of touching circles is 5 % steeper, 0.5 um at 10 mm.
    """
    rig = RigSettings(tilt=0)
    gap = Gap(rig, film, draw_marks(rig, np.random.default_rng(0)))
    arc = np.linspace(-10, 10, 2001)  # mm
    found = gap.smooth(rig.centre[0] + (arc + rig.thin_line) / rig.pitch, np.zeros_like(arc))

    bore, pin = 33.59, 33.36
    off, angle = bore - pin - 1e-3 * film, arc / bore
    distance = bore - off * np.cos(angle) - np.sqrt(pin**2 - (off * np.sin(angle)) ** 2)
    npt.assert_allclose(found, 1e3 * distance, atol=5e-3)  # um, c/R of what e adds


def test_film_min_is_the_minimum_of_the_smooth_gap_in_the_region():
    rig = RigSettings(tilt=-0.5)
    gap = Gap(rig, 4.0, draw_marks(rig, np.random.default_rng(0)))
    (left, right), (top, bottom) = rig.region
    y, x = np.meshgrid(np.linspace(top, bottom, 101), np.linspace(left, right, 2001), indexing="ij")
    npt.assert_allclose(gap.smooth(x / rig.pitch, y / rig.pitch).min(), 4.0, atol=1e-5)


def test_ball_touches_at_a_point_and_planes_everywhere():
    """The gap of a sphere, R - sqrt(R^2 - r^2), to its parabola; a plane rises by its tilt."""
    rig = RigSettings(contact="ball", field_width=2.0, ball_radius=50.0, thin_line=0.3)
    marks = draw_marks(rig, np.random.default_rng(0))
    x, y = rig.centre[0] + 0.3 / rig.pitch, rig.centre[1]
    away = 0.8 / rig.pitch  # pixel
    sphere = 1.1 + 1e3 * (50 - np.sqrt(50**2 - 0.8**2))
    found = Gap(rig, 1.1, marks).smooth(np.array([x, x + away, x]), np.array([y, y, y - away]))
    npt.assert_allclose(found, [1.1, sphere, sphere], atol=1e-3)

    rig = RigSettings(contact="plane", tilt=0.5)
    found = Gap(rig, 2.0, marks).smooth(np.array([0.0, 9.0]), np.array([0.0, rig.height]))
    npt.assert_allclose(np.diff(found), 0.5)


def test_flattened_ball_has_a_plateau_a_constriction_and_the_gap_of_hertz_beside_it():
    """Gap beside it: integral over the pressure of Hertz, by the potential of a disc of rings."""
    radius, ball, over = 0.3, 20.0, 1.5
    rig = RigSettings(
        contact="ball", field_width=2.0, ball_radius=ball, thin_line=0.0, plateau=(radius, over)
    )
    gap = Gap(rig, 2.0, draw_marks(rig, np.random.default_rng(0)))
    y, x = np.meshgrid(np.arange(0, 256, 0.25), np.arange(0, 320, 0.25), indexing="ij")
    film = gap.smooth(x, y)
    npt.assert_allclose(film.min(), 2.0, atol=1e-3)
    lowest = 0.85 - 0.3 * 3.0 / (1e3 * radius**2 / ball)
    at = rig.centre[0] + np.array([0.0, lowest, -lowest]) * radius / rig.pitch
    found = gap.smooth(at, np.full(3, rig.centre[1]))
    npt.assert_allclose(found, [3.0, 3.0 - 0.7, 3.0], atol=1e-6)

    # p = 2 a E*/(pi R) sqrt(1 - t^2): deflection (1/(pi E*)) times the integral of p/distance
    t, weight = np.polynomial.legendre.leggauss(200)
    t, weight = (t + 1) / 2, weight / 2

    def deflection(r):
        turn = np.linspace(0, 2 * np.pi, 400, endpoint=False)[:, None]
        ring = np.sin(np.pi / 2 * t)  # dense at the edge, where the pressure has its root
        area = ring * np.pi / 2 * np.cos(np.pi / 2 * t) * weight
        apart = np.sqrt(r**2 + ring**2 - 2 * r * ring * np.cos(turn))
        return 4 / (np.pi * ball) * radius**2 * (np.sqrt(1 - ring**2) * area / apart).mean(0).sum()

    away = np.array([1.3, 2.0, 3.0])
    # at the edge the film is that of the plateau: the approach is a^2/R
    sunk = np.array([deflection(r) for r in away]) * 1e3
    hertz = 1e3 * (radius * away) ** 2 / (2 * ball) - 1e3 * radius**2 / ball + sunk
    found = gap.smooth(rig.centre[0] - away * radius / rig.pitch, np.full(3, rig.centre[1]))
    npt.assert_allclose(found - 3.0, hertz, rtol=1e-3)


def test_marks_have_their_depth_and_run_along_sliding():
    rig = RigSettings(width=1000, height=1000, marks=0.1)
    y, x = np.indices((1000, 1000), dtype=float)
    waves_only = draw_marks(rig, np.random.default_rng(3))
    height = waves_only(x, y)
    assert 0.08 < height.std() < 0.13  # waves of 0.1 um rms, and scratches on top
    assert np.abs(np.diff(height, axis=1)).mean() < 0.3 * np.abs(np.diff(height, axis=0)).mean()


def test_film_never_closes():
    rig = RigSettings(marks=1.0)
    y, x = np.indices((256, 320), dtype=float)
    assert Gap(rig, 0.1, draw_marks(rig, np.random.default_rng(0)))(x, y).min() == 0.05


def test_bubble_empties_the_film_inside_only_and_its_meniscus_is_half_full():
    bubble = Bubbles(np.array([20.0]), np.array([10.0]), np.array([5.0]), meniscus=2.0)
    x, y = np.arange(40.0)[None], np.full((1, 40), 10.0)
    film = bubble.empty(np.full((1, 40), 6.0), x, y)[0]
    assert np.all(film[16:25] < 0.1)
    npt.assert_array_equal(film[[10, 12, 28, 35]], 6.0)
    lack = bubble.lack(np.array([20.0, 25.0, 26.0, 27.0]), np.full(4, 10.0))
    npt.assert_allclose(lack, [1, 1, 0.5, 0])
    assert Bubbles(*np.empty((3, 0))).lack(np.zeros(3), np.zeros(3)).sum() == 0


@pytest.mark.parametrize("rising", [True, False])
def test_crank_angle_is_the_inverse_of_the_rocker_angle(rising):
    rig = RigSettings()
    low, high = rocker_range(rig)
    angle = np.linspace(low + 0.01, high - 0.01, 30)
    crank = crank_angle(angle, np.full(30, rising), rig)
    npt.assert_allclose(rocker_angle(crank, rig), angle, rtol=1e-12)
    assert np.all(np.sign(rocker_speed(crank, rig)) == (1 if rising else -1))


def test_one_mark_is_a_plane_wave_of_its_wavelength():
    waves = np.array([[0.0, 2 * np.pi / 10, 0.0, 0.3]])
    height = Marks(waves, np.empty((0, 6)))(np.zeros((1, 41)), np.arange(41.0)[None])[0]
    npt.assert_allclose(height, 0.3 * np.sin(2 * np.pi * np.arange(41) / 10), atol=1e-12)


def test_one_scratch_has_its_depth_along_it_and_fades_beyond():
    """Depth 0.4 um from x = 10 to 30, a standard deviation of 1.3 pixels across."""
    marks = Marks(np.empty((0, 4)), np.array([[20.0, 5.0, 1.0, 0.0, 10.0, 0.4]]))
    x, y = np.array([[12.0, 28.0, 20.0, 45.0]]), np.array([[5.0, 5.0, 6.3, 5.0]])
    height = marks(x, y)[0]
    npt.assert_allclose(height[:2], 0.4, rtol=1e-12)
    npt.assert_allclose(height[2], 0.4 * np.exp(-0.5), rtol=1e-12)
    assert height[3] < 1e-4


def test_wedge_rises_from_edge_to_edge_about_a_plane():
    rig = RigSettings(wedge=(1.0, 9.0), wedge_form=0.2)
    x = np.arange(float(rig.width))
    film = Wedge(rig).profile(x)
    npt.assert_allclose(film[[0, -1]], [1, 9], atol=1e-12)
    departure = film - np.linspace(1, 9, rig.width)
    npt.assert_allclose(np.abs(departure).max(), 0.2, rtol=1e-3)
    beyond = Wedge(RigSettings(wedge=(0.0, 9.0), wedge_form=0.0))
    assert beyond.profile(np.array([-10.0]))[0] < 0
    assert beyond(np.array([-10.0]), np.zeros(1))[0] == 0.02


def test_number_of_bubbles_is_uniform_and_falls_with_the_picture():
    rng = np.random.default_rng(4)
    drawn = [draw_bubbles(RigSettings(bubbles=4), rng) for _ in range(500)]
    counts = np.bincount([bubbles.x.size for bubbles in drawn], minlength=5)
    npt.assert_allclose(counts, 100, atol=4 * 9)  # binomial, 500 draws of a fifth
    radius = np.concatenate([bubbles.radius for bubbles in drawn])
    assert 3 <= radius.min() < 3.1
    assert 9 < radius.max() <= 10
    npt.assert_allclose(radius.mean(), 3 + 7 / 4, atol=0.25)  # mean of u^3 is 1/4
    quarter = RigSettings(width=160, height=128, bubbles=4)
    assert max(draw_bubbles(quarter, rng).x.size for _ in range(50)) == 1


def test_a_disc_turns_evenly():
    """60 rpm at 20 mm is 0.1257 m/s; 8 pictures in a second are 45 degrees apart."""
    rig = RigSettings(mechanism="rotation", pictures=8, load_swing=0.0)
    found = list_pictures(rig)
    npt.assert_allclose(found.speed, 0.125664, rtol=1e-5)
    npt.assert_allclose(np.diff(found.reading), 45.0)
    npt.assert_allclose(np.diff(found.time), 0.125)
    npt.assert_allclose(found.film_min, 6.0)


def test_a_slider_follows_a_cosine():
    """10 mm at 5 Hz: at most 0.1571 m/s; the speed is the derivative of 5 mm sin."""
    rig = RigSettings(mechanism="sinusoidal", pictures=400)
    found = list_pictures(rig)
    position = 5e-3 * np.sin(2 * np.pi * 5 * found.time)
    npt.assert_allclose(found.speed, np.gradient(position, found.time), atol=1e-4)
    assert np.abs(found.speed).max() == pytest.approx(0.15708, rel=1e-4)
    assert cycle_time(rig) == 0.2


def test_a_slider_crank_closes_and_its_pin_turns_against_the_rod():
    """The slider is at x = r cos t + sqrt(l^2 - r^2 sin^2 t); the rod ends there."""
    rig = RigSettings(mechanism="slider-crank", crank=16.0, pictures=4000)
    found = list_pictures(rig)
    crank = np.radians(found.crank_angle)
    npt.assert_allclose(np.gradient(crank, found.time), 114 * 2 * np.pi / 60)
    slider = 16 * np.cos(crank) + np.sqrt(44**2 - (16 * np.sin(crank)) ** 2)
    rod = np.angle(slider - 16 * np.exp(1j * crank))
    npt.assert_allclose(np.radians(found.zero + found.reading), rod, atol=1e-12)
    assert 0 <= found.reading.min() < 1e-4
    npt.assert_allclose(found.speed, np.gradient(crank - rod, found.time), atol=1e-4)


def test_a_thicker_film_follows_a_lower_load_on_a_disc():
    """At constant speed the film is the load to the power of -0.62."""
    found = list_pictures(RigSettings(mechanism="rotation", load_swing=0.5))
    slope = np.polyfit(np.log(found.load), np.log(found.film_min), 1)[0]
    assert slope == pytest.approx(-0.62)


def test_a_static_film_is_the_same_in_all_pictures():
    found = list_pictures(RigSettings(mechanism="static", pictures=5))
    npt.assert_allclose(found.film_min, 6.0)
    assert not found.speed.any()


def test_settings_of_the_motion_are_those_of_the_rig():
    names = ("slider-crank", "rotation", "sinusoidal", "static")
    rigs = [RigSettings(mechanism=name) for name in names]
    pin, disc, slider, static = (tomllib.loads(run_toml(rig, list_pictures(rig))) for rig in rigs)
    links = SliderCrankSettings.model_validate(pin["mechanism"])
    assert (links.crank, links.coupler) == pytest.approx((0.055, 0.44))
    motion = RotationSettings.model_validate(disc["mechanism"])
    assert (motion.radius, motion.speed) == (0.02, pytest.approx(2 * np.pi))
    motion = SinusoidalSettings.model_validate(slider["mechanism"])
    assert (motion.stroke, motion.frequency) == (0.01, 5.0)
    assert "mechanism" not in static
