"""Errors and warnings: what a caller can catch, and with which class."""

from erlif.core import errors


def test_a_foreign_reason_is_one_line_that_can_be_read():
    assert errors.reason_of(ValueError("no float: 'x'.\nat 0x10")) == "no float: 'x'"
    assert len(errors.reason_of(ValueError("x" * 70_000))) == 200
    assert errors.reason_of(MemoryError()) == "MemoryError"
