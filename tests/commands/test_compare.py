"""``erlif compare``: what it prints, what it writes, what it refuses."""

import numpy as np

from erlif.io.files import write_dataset
from erlif.show.plots import example_film, example_frames, example_registration, write_example


def write_other(path):
    """The example 0.5 um thicker."""
    film = example_film()
    changed = film.assign(thickness=film.thickness + np.float32(0.5), film_min=film.film_min + 0.5)
    groups = {"registration": example_registration(), "frames": example_frames()}
    write_dataset(changed, path, groups=groups)
    return path


def test_a_comparison_is_printed_and_written(tmp_path, command, refused):
    films = write_example(tmp_path / "a.nc"), write_other(tmp_path / "b.nc")
    shown = command("compare", *films, "--crank-angle", "112 deg")
    assert "conclusion: example (a.nc) and example (b.nc) differ in minimum film" in shown.stdout
    assert not (tmp_path / "out").exists()

    out = tmp_path / "out"
    command("compare", *films, "-o", out)
    names = {"compare.nc", "compare.csv", "compare.html", "films.png", "difference_map.png"}
    assert {path.name for path in out.iterdir()} == names
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    assert "use --overwrite" in refused("compare", *films, "-o", out)
    command("compare", *films, "-o", out, "--overwrite")
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_a_comparison_that_fails_leaves_the_earlier_one_whole(
    tmp_path, command, refused, monkeypatch
):
    films = write_example(tmp_path / "a.nc"), write_other(tmp_path / "b.nc")
    out = tmp_path / "out"
    command("compare", *films, "-o", out)
    (out / "control_patch.png").write_bytes((out / "films.png").read_bytes())
    (out / "notes.txt").write_text("of the user")
    before = {path.name: path.read_bytes() for path in out.iterdir()}

    def fail(*_):
        raise OSError(28, "No space left on device")

    thicker = write_other(tmp_path / "c.nc")
    with monkeypatch.context() as patch:
        patch.setattr("erlif.show.plots.write_comparison_figures", fail)
        refusal = refused("compare", films[1], thicker, "-o", out, "--overwrite")
    assert "No space left" in refusal
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before

    # of an earlier comparison nothing stays that is not of this one
    monkeypatch.setattr("erlif.show.plots.write_comparison_figures", lambda *_: [])
    command("compare", films[1], thicker, "-o", out, "--overwrite")
    assert "control_patch.png" not in {path.name for path in out.iterdir()}
    assert (out / "notes.txt").read_text() == "of the user"
    assert (out / "compare.csv").read_bytes() != before["compare.csv"]


def test_what_cannot_be_compared_is_refused_in_one_message(tmp_path, refused):
    film = write_example(tmp_path / "a.nc")
    assert f"{film} is named 2 times" in refused("compare", film, film)
    assert "two different films from 1 to 2" in refused(
        "compare", film, write_other(tmp_path / "b.nc"), "--pair", 1, 3
    )
