"""``erlif init``."""

from click.testing import CliRunner

from erlif.commands.main import main


def test_what_was_found_and_what_is_missing_is_printed(lab, command):
    (lab.run / "run.toml").unlink()
    lines = command("init", lab.run).stdout.splitlines()
    assert lines[0] == "note    camera1: 6 frames of 128 x 96 uint16, camera1/*.tif"
    assert f"written: {lab.run / 'run.toml'}" in lines
    assert "17 gaps are left, with their meaning in the file. Replace each ??:" in lines
    assert "  [mechanism] crank, coupler, rocker, ground, crank_speed" in lines
    verbose = command("init", lab.run, "--overwrite", "-v").stdout.splitlines()
    assert any(line.startswith("  [optics] pixel_pitch: length from") for line in verbose)
    assert lines[-1] == f"next: erlif check {lab.run}"


def test_the_file_is_short_and_has_the_meaning_of_every_gap(lab, command):
    command("init", lab.run, "--overwrite")
    short = (lab.run / "run.toml").read_text(encoding="utf-8").splitlines()
    command("init", lab.run, "--overwrite", "--full")
    full = (lab.run / "run.toml").read_text(encoding="utf-8").splitlines()
    assert 3 * len(short) < len(full)
    gaps = [k for k, line in enumerate(short) if '"??' in line and not line.startswith("#")]
    assert len(gaps) == 17
    assert all(short[k - 1].startswith("# ") for k in gaps)
    assert [short[k] for k in gaps] == [
        line for line in full if '"??' in line and not line.startswith("#")
    ]
    assert "# optional: clearance_std, load" in short


def test_the_kind_of_tribometer_is_asked_for_on_a_terminal(lab, monkeypatch):
    monkeypatch.setattr("erlif.commands.init.on_terminal", lambda: True)
    result = CliRunner().invoke(main, ["init", str(lab.run), "--overwrite"], input="rotation\n")
    assert "Tribometer (crank-rocker, slider-crank, rotation, sinusoidal, static)" in result.output
    assert 'kind = "rotation"' in (lab.run / "run.toml").read_text(encoding="utf-8")


def test_a_kind_is_written_without_asking(lab, command):
    command("init", lab.run, "--overwrite", "--kind", "static")
    text = (lab.run / "run.toml").read_text(encoding="utf-8")
    assert "[mechanism]" not in text
    assert 'file = "encoder.csv"' in text  # the log is there, and gives load and temperature
