"""Cavities: closed form of oscillating plates, and the guided acrylic joint."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.rig import ACRYLIC, CYCLE, LOAD

from erlif.core.errors import ModelError
from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal, Motion, crank_motion, solve_journal
from erlif.rig.cavitation import Deflection, follow_cavitated, relax_pressure
from erlif.rig.film import bore_height, crank_at, rocker_angle, rocker_range, rocker_speed
from erlif.rig.orbit import RigidBearing, follow_orbit
from erlif.rig.settings import RigSettings

RIG = RigSettings()
THIN = ((230 - 18.5) * 1e-6, 0.0)  # near the periodic film of the guided pin
LINKS = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
SPEED = 2 * np.pi / CYCLE


def bushing(time):
    """Angle of the bushing from the middle of its stroke. [rad]"""
    middle = np.mean(rocker_range(RIG))
    return float(rocker_angle(crank_at(np.asarray(time), RIG), RIG) - middle)


def follow(time, **changes):
    """The pin of the acrylic joint under its dead load."""
    usual = {"load": lambda _: LOAD, "angle": bushing, "step": CYCLE / 50, "start": THIN}
    return follow_cavitated(ACRYLIC, time, **(usual | changes))


def test_a_cavity_between_oscillating_plates_grows_and_closes_as_its_fronts_do():
    """Half width 10 mm, 0.1 Pa s, 20 + 15 (1 - cos 2 pi t/T) um in 50 ms, cavities at -100 kPa.

    The front obeys b = a - sqrt(dp h^3/(6 eta h')) while the cavity grows; fronts integrated to
    1e-6 give at most 0.866324 of the half width and an end at 0.87412 of the period.
    """
    nodes, steps, width, period = 120, 600, 10e-3, 0.05
    pitch = width / nodes
    area = np.full((1, nodes + 1), pitch)
    area[0, [0, -1]] /= 2  # the middle of the plates and their edge
    held = np.zeros_like(area)
    held[0, -1] = 1
    pressure, around, along = (np.zeros_like(area) for _ in range(3))

    content, cavity = np.full_like(area, 20e-6), []
    for k in range(1, steps + 1):
        film = (20 + 15 * (1 - np.cos(2 * np.pi * k / steps))) * 1e-6
        along[0, :-1] = film**3 / (12 * 0.1) * (period / steps) / pitch
        lack = (film - content) * area
        assert relax_pressure(pressure, lack, around, along, held, 0 * held, -1e5, 1.95) > 0
        flow = along[0, :-1] * np.diff(pressure[0])
        content[0, :-1] += np.diff(flow, prepend=0) / area[0, :-1]
        content[0, -1] = film
        assert content.max() < film * (1 + 1e-5)
        cavity.append(max(0, (pressure[0] <= -1e5).sum() - 0.5) / nodes)  # half a cell first
    cavity = np.array(cavity)
    npt.assert_allclose(cavity.max(), 0.866324, atol=1 / nodes)
    npt.assert_allclose(np.flatnonzero(cavity)[-1] / steps, 0.87412, atol=2 / steps)

    time = np.array([0.01, 0.03, 0.05])  # while it grows, of the period
    film = (20 + 15 * (1 - np.cos(2 * np.pi * time))) * 1e-6
    rate = 15e-6 * 2 * np.pi / period * np.sin(2 * np.pi * time)
    front = 1 - np.sqrt(1e5 * film**3 / (0.6 * rate)) / width
    found = cavity[np.rint(time * steps).astype(int) - 1]
    npt.assert_allclose(found, front, atol=0.015)


def test_a_free_pin_follows_the_orbit_of_the_full_film():
    """The other solver has no cavities, other places of its unknowns and another step of time."""
    time = np.array([0, 1, 2]) * CYCLE
    start = (0.8 * ACRYLIC.clearance, 0.0)
    found = follow(time, start=start)
    known = follow_orbit(
        ACRYLIC,
        time,
        load=lambda _: LOAD,
        rotation=lambda t: float(rocker_speed(crank_at(np.asarray(t), RIG), RIG)),
        start=start,
    )
    film = ACRYLIC.clearance - np.hypot(*found.T)
    npt.assert_allclose(film, ACRYLIC.clearance - np.hypot(*known.T), rtol=5e-3)
    npt.assert_allclose(found[:, 1], known[:, 1], atol=2e-3 * ACRYLIC.clearance)


def test_a_spring_lies_between_a_guide_and_freedom():
    """Stiffnesses from far below to far above damping times frequency, 6e7 N/m."""
    time = np.linspace(0, 1, 21) * CYCLE
    swing = {}
    for stiffness in (0.0, 6e4, 6e7, 1.2e11):
        swing[stiffness] = np.ptp(follow(time, step=CYCLE / 40, stiffness=stiffness)[:, 1])
    npt.assert_allclose(swing[6e4], swing[0.0], rtol=0.02)
    assert 0.1 * swing[0.0] < swing[6e7] < 0.9 * swing[0.0]
    assert swing[1.2e11] < 1e-3 * swing[0.0]


def test_a_pin_that_touches_is_refused():
    with pytest.raises(ModelError, match="carries the load"):
        follow(np.array([0.0, 5.0]), load=lambda _: 1e4 * LOAD, step=0.05, stiffness=np.inf)


def test_an_oil_that_thickens_by_a_factor_is_another_oil():
    """The pressure of its cavities stays."""
    time = np.linspace(0, 1, 21) * CYCLE
    held = {"stiffness": np.inf, "step": CYCLE / 40, "cavity": -3e4}
    found = follow(time, thicker=lambda _: 1.5, **held)
    other = ACRYLIC._replace(viscosity=1.5 * ACRYLIC.viscosity)
    usual = {"load": lambda _: LOAD, "angle": bushing, "start": THIN}
    npt.assert_allclose(found, follow_cavitated(other, time, **usual, **held), atol=1e-9)


def test_both_halves_of_the_length_hold_what_one_holds_twice():
    time = np.linspace(0, 1, 5) * CYCLE
    held = {"stiffness": np.inf, "step": CYCLE / 20}
    npt.assert_allclose(follow(time, tilt=1e-12, **held), follow(time, **held), atol=1e-11)


def test_a_tilted_pin_is_held_as_finite_volumes_of_the_whole_length_hold_it():
    """By 7 um at each end; 2 % more film. What cells of cavities do is a tenth of it."""
    tilt, time = 6e-5, np.linspace(0, 2, 41) * CYCLE
    held = {"stiffness": np.inf, "step": CYCLE / 100}
    rig, volumes = (
        [
            ACRYLIC.clearance - follow(time, tilt=lean, **held)[-21:, 0].mean()
            for lean in (0.0, tilt)
        ],
        [],
    )
    motion = crank_motion(LINKS, crank_speed=SPEED, load=LOAD, cycles=2, steps_per_cycle=200)
    for half in (0.0, tilt * ACRYLIC.length / 2):
        joint = Journal(
            0.03336, 0.03359, ACRYLIC.length, ACRYLIC.viscosity, axial_shape=np.array([-half, half])
        )
        solved = solve_journal(
            joint, motion, start=THIN, sideways="guided", cells=(96, 8), compiled=True
        )
        volumes.append(joint.clearance - float(solved.displacement_load[-201:].mean()))
    npt.assert_allclose(rig[1] / rig[0] - 1, volumes[1] / volumes[0] - 1, rtol=0.2)


@pytest.mark.parametrize(
    ("own", "other"),
    [({"compliance": 1 / 3e11}, {"foundation": 3e11}), ({"roughness": 3e-6}, {"roughness": 3e-6})],
)
def test_a_pin_sinks_on_a_liner_and_between_rough_walls_as_finite_volumes_do(own, other):
    """From 12 to 6 um in 0.5 s; the liner deflects by 1.5 um, and rough walls hold back 0.3 um."""
    joint = Journal(0.03336, 0.03359, 0.024, 0.12, **other)
    bearing = RigidBearing(ACRYLIC.radius, ACRYLIC.clearance, 0.024, 0.12, **own)
    time, start, deflections = np.linspace(0, 0.5, 51), (joint.clearance - 12e-6, 0.0), []
    motion = Motion(time, [bushing(one) for one in time], load=100.0)
    sunk = {"load": lambda _: 100.0, "angle": bushing, "step": 0.01, "start": start}
    places = follow_cavitated(bearing, time, deflections=deflections, **sunk)
    solved = solve_journal(joint, motion, start=start, cells=(192, 12), maps=[25, 50])
    volumes = solved[["displacement_load", "displacement_side"]].to_array().values.T
    films = [joint.clearance - np.hypot(*place.T) for place in (places, volumes)]
    filled = time >= 0.05  # of the liner, within some steps of 10 ms
    npt.assert_allclose(films[0][filled], films[1][filled], atol=1e-8)
    rigid = follow_cavitated(bearing._replace(compliance=0.0, roughness=0.0), time, **sunk)
    assert abs(films[0][-1] - (joint.clearance - np.hypot(*rigid[-1]))) > 0.2e-6

    # the deflection of the wall at rest in the image, up to 1.5 um
    phi, axial = np.meshgrid(solved.circumference / joint.radius, solved.axial, indexing="ij")
    deflected = deflections[-1].at(phi, axial)
    if joint.foundation is None:
        assert not deflected.any()
    else:
        npt.assert_allclose(deflected, solved.pressure[-1] / joint.foundation, atol=2e-8)
        assert 1.4e-6 < deflected.max() < 1.5e-6


def test_a_liner_deflects_nothing_beyond_the_ends_of_the_joint():
    """A parabola along a length of 10 mm, of both halves and of one, in a picture of 16 mm."""
    place, angle = np.linspace(-5e-3, 5e-3, 41), np.linspace(-3.0, 3.0, 60)
    shown, depth = np.linspace(-8e-3, 8e-3, 65), lambda axial: 1e-6 * (1 - (axial / 5e-3) ** 2)
    for axial in (place, place[20:]):
        found = Deflection(angle, axial, np.tile(depth(axial), (60, 1))).at(np.full(65, 3.1), shown)
        npt.assert_allclose(found, np.maximum(depth(shown), 0.0), atol=1e-12)


def test_a_pin_sinks_on_lobes_as_finite_volumes_do():
    """A swinging bushing of 24 mm with two lobes, by two solvers; films of 12 to 10 um."""
    lobed = RigSettings(length=24.0, lobes=(-5.0, 4.0), lobe=(200.0, 20.0))
    bearing = RigidBearing(
        ACRYLIC.radius, ACRYLIC.clearance, 0.024, 0.12, lambda z: 1e-6 * bore_height(lobed, 1e3 * z)
    )
    z = np.arange(-1000, 1001) / 2000 * 0.024
    joint = Journal(0.03336, 0.03359, 0.024, 0.12, axial_shape=1e-6 * bore_height(lobed, 1e3 * z))
    time, start = np.linspace(0, 0.25, 26), (joint.least_clearance - 12e-6, 0.0)
    motion = Motion(time, [bushing(one) for one in time], load=10.0)
    rig = follow_cavitated(
        bearing, time, load=lambda _: 10.0, angle=bushing, step=0.01, start=start
    )
    solved = solve_journal(joint, motion, start=start, cells=(192, 16))
    volumes = solved[["displacement_load", "displacement_side"]].to_array().values.T
    films = [joint.least_clearance - np.hypot(*place.T) for place in (rig, volumes)]
    npt.assert_allclose(films[0], films[1], rtol=0.005)
