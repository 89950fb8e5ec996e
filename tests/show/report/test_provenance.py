"""Provenance: settings, hashes of all inputs, and notes as they stand in the film."""

from __future__ import annotations

import json

from erlif.show.report.provenance import notes_list, provenance_section


def test_settings_and_hashes_are_on_the_page(page):
    assert "[mechanism]" in page.texts["provenance"]
    assert "ab" * 32 in page.texts["provenance"]
    assert "made by formula" in page.texts["provenance"]


def test_inputs_of_the_calibration_are_listed_apart(film):
    kept = json.loads(film.attrs["calibration"]) | {"input_hashes": {"profile.csv": "cd" * 32}}
    section = provenance_section(film.assign_attrs(calibration=json.dumps(kept)))
    run, calibration = section.split("Inputs of the calibration")
    assert "ab" * 32 in run
    assert "cd" * 32 in calibration
    assert "Inputs of the calibration" not in provenance_section(film)


def test_notes_are_listed_once_and_escaped(film):
    assert notes_list(film) == "<h3>Notes</h3><ul><li>gain &lt; measured</li></ul>"
    twice = film.assign_attrs(notes="one\ntwo\none")
    assert notes_list(twice).count("<li>") == 2
    assert notes_list(film.assign_attrs(notes="")) == ""


def test_warnings_are_emphasised(film):
    text = notes_list(film.assign_attrs(notes="warning: camera2: no <flat>\ncamera1: dark"))
    assert "<li><strong>Warning: </strong>camera2: no &lt;flat&gt;</li>" in text
    assert "<li>camera1: dark</li>" in text
