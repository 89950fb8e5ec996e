"""Folders below the start directory, and none beyond."""

from pathlib import Path

import pytest

from erlif.core.errors import ErlifError
from erlif.show.start.folders import inside, list_folder, suggest

HOSTILE = '<img src=x onerror="alert(1)">'


@pytest.fixture
def root(tmp_path):
    root = tmp_path.resolve() / "root"
    for name in ("run 7", "Keil", HOSTILE, ".hidden", "run 7/camera1"):
        (root / name).mkdir(parents=True)
    (root / "run 7" / "run.toml").touch()
    (tmp_path / "beyond").mkdir()
    (root / "link").symlink_to(tmp_path / "beyond")
    (root / "own").symlink_to(root / "Keil")
    (root / "circle").symlink_to(root / "circle")
    return root


def test_folders_are_listed_without_hidden_ones_and_links_that_lead_out(root):
    assert list_folder(root, "")["folders"] == [HOSTILE, "Keil", "own", "run 7"]
    found = list_folder(root, "run 7")
    assert found == {"name": "run 7", "folders": ["camera1"], "files": 1, "settings": ["run.toml"]}
    assert list_folder(root, HOSTILE)["folders"] == []


@pytest.mark.parametrize(
    "name", ["..", "link", "circle", "/etc", "none", "run 7/run.toml", "a\0b", "x" * 999]
)
def test_nothing_beyond_is_opened(root, name):
    with pytest.raises(ErlifError, match="Expected a folder below"):
        inside(root, name)


def test_a_folder_that_may_not_be_read_is_named(root, monkeypatch):
    def refuse(path):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refuse)
    with pytest.raises(ErlifError, match=r"Keil may not \(Permission denied"):
        list_folder(root, "Keil")


def test_a_run_and_a_fixture_are_suggested_by_settings_and_names(root, tmp_path):
    assert suggest(root) == {"run": "run 7", "fixture": "Keil"}
    assert suggest(root / "run 7") == {"run": ""}
    assert suggest(tmp_path / "beyond") == {"run": ""}


@pytest.mark.parametrize(("name", "file"), [("wedge of May", "a.csv"), ("3 mm", "Profile.csv")])
def test_a_folder_that_is_the_fixture_itself_is_suggested_as_one(tmp_path, name, file):
    (tmp_path / name).mkdir()
    (tmp_path / name / file).touch()
    assert suggest((tmp_path / name).resolve()) == {"fixture": ""}
