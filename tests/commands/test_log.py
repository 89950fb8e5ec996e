"""Log lines on the terminal."""

import logging

import pytest

from erlif.commands.log import show_log


@pytest.fixture(autouse=True)
def _quiet_afterwards():
    yield
    show_log(0)


@pytest.mark.parametrize(
    ("verbosity", "shown"),
    [(0, {"w"}), (1, {"w", "i"}), (2, {"w", "i", "d"}), (5, {"w", "i", "d"})],
)
def test_each_v_shows_one_level_more(capsys, verbosity, shown):
    show_log(verbosity)
    logger = logging.getLogger("erlif.registration.estimate")
    logger.warning("w")
    logger.info("i")
    logger.debug("d")
    lines = capsys.readouterr().err.splitlines()
    assert {line.rpartition(": ")[2] for line in lines} == shown
    assert all((" s  registration.estimate: " in line) == (verbosity > 0) for line in lines)


def test_a_line_is_written_once_however_often_the_log_is_set_up(capsys):
    for _ in range(3):
        show_log(1)
    logging.getLogger("erlif.ratio").info("blur")
    assert capsys.readouterr().err.count("blur") == 1
