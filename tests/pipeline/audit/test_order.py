"""Notes on rows of the log that belong to other pairs."""

from types import SimpleNamespace

import numpy as np
import pytest

from erlif.pipeline.audit.energies import compare_energies
from erlif.pipeline.audit.order import note_order

ENERGIES = 1 + 0.05 * np.random.default_rng(3).normal(size=50)


def evidence(light, energies=ENERGIES):
    """Of a run whose log has no speed; its frames are numbered from 100."""
    return SimpleNamespace(
        numbers=100 + np.arange(50),
        order=None if energies is None else compare_energies(energies, light),
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


@pytest.mark.parametrize("ramp", [True, False])
def test_a_film_that_ignores_its_load_has_no_other_order(ramp):
    """Some films of a crank pin fit a shifted log of speed over load by chance."""
    load = np.linspace(0.4, 1.8, 40) if ramp else np.repeat([1.0, 2.0, 0.7], 14)[:40]
    for seed in range(40):
        rng = np.random.default_rng(seed)
        speed = 1 + 0.36 * np.cos(np.linspace(0.1, 2 * np.pi * rng.uniform(0.6, 1.4), 40))
        logged = {"rocker_speed": speed, "joint_load": load}
        one = SimpleNamespace(
            numbers=np.arange(40),
            order=None,
            levels=speed**0.6 + 0.02 * rng.normal(size=40),
            logged=logged.get,
        )
        assert not list(note_order(one))
