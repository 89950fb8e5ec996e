"""A calibration as text and as a card of a notebook."""

from dataclasses import replace

from erlif.core.notes import Level, Note
from erlif.show.plots import example_calibration


def test_a_calibration_shows_its_parameters_with_their_errors():
    calibration = replace(
        example_calibration(),
        fixture="<script>",
        notes=(Note(Level.WARNING, "profile", "<b>too short"),),
    )
    text, page = repr(calibration), calibration._repr_html_()
    for shown in ("0.66000 ± 0.00100", "0.24500 ± 0.00100 1/um", "0.30 to 16.00 um", "580 nm"):
        assert shown in text
        assert shown in page
    assert "warning: profile: <b>too short" in text
    assert page.count("<circle") == 20
    assert "<script" not in page
    assert "<b>" not in page
