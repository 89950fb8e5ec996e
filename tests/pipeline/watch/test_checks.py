"""Counts with known histograms, and the advice that follows."""

import numpy as np
import pytest

from erlif.pipeline.watch.checks import MapCheck, advise, check_counts


def test_counts_are_described_by_their_own_numbers():
    counts = np.full((100, 100), 400, np.uint16)
    counts[:2] = 4095  # 2 %
    check = check_counts(counts, 4095)
    assert check.saturated == pytest.approx(0.02)
    assert check.mean == pytest.approx(0.98 * 400 + 0.02 * 4095)
    assert check.highest == 1.0
    assert sum(check.histogram) == counts.size
    assert check.histogram[400 * 64 // 4096] == 9800
    assert check.histogram[-1] == 200


def test_advice_names_the_camera_and_what_to_turn():
    bright = check_counts(np.full((64, 64), 4095, np.uint16), 4095)
    weak = check_counts(np.full((64, 64), 819, np.uint16), 4095)
    good = check_counts(np.full((64, 64), 3000, np.uint16), 4095)
    nothing = [float("nan")] * 2
    assert advise([good, good], None, nothing) == []
    first, second = advise([bright, weak], None, nothing)
    assert first.startswith("camera 1 saturates in 100.0 %")
    assert "camera 2 uses 20 % of its range: 4.0 times" in second
    soft = good._replace(sharpness=0.2)
    (text,) = advise([good._replace(sharpness=0.4), soft], None, [0.4, 0.4])
    assert "camera 2 has 50 % of the best sharpness" in text
    (text,) = advise([good, good], MapCheck((60.0, 0.0), 0.9, 0.8, 0.0), nothing)
    assert "sees 80 %" in text
    assert "+60 px along x" in text
