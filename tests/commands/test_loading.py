"""Imports without the garbage collector."""

import gc

import pytest

from erlif.commands.loading import large_imports


def test_the_collector_is_off_inside_and_on_afterwards():
    with large_imports():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_the_collector_returns_after_a_failed_import():
    with pytest.raises(ImportError), large_imports():
        raise ImportError
    assert gc.isenabled()


def test_a_collector_that_was_off_stays_off():
    gc.disable()
    try:
        with large_imports():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
