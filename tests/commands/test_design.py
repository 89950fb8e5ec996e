"""``erlif design``."""

import pytest
from click.testing import CliRunner

from erlif.commands.main import main
from erlif.joint.sizing.design import example_joint_file
from erlif.show.report import design_page


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "joint.toml"
    path.write_text(example_joint_file(), encoding="utf-8")
    return path


def run(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


def test_the_example_works_as_it_is_printed(tmp_path):
    path = tmp_path / "joint.toml"
    path.write_text(run("design", "--example").stdout, encoding="utf-8")
    result = run("design", path)
    assert result.exit_code == 0, result.output
    assert "All limits hold" in result.stdout


def test_without_a_joint_the_example_is_named():
    result = run("design")
    assert result.exit_code == 2
    assert "erlif design --example > joint.toml" in result.stderr


def test_the_table_of_materials_is_printed():
    result = run("design", "--materials")
    assert result.exit_code == 0
    assert "aluminium bronze, Strand (2005)" in result.stdout


def test_the_page_is_written_where_it_is_wanted(path, monkeypatch):
    monkeypatch.setattr(design_page, "_figures", lambda design: [])  # they take a second
    page = path.with_suffix(".html")
    result = run("design", path, "-o", page)
    assert result.exit_code == 0, result.output
    assert f"written: {page}" in result.stdout
    assert "exists already" in run("design", path, "-o", page).stderr
    assert run("design", path, "-o", path.with_suffix(".pdf")).exit_code == 2
