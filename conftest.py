"""Settings of all tests and examples."""

from __future__ import annotations

import gc
import sys

import pytest


def pytest_configure() -> None:
    """Modules and tests are made to stay: the collector would look through them again and again."""
    gc.disable()


def pytest_collection_finish() -> None:
    """What is collected is left out of the garbage collections of the tests."""
    gc.freeze()
    gc.enable()


@pytest.fixture(autouse=True)
def _close_figures():
    """Close the figures that a test or an example has left to pyplot."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
