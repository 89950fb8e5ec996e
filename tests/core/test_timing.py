"""Stages in the log."""

import logging
import sys

import numpy as np
import pytest

from erlif.core.timing import peak_memory, stage


@pytest.fixture
def clocks(monkeypatch):
    """A stage of 2.5 s on the wall and 4 s of the processors, by clocks that are set."""
    wall, processor = iter([10.0, 12.5]), iter([3.0, 7.0])
    monkeypatch.setattr("erlif.core.timing.time.perf_counter", lambda: next(wall))
    monkeypatch.setattr("erlif.core.timing.time.process_time", lambda: next(processor))


@pytest.mark.usefixtures("clocks")
@pytest.mark.parametrize(
    ("peak", "words"), [(300_000_000, ", peak memory 300 MB"), (None, "")], ids=["counted", "not"]
)
def test_a_stage_is_logged_with_its_duration_work_and_memory(caplog, monkeypatch, peak, words):
    monkeypatch.setattr("erlif.core.timing.peak_memory", lambda: peak)
    with caplog.at_level(logging.INFO, logger="erlif"), stage("registration"):
        pass
    finished = f"registration: finished after 2.50 s, processor 4.00 s{words}"
    assert caplog.messages == ["registration: started", finished]


def test_a_stage_that_fails_is_logged_as_stopped(caplog):
    def fail():
        with stage("registration"):
            raise ValueError("no texture")

    with caplog.at_level(logging.INFO, logger="erlif"), pytest.raises(ValueError, match="texture"):
        fail()
    assert "registration: stopped after" in caplog.messages[-1]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows does not count it this way")
def test_peak_memory_holds_an_array_that_was_freed_again():
    block = np.ones(20_000_000)  # every page is touched
    del block
    held = peak_memory()
    assert held is not None
    assert 160e6 < held < 1e12


def test_peak_memory_is_missing_where_the_system_has_no_such_count(monkeypatch):
    monkeypatch.setitem(sys.modules, "resource", None)
    assert peak_memory() is None
