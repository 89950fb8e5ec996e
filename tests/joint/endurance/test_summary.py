"""Sentences and table of endurance tests."""

import csv
from dataclasses import replace

from erlif.joint.endurance import describe_test, write_test_table
from erlif.show.plots.example import example_test


def test_a_failure_is_described_with_its_interval():
    text = "\n".join(describe_test(example_test()))
    assert "6 stages and 6 idle runs" in text
    assert "galling in stage 6" in text
    assert "±" in text
    assert "kN is the calibration of the cells, 0.5 % of the load (load_error" in text


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


def test_a_significant_rise_that_is_too_small_is_stated_with_its_option():
    result = example_test()
    small = replace(result.onset, rise=0.0123, rise_std=0.001)
    search = replace(result.search, onset=None, small=small, p_value=1e-9)
    text = "\n".join(describe_test(replace(result, search=search)))
    assert "no galling found: in stage 6 friction rises" in text
    assert (
        "by 0.012 ± 0.001, which is significant (p = 1e-09), but below the least rise of 0.02"
        in text
    )
    assert "--least-rise 0.01" in text


def test_pauses_of_the_log_and_stuck_sensors_are_stated():
    result = example_test()
    *others, last = result.stages
    parts = (replace(last, end=last.start + 100), replace(last, start=last.start + 300, part=2))
    onset = replace(result.onset, pause=(last.start + 100, last.start + 300))
    divided = replace(
        result,
        stages=(*others, *parts),
        search=replace(result.search, onset=onset),
        unusable={"vibration": "reads 0.4 throughout"},
    )
    text = "\n".join(describe_test(divided))
    assert "6 stages" in text
    assert "stage 6, part 2" in text
    assert f"pauses from {parts[0].end:.0f} to {parts[1].start:.0f} s, within stage 6" in text
    assert "an interval with a pause of the log; p" in text
    assert "note: the vibration reads 0.4 throughout; it is left out" in text


def test_a_friction_that_no_bearing_has_is_doubted_with_the_lengths_it_comes_from():
    """An arm of 30 m for 30 cm, and a radius of 40 cm for an arm of 30 cm."""
    result = example_test()
    assert "warning" not in "\n".join(describe_test(result))
    test = result.test.assign(friction=100 * result.test.friction).assign_attrs(arm=30.0)
    text = "\n".join(describe_test(replace(result, test=test)))
    assert "warning: a friction coefficient of 1" in text
    assert "the arm of 30 m, and the unit of the load" in text
    wide = result.test.assign_attrs(pin_radius=0.4)
    text = "\n".join(describe_test(replace(result, test=wide)))
    assert "warning: the arm of 0.3 m is no longer than the radius of 0.4 m" in text
