"""Control charts of ratios whose drift is known."""

from dataclasses import replace

import numpy as np
import pytest

from erlif.review.comparison import control_chart
from erlif.show.plots import example_calibration


def test_a_patch_that_drifts_leaves_the_limits_and_noise_does_not(record):
    rng = np.random.default_rng(2)

    def run(ratio):
        return replace(record, patch_ratio=ratio + 0.01 * rng.standard_normal(400))

    steady = control_chart([run(1.0) for _ in range(8)], [])
    # noise of 0.01 in 400 triggers
    assert float(steady.patch_limit) == pytest.approx(3 * 0.01 / 20, rel=0.1)
    assert (np.abs(steady.patch_ratio - steady.patch_centre) < steady.patch_limit).all()
    drifting = control_chart([*(run(1.0) for _ in range(7)), run(1.01)], [])
    beyond = np.abs(drifting.patch_ratio - drifting.patch_centre) > drifting.patch_limit
    assert beyond.values[-1]


def test_calibrations_stand_in_the_order_of_their_dates_with_a_verdict():
    first = replace(example_calibration(), date="2026-01-01")
    later = replace(first, ratio_at_zero=1.05 * first.ratio_at_zero, date="2026-02-01")
    chart = control_chart([], [later, first])
    assert chart.calibration_date.values.tolist() == ["2026-01-01", "2026-02-01"]
    ratio = chart.calibration_ratio.values
    assert ratio[1] / ratio[0] == pytest.approx(1.05)
    assert str(chart.calibration_verdict.values[1]).startswith("drifted from example wedge")


def test_a_chart_needs_two_values(record):
    assert not control_chart([record], [example_calibration()]).data_vars
    apart = replace(example_calibration(), thickness_range=(20.0, 30.0))
    assert not control_chart([], [example_calibration(), apart]).data_vars
