"""``erlif linkage``: what it prints, what it writes, what it refuses."""

LINKS = ("--coupler", "44 cm", "--rocker", "260 mm", "--ground", "0.51 m")


def test_the_crank_of_the_thesis_for_26_degrees(command, tmp_path, monkeypatch):
    path = tmp_path / "linkage.png"

    def written(design, path, *, overwrite):  # tests/show/plots draws it
        path.write_text(f"{design.linkage.crank:.6f}", encoding="utf-8")
        return path

    monkeypatch.setattr("erlif.joint.plots.write_linkage", written)
    speeds = ("--rocker-speed", "24 rpm", "-o", path)
    result = command("linkage", *LINKS, "--swing", "26 deg", *speeds)
    assert "1 crank-rocker meets the targets." in result.stdout
    row = result.stdout.split("\n\n")[1].splitlines()[2].split()
    assert row[:6] == ["58.484", "440.000", "260.000", "510.000", "105.42", "26.000"]
    assert f"written: {path}" in result.stdout
    assert path.read_text(encoding="utf-8") == "0.058484"


def test_out_of_reach_is_reported_with_status_0(command):
    result = command("linkage", *LINKS, "--swing", "170 deg")
    assert "No crank-rocker meets the targets; nearest: swing 105.1240 degrees" in result.stdout


def test_bad_input_is_one_message(refused):
    message = refused("linkage", "-o", "linkage.txt", *LINKS)
    assert "a name in .png or .pdf or .svg or .gif" in message


def test_an_implausible_length_is_a_note(command):
    result = command("linkage", *LINKS, "--swing", "26 deg", "--width", "40 km")
    assert "note: link_width = 40000 m is implausible" in result.stderr
    assert "linkage.py" not in result.stderr
