"""Work that waits for the import of another package."""

import sys

import pytest

from erlif.core.speed.later import after_import


def test_work_for_a_package_that_is_there_is_done_at_once():
    done = []
    after_import("pytest", lambda: done.append(True))
    assert done == [True]
    assert pytest is sys.modules["pytest"]


def test_work_waits_for_the_import_and_is_done_once(tmp_path, monkeypatch):
    (tmp_path / "late_package.py").write_text("VALUE = 3\n")
    monkeypatch.syspath_prepend(tmp_path)
    done, before = [], list(sys.meta_path)
    after_import("late_package", lambda: done.append(sys.modules["late_package"].VALUE))
    assert not done
    import late_package

    assert late_package.VALUE == 3
    assert done == [3]
    assert sys.meta_path == before
