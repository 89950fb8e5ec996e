"""The table of refusals of recordings and logs."""

from erlif.core.errors import FrameError
from erlif.io.ingest.refusals import refusal


def test_a_refusal_names_what_was_expected():
    error = refusal("outside", directory="run", what="a.tif leads out of it")
    assert type(error) is FrameError
    assert str(error) == (
        "Expected the files of run within it; a.tif leads out of it. Copy them there, or use "
        "--allow-outside."
    )
