"""Known faults before the message of an error."""

import pytest

from erlif.core.errors import ClusterError, OutputError, RegistrationError
from erlif.core.notes import remark
from erlif.pipeline.audit.naming import naming


def test_a_known_fault_stands_before_the_error_that_follows_from_it():
    with pytest.raises(RegistrationError) as caught, naming((remark("bits", "stuck", "Check"),)):
        raise RegistrationError("No texture.")
    assert str(caught.value).startswith("bits: stuck. Check. It may be the cause of what follows. ")
    assert str(caught.value).endswith("No texture.")


def test_without_a_fault_an_error_is_as_it_was():
    with pytest.raises(RegistrationError, match=r"^No texture\.$"), naming(()):
        raise RegistrationError("No texture.")


@pytest.mark.parametrize("kind", [OutputError, ClusterError])
def test_a_full_disk_does_not_follow_from_a_fault_of_the_counts(kind):
    with (
        pytest.raises(kind, match=r"^No space left\.$"),
        naming((remark("bits", "stuck", "Check"),)),
    ):
        raise kind("No space left.")
