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
