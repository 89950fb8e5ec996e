"""The small rig's run, opened and registered once."""

import pytest

from erlif.audit.cameras import survey_cameras
from erlif.ingest import open_run


@pytest.fixture(scope="session")
def run(small_rig):
    return open_run(small_rig.run)


@pytest.fixture(scope="session")
def surveyed(run):
    """Registration and ratios of the run; never to be changed."""
    return survey_cameras(run)
