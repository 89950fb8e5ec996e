"""The table of refusals of files."""

from erlif.core.errors import FrameError
from erlif.io.refusals import refusal


def test_a_refusal_names_what_was_expected():
    error = refusal("outside", directory="run", what="a.tif leads out of it")
    assert type(error) is FrameError
    assert str(error) == (
        "Expected the files of run within it; a.tif leads out of it. Copy them there, or use "
        "--allow-outside."
    )
