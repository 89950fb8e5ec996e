"""Errors and warnings: what a caller can catch, and with which class."""

import inspect

import pytest

from erlif.core import errors

CLASSES = [c for _, c in inspect.getmembers(errors, inspect.isclass)]
ERRORS = [c for c in CLASSES if not issubclass(c, Warning)]


@pytest.mark.parametrize("error", ERRORS, ids=lambda c: c.__name__)
def test_one_class_catches_every_error(error):
    with pytest.raises(errors.ErlifError, match="as written"):
        raise error("as written")


def test_a_foreign_reason_is_one_line_that_can_be_read():
    assert errors.reason_of(ValueError("no float: 'x'.\nat 0x10")) == "no float: 'x'"
    assert len(errors.reason_of(ValueError("x" * 70_000))) == 200
    assert errors.reason_of(MemoryError()) == "MemoryError"
