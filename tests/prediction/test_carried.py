"""Films of known truth: the sentence names what carries them, or that no model fits."""

import numpy as np
import pytest
from scenes.carried import KINDS, compare, pulls

from conftest import FULL

SEEDS = 2 if FULL else 1
GUIDED = [name for name in KINDS if name.startswith("guided")]


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in KINDS if name not in GUIDED])
def test_the_sentence_is_right_and_its_numbers_lie_within_their_errors(name):
    kind = KINDS[name]
    for seed in range(SEEDS):
        found, truth = compare(name, seed)
        first = found.verdict.partition(". ")[0]
        assert first.startswith(kind.right)
        assert len(first) <= 150
        assert all(abs(one) < 3 for one in pulls(found, truth).values())


@pytest.mark.slow
@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.9])
def test_a_film_at_rest_is_no_squeeze_however_its_errors_are_correlated(correlation):
    verdicts = [compare("constant", seed, correlation)[0].verdict for seed in range(8)]
    assert np.mean([one.startswith(KINDS["constant"].right) for one in verdicts]) == 1.0
