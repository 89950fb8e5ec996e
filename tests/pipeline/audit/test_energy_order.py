"""Rows of the log against pairs, by the energy of the pulses."""

import numpy as np
import pytest

from erlif.pipeline.audit.energy_order import compare_energies

COUNT = 50


def energies(seed, jitter=0.03):
    """Energies of pulses, and their light as it is measured to 0.7 %."""
    rng = np.random.default_rng(seed)
    energy = 1 + jitter * rng.normal(size=COUNT)
    return energy, energy * (1 + 0.007 * rng.normal(size=COUNT))


@pytest.mark.parametrize("seed", range(50))
def test_energies_in_order_have_no_other_order(seed):
    order, odd = compare_energies(*energies(seed))
    assert order is None
    assert odd.size == 0


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("lag", [-5, -1, 1, 2, 5])
def test_a_late_log_is_found_by_its_energies(lag, seed):
    energy, light = energies(seed)
    order, _ = compare_energies(np.roll(energy, lag), light)
    assert (order.lag, order.since, order.reverse) == (lag, 0, False)


@pytest.mark.parametrize("seed", range(4))
def test_rows_that_are_missing_from_the_middle_are_found(seed):
    energy, light = energies(seed)
    order, _ = compare_energies(energy[:-3], np.delete(light, [20, 21, 22]))
    assert order.lag == 3
    assert abs(order.since - 20) <= 2


@pytest.mark.parametrize("seed", range(4))
def test_pairs_in_reverse_order_are_found(seed):
    energy, light = energies(seed)
    order, _ = compare_energies(energy, light[::-1])
    assert order.reverse


def test_two_pairs_in_each_others_place_are_found():
    energy, light = energies(1, jitter=0.05)
    low, high = int(np.argmin(light)), int(np.argmax(light))
    light[[low, high]] = light[[high, low]]
    order, odd = compare_energies(energy, light)
    assert order is None
    assert odd.tolist() == sorted([low, high])


@pytest.mark.parametrize("seed", range(4))
def test_energies_that_have_nothing_to_do_with_the_light_determine_nothing(seed):
    assert compare_energies(energies(seed)[0], energies(seed + 100)[1]) is None
    energy, light = energies(seed)
    assert compare_energies(np.ones(COUNT), light) is None
    assert compare_energies(energy[:12], light[:12]) is None
