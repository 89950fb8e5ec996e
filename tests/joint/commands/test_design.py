"""``erlif design``."""

from erlif.joint.report import design_page


def test_the_example_works_as_it_is_printed(tmp_path, command, refused, monkeypatch):
    monkeypatch.setattr(design_page, "_figures", lambda design: [])  # they take a second
    path, page = tmp_path / "joint.toml", tmp_path / "joint.html"
    path.write_text(command("design", "--example").stdout, encoding="utf-8")
    shown = command("design", path, "-o", page).stdout
    assert "All limits that are checked hold; not checked: fatigue" in shown
    assert "margin of +0.42 %" in shown  # a number keeps its per cent
    assert f"written: {page}" in shown
    assert "exists already" in refused("design", path, "-o", page)
    table = tmp_path / "joint.csv"
    command("design", path, "-o", table)
    assert table.read_text(encoding="utf-8").splitlines()[1].startswith("pin_shear,")
    assert "a name in .html or .csv" in refused("design", path, "-o", path.with_suffix(".pdf"))


def test_without_a_joint_the_example_is_named(command):
    assert "erlif design --example > joint.toml" in command("design", status=2).stderr


def test_the_table_of_materials_is_printed(command):
    assert "aluminium bronze, Strand (2005)" in command("design", "--materials").stdout
