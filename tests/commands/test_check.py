"""``erlif check``."""

import json


def test_strict_ends_with_status_1_where_there_are_warnings(lab, command):
    lab.edit("run/run.toml", ('calibration = "../fixture/calibration.nc"\n', ""))
    command("check", lab.run)
    shown = command("check", "--strict", lab.run, status=1).stdout
    assert "process will need --calibration" in shown


def test_json_holds_the_findings(lab, command):
    record = json.loads(command("check", "--json", lab.run).stdout)
    assert (record["name"], record["errors"]) == ("virtual straight bushing", 0)
    assert {"level", "subject", "text"} == set(record["notes"][0])


def test_the_next_command_has_the_same_options(lab, command):
    lab.frames(1)[3].unlink()
    result = command("check", lab.run, "--skip-bad-frames", "--allow-outside")
    assert result.stderr.splitlines()[-1] == (
        f"next: erlif process {lab.run} --skip-bad-frames --allow-outside"
    )


def test_html_writes_a_page_and_leaves_the_findings_as_they_are(lab, command):
    page = lab.directory / "check.html"
    plain = command("check", lab.run).stdout
    result = command("check", lab.run, "-o", page)
    assert result.stdout == plain
    assert result.stderr.startswith(f"written: {page}\n")
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
