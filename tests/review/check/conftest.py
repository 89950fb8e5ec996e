"""The small rig's run, registered once."""

import pytest

from erlif.review.check.cameras import survey_cameras


@pytest.fixture(scope="session")
def surveyed(run):
    """Registration and ratios of the run; never to be changed."""
    return survey_cameras(run)
