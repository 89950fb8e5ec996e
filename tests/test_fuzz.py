"""Files damaged at random: they are read, or refused by an error of erlif.

The seeds are fixed and the number of damages is small; long runs are made by hand, and include
figures, reports and budgets (benchmarks/fuzz_readers.py).
"""

import shutil

import numpy as np
import pytest
from damages.at_random import PRODUCTS

from erlif.core.errors import ErlifError

SLOW = ("figures", "report", "budget")
"""What is made by hand: one film takes seconds."""

TRIES = {".toml": 60, ".csv": 60, ".nc": 10}
"""Damaged files by their suffix."""

TRIES_OF_LOGS = 25
"""Damaged binary logs of each kind."""


@pytest.mark.parametrize("kind", [name for name in PRODUCTS if not name.startswith(SLOW)])
def test_a_file_damaged_at_random_is_read_or_refused(kind, small_rig, tmp_path):
    if kind == "log tdms":
        pytest.importorskip("nptdms")
    product = PRODUCTS[kind]
    whole, work = tmp_path / "whole", tmp_path / "work"
    whole.mkdir()
    product.write(small_rig.directory, whole)
    shutil.copytree(whole, work)
    product.use(work)

    rng = np.random.default_rng([7, *kind.encode()])
    messages = []
    for _ in range(TRIES.get("." + product.damaged[0].split(".")[-1], TRIES_OF_LOGS)):
        shutil.rmtree(work)
        shutil.copytree(whole, work)
        product.damage(work, rng)
        try:
            product.use(work)
        except ErlifError as error:
            messages.append(str(error))
    assert messages
    assert [message for message in messages if "Expected" not in message] == []
