"""Orbits for sets of unknowns: both kinds agree where nothing ruptures."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.orbits import RIG

from erlif.models.reynolds import Journal, crank_motion
from erlif.models.reynolds.full_film import follow_full_film
from erlif.prediction.orbits import FreeOrbits, HeldOrbits, lead_of

MOTION = crank_motion(RIG, crank_speed=11.94, load=222.4, cycles=1, steps_per_cycle=100)
LONG = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
FREE = {
    "fluidity": np.array([1.0, 0.5]),
    "start_film": np.log([20e-6, 30e-6]),
    "start_attitude": np.array([0.05, 0.0]),
}


NO_SPRING = -9.0  # decimal logarithm of a stiffness in N/m


@pytest.mark.parametrize("stiffness", [NO_SPRING, 5.0])
def test_the_orbit_is_the_same_in_a_film_that_could_rupture(stiffness):
    quick = FreeOrbits(LONG, MOTION).follow(FREE)
    if stiffness > NO_SPRING:
        spring = {"fluidity": FREE["fluidity"], "stiffness": 10**stiffness}
        quick = follow_full_film(LONG, MOTION, start=quick[:, 0], **spring)
    unknowns = FREE | {"rest": np.zeros(2), "stiffness": np.full(2, stiffness)}
    solved = HeldOrbits(LONG, MOTION, "spring", cells=(256, 1)).follow(unknowns)
    npt.assert_allclose(quick, solved, atol=3e-7)


def test_pressure_of_the_free_film_is_far_above_cavitation():
    orbits = FreeOrbits(LONG, MOTION)
    assert -2e4 < orbits.lowest_pressure(orbits.follow(FREE)[0]) < 0


def test_stiff_spring_guides_and_soft_spring_frees():
    unknowns = {**{name: one[:1] for name, one in FREE.items()}, "rest": np.zeros(1)}
    unknowns["start_attitude"] = np.zeros(1)
    at = {
        size: HeldOrbits(LONG, MOTION, "spring", cells=(64, 1)).follow(
            {**unknowns, "stiffness": np.array([size])}
        )[0]
        for size in (NO_SPRING, 1.0, 12.0)
    }
    npt.assert_allclose(at[1.0], at[NO_SPRING], atol=1e-9)
    npt.assert_allclose(at[12.0][:, 1], 0.0, atol=1e-8)


def test_load_that_no_film_carries_leaves_no_orbit():
    heavy = crank_motion(RIG, crank_speed=11.94, load=1e9, cycles=1, steps_per_cycle=20)
    unknowns = {"fluidity": np.array([1.0]), "start_film": np.log([20e-6])}
    orbits = HeldOrbits(LONG, heavy, "guided", cells=(32, 1))
    assert np.isnan(orbits.follow({**unknowns, "rest": np.zeros(1)})).all()


def test_longer_lead_ends_what_cavities_remember():
    """At a tenth of an atmosphere of suction the cavities take turns to form."""
    crank = np.linspace(0.0, 2 * np.pi, MOTION.time.size)
    orbits = HeldOrbits(LONG, MOTION, "guided", cells=(64, 1), lead=lead_of(MOTION, crank))
    unknowns = {"fluidity": 0.8, "start_film": np.log(30e-6), "cavitation_pressure": 0.1}
    changes, films = [], []
    for _ in range(4):
        films.append(orbits.follow_one((64, 1), 2, **unknowns)[0, 0])
        orbits, unknowns["start_film"], change = orbits.lengthened(unknowns)
        changes.append(change)
    assert orbits.turns == 5
    assert changes[3] < 0.1 * changes[0]
    npt.assert_allclose(films, films[0], atol=1e-9)


def test_films_of_a_long_run_are_the_same_side_by_side():
    """Bit for bit: each has arrays of its own."""
    motion = crank_motion(RIG, crank_speed=11.94, load=222.4, cycles=21, steps_per_cycle=100)
    both = {"fluidity": np.array([1.0, 0.5]), "start_film": np.log([25e-6, 20e-6])}
    together = HeldOrbits(LONG, motion, "guided", cells=(64, 1)).follow(both)
    for k in range(2):
        alone = HeldOrbits(LONG, motion, "guided", cells=(64, 1)).follow(
            {name: values[k : k + 1] for name, values in both.items()}
        )
        npt.assert_array_equal(together[k], alone[0])
