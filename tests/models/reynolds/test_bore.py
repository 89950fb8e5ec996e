"""The squeeze film of bores with lobes and edges, against plain differences on a fine grid."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import scipy.sparse as sp
from scipy.integrate import solve_ivp
from scipy.sparse.linalg import spsolve

from erlif.models.reynolds import Journal, Motion, lobe_shape, relief_shape, solve_journal
from erlif.models.reynolds.full_film import FullFilm

LENGTH, AROUND, ALONG = 0.024, 120, 96
Z = (np.arange(-1000, 1001) / 2000) * LENGTH
STRAIGHT = Journal(0.03336, 0.03359, length=LENGTH, viscosity=0.12)
SHAPES = {
    "lobes": lobe_shape(Z, centres=[-5e-3, 4e-3], radius=0.2, height=20e-6),
    "edges": relief_shape(Z, length=LENGTH, edge=6e-3, depth=30e-6),
}


def damping(film, journal, shape, rough=0.0):
    """Load over the rate of approach at a least film, of cells beside the load line alone. [N s/m]

    div(h^3 grad p) = 12 eta dh/dt by five points, ambient at both ends and opposite to the load;
    between walls of a roughness [m] with the pressure flow factor of Patir and Cheng (1978).
    """
    phi = (np.arange(AROUND) + 0.5) / AROUND * np.pi  # half of the joint, the other is its image
    z = (np.arange(ALONG) + 0.5) / ALONG * LENGTH - LENGTH / 2
    dx, dz = journal.radius * np.pi / AROUND, LENGTH / ALONG
    far = journal.clearance + shape.min() - film

    def gap(angle, place):
        added = np.interp(place, Z, shape)
        h = journal.clearance + added[None, :] - far * np.cos(angle)[:, None]
        return h**3 * (1 - 0.9 * np.exp(-0.56 * h / rough) if rough else 1)

    along = gap(np.arange(AROUND + 1) / AROUND * np.pi, z) / dx**2
    across = gap(phi, np.arange(ALONG + 1) / ALONG * LENGTH - LENGTH / 2) / dz**2
    along[0] = 0.0  # the load line
    along[-1] *= 2  # ambient, half a cell away
    across[:, [0, -1]] *= 2
    centre = -(along[1:] + along[:-1] + across[:, 1:] + across[:, :-1]).ravel()
    beside = np.pad(across[:, 1:-1], ((0, 0), (0, 1))).ravel()[:-1]
    below = along[1:-1].ravel()
    matrix = sp.diags_array(
        [centre, beside, beside, below, below], offsets=[0, 1, -1, ALONG, -ALONG], format="csc"
    )
    squeeze = -12 * journal.viscosity * np.cos(phi)[:, None] + 0 * z
    pressure = spsolve(matrix, squeeze.ravel()).reshape(AROUND, ALONG)
    return 2 * (pressure * np.cos(phi)[:, None]).sum() * dx * dz


@pytest.mark.parametrize("name", SHAPES)
def test_a_pin_sinks_on_a_shaped_bore_as_plain_differences_say(name):
    """From 12 um; on a straight bore the pin would sink by another third more or less."""
    shape, load, time = SHAPES[name], 10.0, np.linspace(0.0, 0.4, 41)
    joint = replace(STRAIGHT, axial_shape=shape)

    def films(journal):
        start = (journal.least_clearance - 12e-6, 0.0)
        motion = Motion(time, angle=0 * time, load=load)
        found = solve_journal(journal, motion, start=start, cells=(240, 16))
        return journal.least_clearance - found.displacement_load.values

    table = np.geomspace(2e-6, 13e-6, 12)
    rate = [np.log(damping(film, joint, shape)) for film in table]

    def sinking(_, film):
        return -load / np.exp(np.interp(np.log(film), np.log(table), rate))

    plain = solve_ivp(sinking, time[[0, -1]], [12e-6], t_eval=time, rtol=1e-8, atol=1e-12).y[0]
    fall, straight, expected = (12e-6 - one[-1] for one in (films(joint), films(STRAIGHT), plain))
    npt.assert_allclose(films(joint), plain, rtol=0.02)
    npt.assert_allclose(fall, expected, rtol=0.05)
    assert abs(straight / expected - 1) > 0.3


def test_dampings_of_a_full_film_are_those_of_plain_differences():
    """Between smooth walls the damping at 2 um is 2 or 13 % less."""
    shape, rough = SHAPES["lobes"], 1e-6
    joint = replace(STRAIGHT, axial_shape=shape, roughness=rough)
    films = np.array([30e-6, 12e-6, 5e-6, 2e-6])
    found = FullFilm.of(joint).damping(films / joint.least_clearance)[:, 0]
    plain = [damping(film, joint, shape, rough) for film in films]
    npt.assert_allclose(found, plain, rtol=1e-3)
    assert found[-1] > 1.01 * damping(films[-1], joint, shape)


@pytest.mark.parametrize("name", SHAPES)
def test_cells_lie_where_a_bore_is_curved(name):
    """Twice as many cells change the film of a few um by less than a hundredth."""
    joint, time = replace(STRAIGHT, axial_shape=SHAPES[name]), np.linspace(0.0, 0.4, 21)
    start, motion = (joint.least_clearance - 5e-6, 0.0), Motion(time, 0.5 * time, load=10.0)

    def film(cells):
        found = solve_journal(joint, motion, start=start, cells=cells)
        return joint.least_clearance - np.hypot(found.displacement_load, found.displacement_side)

    npt.assert_allclose(film((192, 12)), film((192, 24)), rtol=0.01)
