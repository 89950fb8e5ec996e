"""Figure of a plan: curves, ranges and full scale are those of the plan."""

import numpy.testing as npt
import pytest

from erlif.show import plots


@pytest.fixture(scope="module")
def planned():
    return plots.example_plan_results()


def test_curves_are_those_of_the_plan(planned):
    ratio, best = plots.plan_ratio(planned)
    calibrated, measurable = ratio.axes.patches
    for patch, bounds in ((calibrated, "calibrated_range"), (measurable, "measurable_range")):
        low, width = patch.get_x(), patch.get_width()
        npt.assert_allclose((low, low + width), planned[bounds])
    npt.assert_array_equal(ratio.get_ydata(), planned.ratio)
    npt.assert_array_equal(best.get_ydata(), planned.optimum_ratio)
    one, *_ = plots.plan_precision(planned)
    npt.assert_array_equal(one.get_ydata(), planned.thickness_std)
    one, *_ = plots.plan_precision(planned, relative=True)
    npt.assert_allclose(one.get_ydata(), 100 * planned.thickness_std / planned.thickness)
    for number, line in enumerate(plots.plan_signal(planned), start=1):
        npt.assert_allclose(line.get_ydata(), planned.signal.sel(camera=number) / 1e3)

    several = planned.assign_attrs(frames=4, average=8)
    labels = [line.get_label() for line in plots.plan_precision(several)]
    assert labels[1] == "8 × 8 pixels, 4 frames"
