"""Stages in the log."""

import logging

import pytest

from erlif.core.timing import stage


def test_a_stage_is_logged_with_its_duration(caplog, monkeypatch):
    times = iter([10.0, 12.5])
    monkeypatch.setattr("erlif.core.timing.time.perf_counter", lambda: next(times))
    with caplog.at_level(logging.INFO, logger="erlif"), stage("registration"):
        pass
    assert caplog.messages == ["registration: started", "registration: finished after 2.50 s"]


def test_a_stage_that_fails_is_logged_as_stopped(caplog):
    def fail():
        with stage("registration"):
            raise ValueError("no texture")

    with caplog.at_level(logging.INFO, logger="erlif"), pytest.raises(ValueError, match="texture"):
        fail()
    assert "registration: stopped after" in caplog.messages[-1]


def test_a_stage_is_logged_under_the_logger_of_its_module(caplog):
    logger = logging.getLogger("erlif.pipeline.run")
    with caplog.at_level(logging.INFO, logger="erlif"), stage("film", logger):
        pass
    assert {record.name for record in caplog.records} == {"erlif.pipeline.run"}
