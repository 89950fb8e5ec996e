"""Which findings of a run enter its error bars."""

import numpy as np
import pytest
from scenes.fixture import with_systematics

from erlif.io.settings import LightOptions
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.physics.gap import with_errors
from erlif.pipeline.physics.reference import PatchScale
from erlif.show.plots import example_calibration
from erlif.trend import CourseChange, ErrorEstimate, Trend

CALIBRATION = with_systematics(example_calibration(), ratio=0.01)
COURSE = CourseChange(frame=None, size=0.01, std=0.001, significance=9.0)


def estimate(change):
    """A ratio that is off by so much, known to a tenth of its width of 1 %."""
    prior = CALIBRATION.full_covariance
    value = np.zeros(len(prior))
    value[-1] = change
    after = {"covariance": 1e-2 * prior, "scatter": 1e-4 * prior}
    return ErrorEstimate(value=value, **after, prior=prior, noise=1.0, film=5.0)


@pytest.mark.parametrize(("change", "counts"), [(0.015, False), (0.025, True), (-0.025, True)])
def test_a_shift_counts_from_two_widths_on_and_contains_the_course(change, counts):
    findings = LightFindings(errors=estimate(change), course=COURSE)
    found = findings.for_error_bars(CALIBRATION, LightOptions())
    assert (found.errors is not None) is counts
    assert (found.course is None) is counts


def test_a_shift_that_is_taken_out_counts_whatever_its_size():
    findings = LightFindings(errors=estimate(0.001), course=COURSE, taken_out=True)
    taken_out = with_errors(CALIBRATION, findings.errors, corrected=True)
    found = findings.for_error_bars(taken_out, LightOptions())
    assert found.errors is findings.errors
    assert found.course is None


@pytest.mark.parametrize("known", [True, False])
def test_a_patch_that_sets_the_ratio_holds_the_bleaching(known):
    """A patch without a valid pixel sets nothing."""
    trends = [Trend(-1e-4, 1e-5, np.nan, np.nan), Trend(-2e-4, 1e-5, np.nan, np.nan)]
    scale = (
        PatchScale(course=np.zeros(2), covariance=np.eye(2), film=5.0, film_std=0.0)
        if known
        else None
    )
    before = LightFindings(bleaching=trends[0], scale=scale)
    after = LightFindings(bleaching=trends[1], course=COURSE)
    found = before.complete(after, LightOptions(ratio="correct"))
    assert found.bleaching is trends[0 if known else 1]
    assert found.course is COURSE
