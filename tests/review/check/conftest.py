"""The small rig's run, opened and registered once."""

import pytest

from erlif.io.ingest import open_run
from erlif.review.check.cameras import survey_cameras


@pytest.fixture(scope="session")
def run(small_rig):
    return open_run(small_rig.run)


@pytest.fixture(scope="session")
def surveyed(run):
    """Registration and ratios of the run; never to be changed."""
    return survey_cameras(run)
