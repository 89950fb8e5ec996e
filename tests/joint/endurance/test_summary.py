"""Sentences and table of endurance tests."""

import csv
from dataclasses import replace

from erlif.core.notes import Level, Note
from erlif.joint.endurance import describe_test, describe_tests, write_test_table
from erlif.joint.plots.example import example_test


def text_of(result, **changes):
    return "\n".join(describe_test(replace(result, **changes)))


def test_a_failure_is_described_with_its_interval_and_a_survivor_with_its_load():
    text = text_of(example_test())
    for part in ("6 stages and 6 idle runs", "galling in stage 6", "±", "0.5 % of the load"):
        assert part in text
    failure = example_test().failure
    between = f"between {failure.survived / 1e3:.1f} and {failure.load / 1e3:.1f} kN"
    assert between in text
    assert text.count("p below 1e-12") == 3  # of friction and both sensors: one form
    result = example_test(galls=False)
    text = text_of(result, search=replace(result.search, left_out=(5,)))
    for part in ("no galling found", "load survived: 123", "stage 6 has 150 samples and was not"):
        assert part in text


def test_table_has_a_row_for_each_test(tmp_path):
    found = [example_test(), example_test(galls=False)]
    path = write_test_table(found, tmp_path / "endurance.csv")
    first, second = csv.DictReader(path.read_text(encoding="utf-8").splitlines())
    assert first["failed"] == "1"
    assert float(first["onset [s]"]) == round(found[0].onset.time, 2)
    assert (second["failed"], second["onset [s]"]) == ("0", "")
    values = [float(first[name]) for name in first if name.startswith("p-value")]
    assert min(values) == 1e-12
    assert write_test_table([], path).read_text(encoding="utf-8") == ",".join(first) + "\n"


def test_a_significant_rise_that_is_too_small_is_stated_with_its_option():
    result = example_test()
    small = replace(result.onset, rise=0.0123, rise_std=0.001)
    search = replace(result.search, onset=None, small=small, p_value=1e-9)
    text = text_of(result, search=search)
    assert "no galling found: in stage 6 friction rises" in text
    assert "by 0.012 ± 0.001, which is significant (p = 1e-09)" in text
    assert "--least-rise 0.01" in text


def test_pauses_of_the_log_and_stuck_sensors_are_stated():
    result = example_test()
    *others, last = result.stages
    parts = (replace(last, end=last.start + 100), replace(last, start=last.start + 300, part=2))
    onset = replace(result.onset, pause=(last.start + 100, last.start + 300))
    text = text_of(
        result,
        stages=(*others, *parts),
        search=replace(result.search, onset=onset),
        unusable={"vibration": "reads 0.4 throughout"},
    )
    for part in (
        "6 stages",
        "stage 6, part 2",
        f"pauses from {parts[0].end:.0f} to {parts[1].start:.0f} s, within stage 6",
        "an interval with a pause of the log; p",
        "vibration reads 0.4 throughout",
    ):
        assert part in text


def test_several_tests_have_a_row_each_and_their_warnings():
    result = example_test()
    doubtful = replace(result, name="odd", notes=(Note(Level.WARNING, "", "a doubt"),))
    whole = replace(example_test(galls=False), name="whole")
    lines = describe_tests([result, doubtful, whole])
    assert len(lines) == 6
    onset = result.onset
    assert f"({onset.earliest:.1f} to {onset.latest:.1f})" in lines[1]
    assert lines[3].split() == ["whole", "none", "-", "-", "123.1", "kN"]
    assert "between the load survived and that at failure" in lines[4]
    assert lines[5] == "warning: odd: a doubt"
    assert max(map(len, [*lines[:4], lines[5]])) <= 80
