"""Fixtures of the prediction."""

import pytest
from scenes.pin import follow_true_pin


@pytest.fixture(scope="package")
def free_pin():
    """Twelve moments of the cycle that follows 24 cycles under load; films of 6 um."""
    return follow_true_pin(12)
