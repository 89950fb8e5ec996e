"""Earlier settings: what stays on the rig and what does not."""

import pytest

from erlif.core.errors import ConfigError
from erlif.review.earlier import read_earlier


def test_values_of_the_rig_are_kept_and_those_of_a_run_are_apart(lab):
    earlier = read_earlier(lab.run, fixture=False)
    assert earlier.kind == "crank-rocker"
    assert earlier.of_run["mechanism.crank_speed"] == "114 rpm"
    assert earlier.kept["mechanism.crank"] == "5.5 cm"
    assert not earlier.kept.keys() & earlier.of_run.keys()


def test_names_of_files_and_what_follows_from_them_are_left_out(lab):
    earlier = read_earlier(lab.run, fixture=False)
    files = {"calibration", "camera1.files", "encoder.file", "encoder.triggers_per_cycle"}
    assert not files & {*earlier.kept, *earlier.of_run}
    fixture = read_earlier(lab.fixture, fixture=True)
    assert "fixture.origin" in fixture.of_run
    assert "fixture.profile" not in fixture.kept


def test_settings_that_cannot_be_read_are_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"Expected run\.toml"):
        read_earlier(tmp_path, fixture=False)
