"""``erlif check``."""

import json
import shutil

import pytest
from click.testing import CliRunner
from scenes.terminal import unwrapped

from erlif.commands.main import main


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda lab: shutil.rmtree(lab.run), "no such directory"),
        (lambda lab: lab.edit("run/run.toml", ('"580 nm"', '"560 nm"')), "560 and 610 nm"),
    ],
)
def test_check_ends_with_status_2_at_the_first_error(lab, change, expected):
    change(lab)
    result = CliRunner().invoke(main, ["check", str(lab.run)])
    assert result.exit_code == 2
    last = unwrapped(result.stdout).splitlines()[-1]
    assert last.startswith("error")
    assert expected in last
    assert "Traceback" not in result.output


def test_strict_ends_with_status_1_where_there_are_warnings(lab):
    lab.edit("run/run.toml", ('calibration = "../fixture/calibration.nc"\n', ""))
    assert CliRunner().invoke(main, ["check", str(lab.run)]).exit_code == 0
    result = CliRunner().invoke(main, ["check", "--strict", str(lab.run)])
    assert result.exit_code == 1
    assert "process will need --calibration" in result.stdout


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
