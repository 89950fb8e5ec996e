"""simulate: bytes of a seed, refusals, and a rig without code of the measurement."""

import ast
from dataclasses import replace
from pathlib import Path

import pytest
from scenes.rig import QUICK, digest

from erlif import rig
from erlif.core.errors import OutputError
from erlif.joint import rig as joint_rig
from erlif.rig import simulate


def test_the_same_seed_writes_the_same_bytes(tmp_path):
    rig = replace(QUICK, fixture_frames=2, dark_pages=2, flat_pages=2)
    first = digest(simulate(tmp_path / "first", seed=11, rig=rig))
    again = digest(simulate(tmp_path / "again", seed=11, rig=rig))
    other = digest(simulate(tmp_path / "other", seed=12, rig=rig))
    assert first == again
    assert set(first) == set(other)
    settings = {"run/run.toml", "fixture/fixture.toml"}
    assert all((first[name] == other[name]) == (name in settings) for name in first)


def test_existing_output_is_refused_and_kept(tmp_path, monkeypatch):
    rig = QUICK
    simulate(tmp_path, seed=1, rig=rig)
    (tmp_path / "notes.txt").write_text("mine")
    before = digest(tmp_path)
    with pytest.raises(OutputError, match="overwrite"):
        simulate(tmp_path, seed=2, rig=rig)

    def break_off(out, **_):
        (out / "run").mkdir()
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("erlif.rig.directory.write_rig", break_off)
        with pytest.raises(OutputError, match="No space left"):
            simulate(tmp_path, seed=2, rig=rig, overwrite=True)
    assert digest(tmp_path) == before
    simulate(tmp_path, seed=2, rig=rig, overwrite=True)
    after = digest(tmp_path)
    assert after["truth.nc"] != before["truth.nc"]
    assert after["notes.txt"] == before["notes.txt"]


def test_rig_shares_no_code_with_the_measurement():
    """A rig that used the code of the inversion could not find its mistakes."""
    for path in (*Path(rig.__file__).parent.glob("*.py"), Path(joint_rig.__file__)):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names:
                if name.split(".")[0] == "erlif":
                    allowed = name in (
                        "erlif.core.arrays",
                        "erlif.core.errors",
                        "erlif.core.progress",
                        "erlif.core.tables",
                    )  # types, exceptions, progress bars, the reader of TOML tables
                    assert allowed or name.startswith("erlif.rig"), f"{path.name} imports {name}"


def test_progress_counts_the_frames_of_both_sessions(tmp_path):
    calls = []
    simulate(tmp_path, rig=QUICK, progress=lambda *call: calls.append(call))
    assert calls[0] == ("fixture frame", 1, 1)
    assert calls[1:] == [("run frame", number, 6) for number in range(1, 7)]
