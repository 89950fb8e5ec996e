"""Damaged files of every format: counts of the stated kind or one error, nothing else."""

from __future__ import annotations

import tracemalloc
from collections import Counter

import numpy as np
import pytest
from readers.mutations import SAMPLES, check_reader, mutate

ROUNDS = 150
"""Damages for each format in CI; long runs by hand had more (docs/formats.md)."""

MEMORY = 100e6
"""Highest memory for files of at most 10 kB. [byte]"""


@pytest.mark.parametrize("name", SAMPLES)
def test_a_damaged_file_gives_counts_or_one_error(tmp_path, name):
    write, damaged = SAMPLES[name]
    path = write(tmp_path)
    assert check_reader(path) == "read"

    target = tmp_path / damaged
    whole = target.read_bytes()
    rng = np.random.default_rng(len(name))
    outcomes = Counter()
    tracemalloc.start()
    for _ in range(ROUNDS):
        target.write_bytes(mutate(whole, rng))
        outcomes[check_reader(path)] += 1
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < MEMORY
    # a test whose damages are all refused at once would not reach the decoders
    assert len(outcomes) >= 2, outcomes
