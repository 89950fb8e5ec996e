"""Exit status as the contract and the shell have it."""

import signal

from erlif.commands.status import BAD_INPUT, DEFECT, INTERRUPTED


def test_bad_input_and_wrong_usage_have_the_status_of_click():
    import click

    assert click.UsageError.exit_code == BAD_INPUT


def test_a_defect_differs_from_bad_input_and_from_success():
    assert len({0, BAD_INPUT, DEFECT}) == 3


def test_an_interruption_has_the_status_of_the_shell():
    assert 128 + signal.SIGINT == INTERRUPTED
