"""Memory of images is used again only when nothing refers to it."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from erlif.pipeline.passes.buffers import empty_image

SHAPE = (37, 53)
"""Of no other test."""


def test_memory_is_used_again_when_the_image_is_gone():
    first = empty_image(SHAPE)
    address = first.ctypes.data
    del first
    assert empty_image(SHAPE).ctypes.data == address


def test_an_image_that_is_held_keeps_its_memory():
    held = empty_image(SHAPE)
    held.fill(3)
    for _ in range(3):
        empty_image(SHAPE).fill(7)
    assert (held == 3).all()


def test_an_image_of_which_a_part_is_held_keeps_its_memory():
    part = empty_image(SHAPE)[2:5, ::2]
    part[...] = 3
    empty_image(SHAPE).fill(7)
    assert (part == 3).all()


def test_type_and_shape_are_those_asked_for():
    wanted = [((4, 6), np.float32), ((4, 6), np.uint8), ((6, 4), np.float32), ((4, 6), np.float64)]
    for _ in range(2):
        found = [empty_image(shape, dtype) for shape, dtype in wanted]
        assert [(image.shape, image.dtype) for image in found] == [
            (shape, np.dtype(dtype)) for shape, dtype in wanted
        ]
        del found


def test_threads_do_not_share_memory():
    held = empty_image(SHAPE)
    address = held.ctypes.data
    del held
    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(lambda: empty_image(SHAPE)).result()
    assert other.ctypes.data != address
