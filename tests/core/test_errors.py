"""Errors and warnings: what a caller can catch, and with which class."""

from erlif.core import errors


def test_a_foreign_reason_is_one_line_that_can_be_read():
    assert errors.reason_of(ValueError("no float: 'x'.\nat 0x10")) == "no float: 'x'"
    assert len(errors.reason_of(ValueError("x" * 70_000))) == 200
    assert errors.reason_of(MemoryError()) == "MemoryError"
    missing = OSError("group not found: frames", KeyError("frames"))  # as h5netcdf raises it
    assert errors.reason_of(missing) == "its part frames is missing"


def test_a_message_quotes_the_start_of_an_input_without_end():
    faults = "\n".join(["Correct these:", *(f"  key {k}: ..." for k in range(2000))])
    assert str(errors.ConfigError(faults)) == faults
    text = str(errors.ConfigError(f"Correct this:\n  crank: got '{'1' * 1_000_000}'"))
    assert len(text) < 2000
    assert text.startswith("Correct this:\n  crank: got '111")
    assert text.endswith("111'")
