"""MATLAB 5 files as scipy writes them, and damaged ones."""

import io
import random
import zlib

import numpy as np
import pytest
from scipy.io import loadmat, savemat

from erlif.io.ingest.logs.matlab import read_matlab


def saved(variables, **options):
    file = io.BytesIO()
    savemat(file, variables, **options)
    return file.getvalue()


RNG = np.random.default_rng(4)
VARIABLES = {
    "angle": RNG.normal(size=(7, 1)),
    "n": np.arange(5, dtype=np.uint8)[None],
    "k": np.array([[-3, 2**31 - 1]], np.int32),
    "m": RNG.normal(size=(4, 3)).astype(np.float32),
    "one": np.array([[2.5]]),
    "text": "abc",
    "cells": np.array([[1.0, "x"]], object),
    "z": np.array([[1 + 2j]]),
}


@pytest.mark.parametrize("compressed", [False, True])
def test_numbers_are_those_that_scipy_reads(compressed):
    content = saved(VARIABLES, do_compression=compressed)
    found = dict(read_matlab(content, largest=10_000))
    expected = loadmat(io.BytesIO(content))
    assert set(found) == {"angle", "n", "k", "m", "one"}
    for name, values in found.items():
        np.testing.assert_array_equal(values, expected[name])


def test_fields_of_structures_have_their_path():
    content = saved({"log": {"angle": [1.0, 2.0], "inner": {"load": [3.0, 4.0]}, "a": "x"}})
    found = {name: values.ravel().tolist() for name, values in read_matlab(content, largest=1000)}
    assert found == {"log/angle": [1, 2], "log/inner/load": [3, 4]}


def test_a_variable_that_expands_too_far_is_refused():
    content = saved({"angle": np.zeros(100_000)}, do_compression=True)
    assert len(content) < 2000
    with pytest.raises(ValueError, match="cut short or too large"):
        list(read_matlab(content, largest=50_000))


@pytest.mark.parametrize("compressed", [False, True])
def test_damaged_files_raise_no_other_error(compressed):
    """A thousand files; the reader of scipy ends the process on some of them."""
    content = saved({k: VARIABLES[k] for k in ("angle", "n", "m")}, do_compression=compressed)
    content += saved({"log": {"a": [1.0, 2.0]}})[128:]
    rng = random.Random(8)
    for _ in range(1000):
        damaged = bytearray(content)
        for _ in range(rng.randint(1, 5)):
            damaged[rng.randrange(126, len(damaged))] = rng.choice([0, 255, rng.randrange(256)])
        if rng.random() < 0.3:
            del damaged[rng.randrange(len(damaged)) :]
        try:
            for _, values in read_matlab(bytes(damaged), largest=10_000):
                assert values.size <= len(content)
        except ValueError:
            pass


def test_a_big_endian_file_is_read():
    """The elements of one vector, as the documented format lays them out."""
    parts = [(6, np.array([6, 0], ">u4")), (5, np.array([1, 2], ">i4")), (1, b"angle\0\0\0")]
    parts.append((9, np.array([1.5, -2.5], ">f8")))
    body = b""
    for kind, data in parts:
        raw = bytes(data)
        length = 5 if kind == 1 else len(raw)
        body += kind.to_bytes(4, "big") + length.to_bytes(4, "big") + raw
    matrix = (14).to_bytes(4, "big") + len(body).to_bytes(4, "big") + body
    packed = zlib.compress(matrix)
    packed = (15).to_bytes(4, "big") + len(packed).to_bytes(4, "big") + packed
    for element in (matrix, packed):
        content = b"MATLAB 5.0".ljust(124) + b"\x01\x00MI" + element
        ((name, values),) = read_matlab(content, largest=1000)
        assert name == "angle"
        assert values.tolist() == [[1.5, -2.5]]


def test_many_variables_that_expand_far_are_refused_together():
    """Each of them is small enough; a file of 5 MB took 1.5 GB."""
    content = saved({f"v{n}": np.zeros(5_000) for n in range(9)}, do_compression=True)
    with pytest.raises(ValueError, match="cut short or too large"):
        list(read_matlab(content, largest=100_000))
    assert len(list(read_matlab(content, largest=400_000))) == 9
