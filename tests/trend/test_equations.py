"""Equations of a gap of known form, solved for many runs."""

import numpy as np
import numpy.testing as npt

from erlif.trend import RatioEquations, RigidityUnknowns, gap_of_pin, solve_equations


def test_scatter_of_the_errors_is_that_of_runs_with_other_noise():
    """One joint, one set of errors, 300 runs: noise and bends of the frames are new in each.

    The second error is a displacement of the pin, and not looked at.
    """
    rng, x = np.random.default_rng(8), np.linspace(-8, 8, 30)
    across = np.tile([-6.0, 0.0, 6.0], 10)
    gap = gap_of_pin(x, across, 33.5, clearance_std=2.0)
    slope = 0.05 + 0.03 * rng.random((15, 30))
    acts = np.stack([np.ones_like(slope), slope / 0.05, slope**2 / 0.0025])
    equations = RatioEquations(slope, acts, np.full(slope.shape, 1e-6), *gap)
    start = RigidityUnknowns(np.zeros(3), np.zeros(30), np.zeros((15, 5)))
    prior = np.diag([1e-2, 2e-2, 1e-2]) ** 2
    found = []
    for _ in range(300):
        noise = 1e-3 * rng.standard_normal(slope.shape)
        noise = noise + slope * np.outer(gap[1][-1] * rng.standard_normal(15), gap[0][-1])
        change, covariance, scatter = solve_equations(equations, prior, noise, start)
        found.append(change.errors)
    seen = [0, 2]
    stated = np.sqrt(np.diag(scatter))[seen]
    npt.assert_allclose(np.std(found, axis=0)[seen], stated, rtol=0.13)  # 3 std of 300 draws
    assert (np.diag(scatter) < np.diag(covariance)).all()
