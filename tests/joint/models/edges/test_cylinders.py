"""Compliance of cylinders against closed forms of plane elasticity and of beams."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError

pytest.importorskip("skfem", reason="the finite elements of the joint are those of scikit-fem")

from erlif.joint.models.edges import edge_exponent
from erlif.joint.models.edges.cylinders import HarmonicSolver, Section, compute_compliance

NU, MODULUS = 0.3, 1e9
DISC = Section(np.linspace(0, 1, 8), np.array([0.0, 1.0]), 1.0, MODULUS, NU, False, held_ends=True)


@pytest.mark.parametrize("harmonic", [2, 3, 5])
def test_disc_under_a_harmonic_pressure(harmonic):
    """Michell's stress function A r^n + B r^(n + 2) for a disc under cos(n t), plane strain."""
    n, kappa = harmonic, 3 - 4 * NU
    exact = (1 + NU) / MODULUS * (n / (2 * (n - 1)) + (kappa - n - 1) / (2 * (n + 1)))
    found = compute_compliance(DISC, DISC.places, harmonics=[n]).matrices[0, 0, 0]
    npt.assert_allclose(found, exact, rtol=2e-3)


def test_ring_held_outside_is_that_of_lame():
    """u = A r + B / r, zero outside, -p inside."""
    radii = np.linspace(1, 2, 41)
    ring = Section(radii, np.array([0.0, 1.0]), 1.0, MODULUS, NU, True, held_ends=True)
    lame, shear = MODULUS * NU / ((1 + NU) * (1 - 2 * NU)), MODULUS / (2 * (1 + NU))
    # sigma_rr = 2 (lame + shear) A - 2 shear B / r^2, with 4 A + B = 0
    a = -1 / (2 * (lame + shear) + 8 * shear)
    found = compute_compliance(ring, ring.places, harmonics=[0])
    npt.assert_allclose(found.matrices[0, 0, 0], a - 4 * a, rtol=1e-3)
    solver = HarmonicSolver.of(ring)
    pressed = solver.solve(0, solver.pressure_vectors(ring.places))[:, 0]
    rr, tt, _, rz = solver.stress(0, pressed)
    r = solver.points[0]
    npt.assert_allclose(rr, 2 * (lame + shear) * a + 8 * shear * a / r**2, rtol=1e-3)
    npt.assert_allclose(tt, 2 * (lame + shear) * a - 8 * shear * a / r**2, atol=1e-3)
    npt.assert_allclose(rz, 0, atol=1e-10)


def test_high_harmonics_are_those_of_a_half_plane():
    """u = 2 (1 - nu^2) p / (E k) under p cos(k x), k = n / R."""
    lines = 1 - np.concatenate([[0], np.cumsum(0.01 * 1.5 ** np.arange(9))])[::-1]
    lines[0] = 0
    disc = Section(lines, np.array([0.0, 1.0]), 1.0, MODULUS, NU, False, held_ends=True)
    found = compute_compliance(disc, disc.places, harmonics=[64, 128])
    half_plane = 2 * (1 - NU**2) / (MODULUS * found.harmonics)
    npt.assert_allclose(found.matrices[:, 0, 0], half_plane, rtol=0.01)


def test_slender_pin_bends_like_a_beam():
    """A force at the end against a pressure in the middle: F a^3 / 3 E I with its shear."""
    places = np.linspace(0, 20, 21)
    pin = Section(np.linspace(0, 1, 4), places, 1.0, MODULUS, NU, False)
    cells = np.array([0.0, 1.0, 19.0, 20.0])
    found = compute_compliance(pin, cells, harmonics=[1], load_spans=[(19.0, 20.0)])
    # one newton on the last cell, carried by a pressure p cos(t) on the first: pi p R l = 1
    carried = found.loaded[:, 0] * -1 - found.matrices[0][:, 0] / np.pi
    sag = carried[2] - carried[0]
    arm, inertia, area = 19.5, np.pi / 4, np.pi  # to the middle of the load
    shear_modulus = MODULUS / (2 * (1 + NU))
    beam = arm**3 / (3 * MODULUS * inertia) + arm / (0.886 * shear_modulus * area)
    npt.assert_allclose(sag, beam, rtol=0.01)


def test_edge_has_the_exponent_of_a_right_angle():
    """A quarter space on a half space of equal material: r^-0.226 (Dundurs and Lee, 1972).

    The ends of a ring pressed evenly on a longer pin, from 1e-3 to 3e-5 of its length.
    """
    steps = 1e-5 * 1.6 ** np.arange(24)
    cells = 1 - np.concatenate([[0], np.cumsum(steps[np.cumsum(steps) < 0.9]), [1.0]])[::-1]
    beyond = np.unique(np.concatenate([cells, 2 - cells]))
    below = np.concatenate([[0], np.cumsum(2e-6 * 2.0 ** np.arange(20))])
    pin = Section(1 - below[below < 0.9][::-1], beyond, 1.0, MODULUS, NU, False)
    ring = Section(1 + below[below < 1.5], cells, 1.0, MODULUS, NU, True)
    matrix = sum(compute_compliance(body, cells, harmonics=[0]).matrices[0] for body in (pin, ring))
    pressure = np.linalg.solve(matrix, np.ones(cells.size - 1))
    distance = 1 - (cells[1:] + cells[:-1]) / 2
    near = (distance > 3e-5) & (distance < 1e-3)
    slope, _ = np.polyfit(np.log(distance[near]), np.log(pressure[near]), 1)
    npt.assert_allclose(-slope, edge_exponent(np.pi / 2), atol=5e-3)


def test_free_end_without_poisson_mirrors_its_load():
    """Hetényi (1970): a pressure and its mirror image leave the plane between them free."""
    cells = 0.4 - np.concatenate([[0], np.cumsum(0.004 * 1.6 ** np.arange(8)), [0.4]])[::-1]
    lines = 1 - np.concatenate([[0], np.cumsum(0.004 * 1.8 ** np.arange(9))])[::-1]
    lines[0] = 0
    share = {}
    for poisson in (0.0, 0.3):
        pin = Section(lines, cells, 1.0, MODULUS, poisson, False)
        moved = compute_compliance(pin, cells, harmonics=[32]).matrices[0].sum(axis=1)
        share[poisson] = 2 * moved[-1] / moved[0] - 1
    npt.assert_allclose(share[0.0], 1.0, atol=1e-3)
    assert 1.4 < share[0.3] < 1.6


def test_cells_that_miss_the_mesh_are_refused():
    with pytest.raises(ModelError, match="does not end at lines"):
        compute_compliance(DISC, np.array([0.0, 0.4]), harmonics=[0])
