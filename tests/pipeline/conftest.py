"""The small rig's run, prepared once."""

import pytest

from erlif.core.progress import silent
from erlif.io.ingest import open_run
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.recording.prepare import prepare_chain


@pytest.fixture(scope="session")
def prepared(run):
    """Chain and notes of the run; never to be changed."""
    return prepare_chain(run, silent)


@pytest.fixture(scope="session")
def truth(small_rig):
    """Film, displacement and all other inputs of the rig."""
    return small_rig.truth


@pytest.fixture(scope="session")
def cycles(two_cycles):
    """A run of two cycles and its motion."""
    run = open_run(two_cycles.run)
    return run, locate_run(run)
