"""Forces and lowest pressures of a squeezed film, against closed forms and other solvers."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
from scenes.orbits import STATED as JOINT

from erlif.models.reynolds import Journal, Motion, solve_journal
from erlif.models.reynolds.full_film import FullFilm
from erlif.rig.orbit import Mobility, RigidBearing

LONG = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
SHORT = Journal(0.03336, 0.03359, length=0.024, viscosity=0.12)
FILMS = np.array([1.0, 0.7, 0.2, 0.05, 0.01, 0.002])


def test_dampings_of_a_long_film_are_those_of_booker():  # Booker (1965)
    eccentricity, film = 1 - FILMS, FullFilm.of(LONG)
    along, across = (film.damping(FILMS) * LONG.clearance / LONG.squeeze_constant).T
    npt.assert_allclose(along, (1 - eccentricity**2) ** -1.5, rtol=2e-6)
    npt.assert_allclose(
        across, 2 / ((2 + eccentricity**2) * np.sqrt(1 - eccentricity**2)), rtol=2e-6
    )


def test_dampings_of_a_finite_film_are_those_of_chebyshev_collocation():
    found = FullFilm.of(JOINT).damping(FILMS)
    rig = Mobility(RigidBearing(JOINT.radius, JOINT.clearance, JOINT.length, JOINT.viscosity))
    npt.assert_allclose(found, [rig.damping(1 - film) for film in FILMS], rtol=1e-4)


def test_lowest_pressure_is_that_of_the_film():
    motion = Motion(np.array([0.0, 1e-3]), angle=np.zeros(2), load=222.4)
    for start in (0.0, 115e-6, 200e-6):
        solved = solve_journal(JOINT, motion, start=(start, 0.0), cells=(256, 32), maps=[1])
        film = 1 - solved.displacement_load.values[-1:] / JOINT.clearance
        bound = FullFilm.of(JOINT).lowest_pressure(film, np.array([[222.4, 0.0]]))[0]
        npt.assert_allclose(float(solved.pressure.min()), bound, rtol=0.01)


def test_full_film_of_a_level_shape_is_that_of_the_straight_bore():
    """Of two solvers: all cells, and harmonics along the axis; 2 and 5 um of 230 by 3e-4."""
    films, force = np.array([1.0, 0.5, 0.1, 0.03, 0.01]), np.ones((5, 2))
    short = replace(SHORT, roughness=1e-6)
    level, straight = (FullFilm.of(replace(short, axial_shape=one)) for one in (np.zeros(3), None))
    npt.assert_allclose(level.damping(films), straight.damping(films), rtol=3e-4)
    pressures = (one.lowest_pressure(films, force) for one in (level, straight))
    npt.assert_allclose(*pressures, rtol=3e-4)
