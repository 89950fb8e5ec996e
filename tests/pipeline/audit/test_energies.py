"""Order of the rows by the energy of the pulses, of logs whose order is known."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.pipeline.audit.energies import compare_energies, shifted

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


def test_a_late_log_is_found_where_its_order_alone_agrees():
    """With energies that scatter by 3 % and light that is measured to 1.4 %."""
    found = []
    for seed in range(40):
        energy, light = energies(seed)
        light *= 1 + 0.012 * np.random.default_rng(seed + 50).normal(size=COUNT)
        assert compare_energies(energy, light)[0] is None
        order = (compare_energies(np.roll(energy, 1), light) or (None,))[0]
        found += [] if order is None else [order[:3]]
    assert set(found) == {(1, 0, False)}
    assert len(found) >= 36


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


def test_a_shift_of_more_rows_than_there_are_leaves_nothing():
    values = np.arange(4.0)
    npt.assert_array_equal(shifted(values, 0), values)
    npt.assert_array_equal(shifted(values, -1), [np.nan, 0, 1, 2])
    assert np.isnan(shifted(values, 4)).all()


def test_light_that_is_off_alike_for_all_films_of_a_size_is_no_other_recording():
    """A wall that reflects gives the thin films of both reversals 8 % more light."""
    rng = np.random.default_rng(12)
    energies = 1 + 0.03 * rng.normal(size=50)
    speed = np.abs(np.sin(2 * np.pi * np.arange(50) / 50))
    levels = 0.1 * speed**0.6 + 1e-3 * rng.normal(size=50)
    light = energies * (1 + 0.08 * np.exp(-levels / 0.02)) * (1 + 0.003 * rng.normal(size=50))
    assert compare_energies(energies, light)[1].size  # without the films
    assert not compare_energies(energies, light, levels)[1].size

    light[12] *= 1.12  # a pair of another recording
    np.testing.assert_array_equal(compare_energies(energies, light, levels)[1], [12])
