"""The film of every frame: geometry of two circles, and the swing of the thin line."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.rig.film import crank_at, draw_marks, list_triggers, rocker_angle
from erlif.rig.journal import JournalGap, follow_pin, list_gaps, load_at
from erlif.rig.logger import frame_times
from erlif.rig.settings import RigSettings

RIG = RigSettings(film="reynolds", tilt=0.0, spacing=8.0, cycles=2, load_swing=0.0)


@pytest.fixture(scope="module")
def gaps():
    """Films of two cycles of six triggers, 24 cycles after loading."""
    return list_gaps(list_triggers(RIG), RIG, draw_marks(RIG, np.random.default_rng(0)))


def test_the_gap_is_that_of_two_circles():
    """Ray from the middle of the bushing to the pin, whose middle is 200 um away at 5 degrees."""
    rig = replace(RIG, thin_line=0.0)
    off = np.radians(5)
    marks = draw_marks(rig, np.random.default_rng(0))
    gap = JournalGap(rig, 0.0, marks, 200 * np.cos(off), 200 * np.sin(off))
    phi = np.radians(np.linspace(-10, 10, 9))
    x = rig.centre[0] + phi * np.sqrt(33.36 * 33.59) / rig.pitch
    across, along = 0.2 * np.sin(phi - off), 0.2 * np.cos(phi - off)  # mm
    pin = along + np.sqrt(33.36**2 - across**2)
    npt.assert_allclose(gap.smooth(x, np.zeros(9)), 1e3 * (33.59 - pin), atol=0.05)
    assert gap.eccentricity == pytest.approx(200 / 230)
    assert np.degrees(gap.attitude) == pytest.approx(5)


def test_every_frame_of_the_film_of_theory_has_its_own(gaps):
    films = np.array([gap.film_min for gap in gaps])
    assert films.size == 12
    assert np.all(np.diff(films) < 0)  # free to move sideways it only sinks
    assert films[0] == pytest.approx(6.3, abs=0.15)  # 6.4 um after 24 cycles
    law = replace(RIG, film="law")
    assert len(list_gaps(list_triggers(law), law, gaps[0].marks)) == 6


def test_the_thin_line_swings_by_half_the_bushing_angle(gaps):
    """7.11 mm from end to end at the surface of the pin, 3.6 mm to either side."""
    time = frame_times(list_triggers(RIG), RIG)
    bushing = rocker_angle(crank_at(time, RIG), RIG)
    attitude = np.array([gap.attitude for gap in gaps])
    npt.assert_allclose(np.diff(attitude), np.diff(bushing) / 2, atol=2e-3)

    full = np.linspace(0, 60 / 114, 101)
    along, side = follow_pin(full, RIG).T
    line = RIG.journal_radius * np.arctan2(side, along)
    npt.assert_allclose([line.min(), line.max()], [-3.6, 3.6], atol=0.2)


def test_the_minimum_is_that_of_the_region(gaps):
    (left, right), (top, _) = RIG.region
    x = np.linspace(left, right, 2001)[None] / RIG.pitch
    for gap in gaps:
        smooth = gap.smooth(x, np.full_like(x, top / RIG.pitch))
        npt.assert_allclose(smooth.min(), gap.film_min, atol=1e-5)
    outside = replace(RIG, thin_line=8.0)  # beyond the region for some of the swing
    swung = list_gaps(list_triggers(outside), outside, gaps[0].marks)
    npt.assert_allclose(
        [gap.smooth(x, 0 * x).min() for gap in swung], [gap.film_min for gap in swung], atol=1e-5
    )


def test_a_guided_pin_keeps_its_line_from_the_moment_of_loading_on():
    guided, held, free = (
        1e6 * follow_pin(np.array([0.0, 0.05]), replace(RIG, sideways=sideways, elapsed=0.2))
        for sideways in ("guided", 1e12, "free")
    )
    npt.assert_array_equal(guided[:, 1], 0)
    npt.assert_allclose(held, guided, rtol=1e-3, atol=1e-3)
    npt.assert_allclose(guided[:, 0], free[:, 0], rtol=0.02)  # it sinks like the free one at first
    for sideways in ("free", "guided"):
        rig = replace(RIG, elapsed=0.0, sideways=sideways)
        npt.assert_allclose(follow_pin(np.array([0.0, 0.01]), rig)[0], 0, atol=1e-12)


def test_a_vented_film_has_cavities():
    """Sideways motion pulls at a full film; without that pull the pin sinks a little faster."""
    rig = replace(RIG, elapsed=0.2, cavitation_pressure=0.0)
    full = replace(rig, cavitation_pressure=-100.0)
    vented, filled = (1e6 * follow_pin(np.array([0.0]), one)[0] for one in (rig, full))
    assert 1.005 < vented[0] / filled[0] < 1.05


def test_a_lined_bushing_deflects_by_hookes_law_where_the_film_carries_the_load():
    """A block of the layer that cannot spread, by the compliances of an isotropic solid."""
    rig = replace(RIG, length=30.0, liner=(2.0, 0.5, 0.4), load=120.0, elapsed=0.3, cycles=1)
    modulus, poisson = 5e8, 0.4
    compliance = (np.eye(3) * (1 + poisson) - poisson) / modulus
    side = -np.linalg.solve(compliance[:2, :2], compliance[:2, 2])  # stresses for one of 1 Pa
    strain = compliance[2] @ [*side, 1.0]
    deflections = []
    follow_pin(np.array([0.0, 0.1]), rig, deflections)
    phi, axial = np.meshgrid(np.linspace(-np.pi, np.pi, 801), np.linspace(-0.015, 0.015, 401))
    pressure = deflections[1].at(phi, axial) / (2e-3 * strain)
    cell = 2 * np.pi * rig.journal_radius * 1e-3 / 800 * 30e-3 / 400
    force = (pressure * np.cos(phi)).sum() * cell
    npt.assert_allclose(force, float(load_at(np.array(0.1), rig)), rtol=0.02)

    # the film of the picture is that between the circles, and the deflection
    gap = list_gaps(list_triggers(rig), rig, draw_marks(rig, np.random.default_rng(0)))[0]
    rigid = replace(gap, deflection=None)
    x, y = np.array([rig.centre[0]]), np.array([rig.centre[1] + 20.0])
    off = np.array([-rig.thin_line / rig.journal_radius]), np.array([20e-3 * rig.pitch])
    deflected = gap.smooth(x, y) - rigid.smooth(x, y)
    npt.assert_allclose(deflected, 1e6 * gap.deflection.at(*off), rtol=1e-9)
    assert deflected > 0.1
    (left, right), (top, bottom) = rig.region
    y, x = np.mgrid[top:bottom:600j, left:right:800j] / rig.pitch
    assert gap.film_min == pytest.approx(gap.smooth(x, y).min(), abs=2e-3)
    assert gap.film_min > rigid.smooth(x, y).min() + 0.1


def test_the_load_follows_the_crank():
    rig = replace(RIG, load_swing=0.2)
    triggers = list_triggers(rig)
    npt.assert_allclose(load_at(triggers.time, rig), triggers.load, rtol=1e-9)
