"""Counters of 2^k states against the counts without an end from which they were made."""

import numpy as np
import pytest

from erlif.io.ingest.encoder_log import read_log
from erlif.io.ingest.logs.columns import ColumnChoice
from erlif.io.ingest.logs.counters import count_on

SWING = np.rint(200 * np.sin(np.arange(40) / 5))
RISING = np.arange(40.0) * 9


@pytest.mark.parametrize("bits", [12, 14, 16, 20, 24, 32])
@pytest.mark.parametrize("signed", [False, True])
@pytest.mark.parametrize("counts", [SWING, RISING], ids=["swing", "rising"])
@pytest.mark.parametrize("before", [0, 1, 100, 199])
def test_a_counter_is_counted_on(bits, signed, counts, before):
    half = 2 ** (bits - 1) * signed
    truth = counts + 2**bits - before - half
    logged = (truth + half) % 2**bits - half
    found, told = count_on(logged, turn=3600 if bits != 12 else 0)
    assert np.ptp(found - truth) == 0
    assert told == (bits if np.ptp(logged) > 1000 else 0)


@pytest.mark.parametrize(
    ("values", "turn"),
    [
        (np.arange(0, 9000, 70) % 3600, 3600),  # starts again after a turn
        (np.arange(0, 90000, 700) % 4096, 4096),
        (np.concatenate([np.arange(5000, 5100), np.arange(100)]), 3600),  # reset by hand
        (SWING, 3600),
        (np.array([0.5, 65535.5, 0.5]), 3600),  # no count
        (np.array([7.0]), 3600),
        (np.array([1.0, np.nan, 65535.0]), 3600),
        (np.random.default_rng(1).integers(0, 65536, 50), 3600),  # noise
    ],
)
def test_other_numbers_stay_as_they_are(values, turn):
    found, bits = count_on(values.astype(float), turn)
    assert bits == 0
    np.testing.assert_array_equal(found, values)


def test_ticks_clock_and_frames_of_a_log_are_counted_on(tmp_path):
    rows = np.arange(60)
    ticks = (65500 + 2 * rows) % 65536
    clock = (2**32 - 30_000 + 1000 * rows) % 2**32
    frames = (rows + 230) % 256
    lines = [f"{f},{t},{c}" for f, t, c in zip(frames, ticks, clock, strict=True)]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(["frame,Encoder,time_us", *lines]) + "\n")
    choice = ColumnChoice({"angle": "Encoder"}, {"angle": "tick"}, 3600)
    log, (note,) = read_log(path, choice, frames=60)
    np.testing.assert_allclose(np.diff(log["angle"]), 0.2)
    np.testing.assert_allclose(np.diff(log["time"]), 1e-3)
    np.testing.assert_array_equal(log["number"], rows + 230)
    for text in ("Encoder is a counter of 16", "time_us is a counter of 32", "frame is a counter"):
        assert text in note.text
