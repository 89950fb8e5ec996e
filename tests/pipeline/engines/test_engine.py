"""Threads compute items at the same time and give their results in order."""

import threading

import cv2
import pytest

from erlif.pipeline.engines.engine import Threads


@pytest.mark.parametrize("workers", [1, 3, None])
def test_results_are_collected_in_the_order_of_the_items(workers):
    found = []
    Threads(workers).compute(
        lambda item: item * 10, range(50), lambda *result: found.append(result)
    )
    assert found == [(item, item * 10) for item in range(50)]


def test_items_are_computed_at_the_same_time():
    """Neither of the two would pass the barrier by itself."""
    meeting = threading.Barrier(2, timeout=30)
    found = []
    Threads(2).compute(lambda item: meeting.wait(), [0, 1], lambda *result: found.append(result))
    assert len(found) == 2


def test_few_results_wait_for_their_collection():
    """The first item is slow: the others wait for it, as many as `_AHEAD` allows."""
    released, begun, most = threading.Event(), [], []

    def work(item):
        begun.append(item)
        if item == 0:
            released.wait(30)

    timer = threading.Timer(0.5, lambda: (most.append(len(begun)), released.set()))
    timer.start()
    Threads(2).compute(work, range(200), lambda *result: None)
    assert len(begun) == 200
    assert most[0] <= 4


def test_items_after_a_fault_of_work_or_collection_are_not_begun():
    begun = []

    def fail(item):
        begun.append(item)
        raise ValueError("a fault")

    def refuse(item, result):
        raise KeyboardInterrupt

    with pytest.raises(ValueError, match="a fault"):
        Threads(1).compute(fail, range(50), lambda *result: None)
    assert len(begun) < 50
    begun.clear()
    with pytest.raises(KeyboardInterrupt):
        Threads(1).compute(begun.append, range(50), refuse)
    assert len(begun) < 50


def test_image_library_has_one_thread_during_the_work_and_its_own_number_after_it():
    before, during = cv2.getNumThreads(), []
    Threads(2).compute(lambda item: during.append(cv2.getNumThreads()), [0], lambda *result: None)
    assert during == [1]
    assert cv2.getNumThreads() == before
