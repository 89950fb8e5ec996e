"""``erlif figures``."""

import os
import subprocess
import sys


def test_chosen_figures_are_written(command, own, tmp_path):
    out = tmp_path / "chosen"
    options = ["--only", "film_over_cycle,thickness_map", "--format", "svg", "--crank-angle"]
    result = command("figures", own, "-o", out, *options, "300 deg")
    names = ["thickness_map.svg", "film_over_cycle.svg"]
    described, written = result.stdout.splitlines()
    assert described.startswith("trigger 1, crank 304.22°")
    assert written == f"written: {', '.join(str(out / name) for name in names)}"
    assert "figures: 2 done" in result.stderr


def test_the_backend_of_the_environment_is_not_used(own, tmp_path):
    figures = [sys.executable, "-m", "erlif", "figures", own, "-o", tmp_path / "chosen"]
    subprocess.run(
        [*figures, "--only", "film_over_cycle"],
        env={**os.environ, "MPLBACKEND": "nonsense", "MPLCONFIGDIR": "/dev/null/none"},
        check=True,
    )
    assert list((tmp_path / "chosen").glob("film_over_cycle.*"))
