"""Damaged files of every format: counts of the stated kind or one error, nothing else."""

import tracemalloc
from collections import Counter
from contextlib import closing

import numpy as np
import pytest
from scenes.mutations import FRAMES, SAMPLES, check_reader, mutate

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames

ROUNDS = 50
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
    # a test whose damages are all refused at once would not reach the decoders
    while outcomes.total() < ROUNDS or (len(outcomes) < 2 and outcomes.total() < 10 * ROUNDS):
        target.write_bytes(mutate(whole, rng))
        outcomes[check_reader(path)] += 1
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < MEMORY
    assert len(outcomes) >= 2, outcomes


@pytest.mark.parametrize("name", ["png", "hdf5 checked", "hdf5 latest", "im7 zlib"])
def test_a_damage_that_a_checksum_covers_never_changes_counts(tmp_path, name):
    write, damaged = SAMPLES[name]
    path, target = write(tmp_path), tmp_path / damaged
    whole = target.read_bytes()
    # the header of IM7 has no checksum; the last bytes are its attributes
    places = range(260, len(whole) - 30) if name == "im7 zlib" else range(len(whole))
    rng = np.random.default_rng(3)
    outcomes = Counter()
    for place in rng.choice(places, 150):
        content = bytearray(whole)
        content[place] ^= 1 << int(rng.integers(8))
        target.write_bytes(content)
        try:
            with closing(open_frames(path)) as file:
                counts = [file.read(index) for index in range(len(file.kinds))]
        except FrameError:
            outcomes["refused"] += 1
        else:
            np.testing.assert_array_equal(counts, FRAMES[: len(counts)])
            outcomes["read"] += 1
    assert outcomes["refused"] > 30, outcomes
