"""Sentences and table of endurance tests."""

import csv
from dataclasses import replace

from erlif.endurance import describe_test, write_test_table
from erlif.endurance.example import example_test


def test_a_failure_is_described_with_its_interval():
    text = "\n".join(describe_test(example_test()))
    assert "6 stages and 6 idle runs" in text
    assert "galling in stage 6" in text
    assert "±" in text


def test_a_survivor_has_no_onset():
    text = "\n".join(describe_test(example_test(galls=False)))
    assert "no galling found" in text
    assert "load survived: 123" in text


def test_table_has_a_row_for_each_test(tmp_path):
    found = [example_test(), example_test(galls=False)]
    path = write_test_table(found, tmp_path / "endurance.csv")
    first, second = csv.DictReader(path.read_text(encoding="utf-8").splitlines())
    assert first["failed"] == "1"
    assert float(first["onset [s]"]) == round(found[0].onset.time, 2)
    assert (second["failed"], second["onset [s]"]) == ("0", "")


def test_a_stage_that_is_too_short_for_a_search_is_named():
    result = example_test(galls=False)
    short = replace(result, search=replace(result.search, left_out=(5,)))
    assert "note: stage 6 has 150 samples and was not searched" in "\n".join(describe_test(short))
