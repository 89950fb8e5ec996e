"""``erlif simulate``."""

from click.testing import CliRunner

from erlif.commands.main import main

SMALL = ["--size", "64x48", "--spacing", "8", "--fixture-frames", "1"]


def test_a_rehearsal_is_written_with_its_truth(tmp_path):
    result = CliRunner().invoke(main, ["simulate", str(tmp_path / "out"), *SMALL])
    assert result.exit_code == 0, result.output
    assert "run frames written: 6" in result.output
    assert (tmp_path / "out" / "truth.nc").is_file()


def test_a_picture_size_that_cannot_be_read_is_refused_with_an_example(tmp_path):
    result = CliRunner().invoke(main, ["simulate", str(tmp_path / "out"), "--size", "wide"])
    assert result.exit_code == 2
    assert "320x256" in result.output
