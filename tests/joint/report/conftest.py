"""A reader of pages."""

import pytest
from scenes.page import Page


@pytest.fixture
def read_page():
    """Read a page."""
    return Page
