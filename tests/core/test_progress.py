"""Progress of long computations."""

from erlif.core.progress import Progress, silent


def test_silent_progress_writes_nothing(capsys):
    report: Progress = silent
    for done in range(4):
        report("frames", done, 3)
    assert capsys.readouterr() == ("", "")
