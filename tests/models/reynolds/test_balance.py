"""One implicit step: derivatives, complementarity and refusal."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.reynolds import Groove, Journal
from erlif.models.reynolds.balance import StepDrive, _Newton, advance, start_state
from erlif.models.reynolds.transient import Bearing

LOAD = np.array([2e3, 0.0])


def case(*, speed=0.3, load=LOAD, **changes):
    """A small journal bearing and one step of it."""
    values = {"cavitation_pressure": -1e4, **changes}
    joint = Journal(0.03336, 0.03359, length=0.05, viscosity=0.12, **values)
    bearing = Bearing.of(joint, (24, 3), [Groove(np.pi)])
    supplied = np.zeros((24, 3), dtype=bool)
    supplied[12] = True
    axes = bearing.directions(0.1, 0.0)
    none = np.zeros(2)
    step = StepDrive(bearing.rigid, axes, axes, load, none, none, 200.0, speed, supplied)
    return bearing.medium, step


@pytest.mark.parametrize("speed", [0.0, 0.3, -0.3])
@pytest.mark.parametrize("changes", [{}, {"foundation": 2e9}, {"pressure_viscosity": 1e-6}])
def test_newton_step_uses_the_derivatives_of_the_balance(speed, changes):
    """Central differences of the errors of all cells by each unknown."""
    medium, step = case(speed=speed, **changes)
    rng = np.random.default_rng(8)
    guess = start_state(medium, step, np.array([1e-4, 5e-5]))
    guess.full[...] = rng.random(guess.full.shape) > 0.3
    guess.reduced[...] = np.where(guess.full, 1e5 * rng.random(guess.full.shape), medium.floor)
    guess.void[...] = np.where(guess.full, 0.0, 2e-5 * rng.random(guess.full.shape))
    before = replace(guess, content=guess.content * (1 + 0.01 * rng.random(guess.full.shape)))

    newton = _Newton(medium, step, before, guess)
    newton.balances()
    unknown = ~step.supplied & (newton.full if speed == 0 else True)
    links = newton.coefficients(unknown)
    for cell in [(4, 1), (5, 0), (0, 2), (23, 1), (11, 1)]:
        if not unknown[cell]:
            continue
        name = "reduced" if newton.full[cell] else "void"
        size = 1.0 if name == "reduced" else 1e-9
        errors = []
        for sign in (1, -1):
            other = _Newton(medium, step, before, guess)
            getattr(other, name)[cell] += sign * size
            void = other.void.copy()
            other.moved()
            other.void = void
            other.balances()
            errors.append(other.error)
        slope = (errors[0] - errors[1]) / (2 * size)
        i, k = cell
        npt.assert_allclose(slope[cell], links.centre[cell], rtol=2e-5)
        for row, link in (((i - 1, k), links.following), (((i + 1) % 24, k), links.previous)):
            wanted = slope[row] if unknown[row] else 0.0
            npt.assert_allclose(link[row], wanted, rtol=2e-5, atol=1e-9 * abs(slope[cell]))


@pytest.mark.parametrize("speed", [0.0, 0.3])
def test_pressure_and_void_exclude_each_other(speed):
    medium, step = case(speed=speed, cavitation_pressure=-2e3)
    state = start_state(medium, step, np.array([1e-4, 5e-5]))
    for _ in range(3):
        state = advance(medium, step, state)
    assert 0 < (~state.full).sum() < state.full.size
    assert (state.void >= -1e-7 * state.walls.centre).all()
    assert (state.void[state.full] == 0).all()
    assert (state.reduced[~state.full] == -2e3).all()
    assert state.reduced.min() > -2e3 - 1e-6 * state.reduced.max()
    npt.assert_allclose(state.content, state.walls.centre - state.void, rtol=1e-6)


def test_load_without_a_film_to_carry_it_is_refused():
    medium, step = case(load=np.array([1e30, 0.0]))
    with pytest.raises(ModelError, match=r"not solved|vanished|carries no load"):
        advance(medium, step, start_state(medium, step, np.array([1e-4, 0.0])))
