"""Notes on rows of the log that belong to other pairs."""

from types import SimpleNamespace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.io.settings import SliderCrankSettings
from erlif.pipeline.audit.order import (
    compare_energies,
    compare_film,
    find_other_films,
    find_zero,
    note_order,
    shifted,
)

ENERGIES = 1 + 0.05 * np.random.default_rng(3).normal(size=50)


def evidence(light, energies=ENERGIES):
    """Of a run whose log has no speed; its frames are numbered from 100."""
    return SimpleNamespace(
        numbers=100 + np.arange(50),
        energies=energies,
        light=light,
        levels=np.zeros(50),
        logged=lambda name: None,
    )


@pytest.mark.parametrize(
    ("light", "words"),
    [
        (np.roll(ENERGIES, -2), "2 rows later"),
        (np.roll(ENERGIES, 2), "2 rows earlier"),
        (ENERGIES[::-1], "reverse order"),
        (np.where(np.arange(50) == 7, 3.0, ENERGIES), "pair 107 is"),
    ],
)
def test_an_order_is_named_with_its_pairs(light, words):
    (note,) = note_order(evidence(light))
    assert words in note.text


def test_rows_in_order_and_a_log_without_energies_bring_no_note():
    assert list(note_order(evidence(ENERGIES))) == []
    assert list(note_order(evidence(ENERGIES, energies=None))) == []


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


TURN = 2 * np.pi * np.arange(COUNT) / COUNT
SPEED = np.abs(np.sin(TURN) + 0.12 * np.sin(2 * TURN))


def film(seed=1, lag=0):
    level = np.log1p(SPEED**0.6)
    return np.roll(level, lag) + 0.003 * np.random.default_rng(seed).normal(size=COUNT)


def film_of(level, seed=1):
    return level + 0.003 * np.random.default_rng(seed).normal(size=COUNT)


@pytest.mark.parametrize("lag", [-5, -1, 1, 5])
def test_a_late_log_is_found_by_the_film(lag):
    order = compare_film(SPEED, film(lag=-lag))
    assert (order.lag, order.since) == (lag, 0)


def test_pairs_in_reverse_order_are_found_by_the_film():
    """One stroke is faster than the other."""
    level = np.log1p(np.abs(np.sin(TURN) + 0.12 * np.sin(2 * TURN + 0.5)) ** 0.6)
    drive = np.abs(np.sin(TURN) + 0.12 * np.sin(2 * TURN + 0.5))
    assert compare_film(drive, film_of(level[::-1])).reverse
    assert compare_film(drive, film_of(level)) is None


def test_pairs_lost_in_the_middle_are_found_by_the_film():
    order = compare_film(SPEED[:-4], np.delete(film(), [20, 21, 22, 23]))
    assert (order.lag, order.since) == (4, 20)


@pytest.mark.parametrize("seed", range(10))
def test_a_film_of_its_own_speed_has_no_other_order(seed):
    assert compare_film(SPEED, film(seed)) is None
    assert find_other_films(SPEED, film(seed)).size == 0


@pytest.mark.parametrize("memory", [3, 5, 10, 20])
def test_a_film_that_squeeze_delays_has_no_other_order(memory):
    """It follows the speeds before, with an exponential memory of so many frames."""
    level = np.zeros(3 * COUNT)
    for k in range(1, level.size):
        level[k] = level[k - 1] + (SPEED[k % COUNT] - level[k - 1]) / memory
    assert compare_film(SPEED, level[-COUNT:]) is None


@pytest.mark.parametrize("noise", [0, 0.003])
@pytest.mark.parametrize("memory", [3, 4, 6])
@pytest.mark.parametrize(("count", "strokes"), [(24, 2), (30, 2), (36, 4), (50, 4), (50, 2)])
def test_the_speed_of_equal_strokes_has_no_other_order(count, strokes, memory, noise):
    """Half a turn later it is the same, and a delay of the film looks like rows that are later."""
    for start in np.arange(0, count / strokes, 2.3):
        speed = np.abs(np.sin(np.pi * strokes * (np.arange(count) + start) / count))
        level = np.zeros(4 * count)
        for k in range(1, level.size):
            level[k] = level[k - 1] + (speed[k % count] - level[k - 1]) / memory
        seen = level[-count:] + noise * np.random.default_rng(1).normal(size=count)
        assert compare_film(speed, seen) is None


def test_a_film_of_another_speed_is_found():
    level = film()
    level[[12, 30]] = level[[25, 37]]
    found = find_other_films(SPEED, level).tolist()
    assert 12 in found
    assert set(found) <= {12, 30}


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


SLIDER = {"speed": lambda angle: np.abs(np.cos(angle)), "period": 180.0}


@pytest.mark.parametrize("off", [-60.0, -20.0, 8.0, 45.0])
def test_the_zero_of_a_drive_is_found_by_a_film_that_follows_the_speed(off):
    angle = np.linspace(0.1, 6 * np.pi, 90)
    film = np.abs(np.cos(angle)) ** 0.6 + 0.02 * np.random.default_rng(4).normal(size=90)
    found = find_zero(angle - np.radians(off), np.ones(90), film, **SLIDER)
    assert found == pytest.approx(off, abs=2)
    assert find_zero(angle, np.ones(90), film, **SLIDER) is None


@pytest.mark.parametrize("memory", [2.0, 6.0])
def test_a_film_that_squeeze_delays_has_no_other_zero(memory):
    angle = np.linspace(0.1, 6 * np.pi, 90)
    film, step = np.abs(np.cos(angle)), 1 - np.exp(-1 / memory)
    for k in range(1, 90):
        film[k] = film[k - 1] + step * (film[k] - film[k - 1])
    film += 0.02 * np.ptp(film) * np.random.default_rng(4).normal(size=90)
    assert find_zero(angle, np.ones(90), film, **SLIDER) is None


def pin_speed(angle):
    """Of a crank of 16 and a rod of 44 cm, over that of the crank."""
    ratio = 16 / 44
    return 1 + ratio * np.cos(angle) / np.sqrt(1 - (ratio * np.sin(angle)) ** 2)


PIN = {"speed": pin_speed, "period": 360.0}


def pin_film(angle, memory=0.0):
    """A power of the speed, or one that follows it with a delay of so many frames."""
    film = pin_speed(angle) ** 0.6
    step = 1 - np.exp(-1 / memory) if memory else 1.0
    for k in range(1, film.size):
        film[k] = film[k - 1] + step * (film[k] - film[k - 1])
    return film + 0.02 * np.ptp(film) * np.random.default_rng(4).normal(size=film.size)


@pytest.mark.parametrize("off", [-150.0, 20.0, 40.0, 179.0])
def test_the_zero_of_a_crank_is_found_where_the_film_would_lead_its_speed_or_fall(off):
    angle = np.linspace(0.1, 4 * np.pi, 80)
    found = find_zero(angle - np.radians(off), np.ones(80), pin_film(angle), **PIN)
    assert (found - off + 180) % 360 - 180 == pytest.approx(0, abs=5)


@pytest.mark.parametrize("off", [0.0, 180.0])
def test_a_crank_that_is_half_a_turn_off_is_named(off):
    angle = np.linspace(0.1, 4 * np.pi, 50)
    columns = {
        "crank_angle": np.degrees(angle) + off,
        "rocker_speed": pin_speed(angle + np.radians(off)),
    }
    one = evidence(ENERGIES)
    one.levels, one.logged = pin_film(angle), columns.get
    links = {"crank": "16 cm", "coupler": "44 cm", "crank_speed": "114 rpm"}
    one.run = SimpleNamespace(
        settings=SimpleNamespace(mechanism=SliderCrankSettings(kind="slider-crank", **links))
    )
    found = [note.text for note in note_order(one)]
    assert len(found) == (off > 0)
    assert all("a crank angle -180 deg off" in text for text in found)


@pytest.mark.parametrize("memory", [0.0, 2.0, 6.0, 25.0])
def test_a_film_that_follows_the_crank_pin_late_has_no_other_zero(memory):
    angle = np.linspace(0.1, 4 * np.pi, 80)
    assert find_zero(angle, np.ones(80), pin_film(angle, memory), **PIN) is None
