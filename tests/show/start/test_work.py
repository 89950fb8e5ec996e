"""Work in a thread: one at a time, cancelled at its next step, failures in sentences."""

from threading import Event

import pytest

from erlif.core.errors import ErlifError
from erlif.core.notes import Level, Note, remark
from erlif.show.start.work import Work


def test_one_piece_of_work_at_a_time_is_cancelled_at_its_next_step():
    begun, go = Event(), Event()

    def task(progress):
        progress("frames", 1, 9)
        begun.set()
        go.wait(10)
        progress("frames", 2, 9)
        return [remark("", "never")]

    work = Work()
    work.start("process", task)
    assert begun.wait(10)
    state = work.describe()
    assert (state["running"], state["step"], state["done"], state["total"]) == (
        *(True, "frames"),
        *(1, 9),
    )
    with pytest.raises(ErlifError, match="process is running"):
        work.start("check", task)
    work.cancel()
    go.set()
    work.wait()
    state = work.describe()
    assert not state["running"]
    assert state["failed"]
    assert [note["text"][:9] for note in state["notes"]] == ["Cancelled"]

    work.start("check", lambda progress: [remark("frames", "3")])  # not cancelled any more
    work.wait()
    assert work.describe()["notes"] == [{"level": "note", "text": "frames: 3"}]


def test_a_refusal_a_finding_and_a_defect_are_failures(caplog):
    def refuse(progress):
        raise ErlifError("Expected frames; there are none.")

    def fail(progress):
        raise RuntimeError("off by one")

    for task, text in (
        (refuse, "Expected frames"),
        (lambda progress: [Note(Level.ERROR, "log", "short")], "log: short"),
        (fail, "this is a defect of erlif, RuntimeError"),
    ):
        work = Work()
        work.start("check", task)
        work.wait()
        assert work.describe()["failed"]
        assert work.describe()["notes"][0]["text"].startswith(text)
    assert len(caplog.records) == 1
