"""``erlif init``."""


def test_what_was_found_and_what_is_missing_is_printed(lab, command):
    (lab.run / "run.toml").unlink()
    lines = command("init", lab.run).stdout.splitlines()
    assert lines[0] == "note    camera1: 6 frames of 128 x 96 uint16, camera1/*.tif"
    assert f"written: {lab.run / 'run.toml'}" in lines
    assert any(line.startswith("  [optics] pixel_pitch: ") for line in lines)
    assert lines[-1] == f"Then run: erlif check {lab.run}"


def test_the_settings_of_a_fixture_are_written_on_request(lab, command):
    (lab.fixture / "fixture.toml").unlink()
    command("init", lab.fixture, "--fixture")
    assert (lab.fixture / "fixture.toml").is_file()
    assert not (lab.fixture / "run.toml").exists()


def test_existing_settings_are_not_replaced_without_overwrite(lab, refused, command):
    assert "--overwrite" in refused("init", lab.run)
    command("init", lab.run, "--overwrite")
