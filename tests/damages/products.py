"""Damaged calibrations and films, outputs that are in the way, wrong usage."""

import json
import os
import struct

import h5py
import numpy as np

from damages.bench import TEXTS, Damage

INTO = "process run"


def _calibration(name, change, *words):
    def damage(bench):
        with h5py.File(bench.own(bench.calibration), "r+") as file:
            change(file)

    return Damage(f"calibration: {name}", damage, "process run", words)


def _film(name, change, *words, command="figures"):
    def damage(bench):
        with h5py.File(bench.own(bench.film), "r+") as file:
            change(file)

    return Damage(f"film: {name}", damage, f"{command} films/film.nc", words)


def _bytes(name, path, content, command, *words):
    def damage(bench):
        target = bench.directory / path
        bench.write(target, content(target.read_bytes()) if callable(content) else content)

    return Damage(f"{path}: {name}", damage, command, words)


def _state(name, change, command, *words):
    return Damage(name, change, command, words)


def claim_driver(content):
    """The superblock names a block of a driver at the end, which claims 1 GB (section II.A)."""
    assert content[8] == 0, "version of the superblock"
    block = bytes(4) + struct.pack("<I", 2**30) + bytes(8)
    return content[:48] + struct.pack("<Q", len(content)) + content[56:] + block


def empty_heap(content):
    """The first object of the first heap is free space of no size (section III.E)."""
    first = content.index(b"GCOL\x01\0\0\0") + 16
    return content[:first] + bytes(16) + content[first + 16 :]


def _set(name, value):
    def change(file):
        file[name][...] = value

    return change


def _attribute(name, value, variable="/"):
    def change(file):
        file[variable].attrs[name] = value

    return change


def _without(name):
    def change(file):
        del file[name]

    return change


def _first(name, value):
    def change(file):
        file[name][0] = value

    return change


def _complex(name):
    def change(file):
        values = file[name][()].astype("c16")
        del file[name]
        file[name] = values

    return change


def _history(content):
    """Bytes under the name of text in UTF-8."""

    def change(file):
        file.attrs["history"] = np.array(content, h5py.string_dtype("utf-8", len(content)))

    return change


# further numbers that no fit gives are in tests/calibration/test_soundness.py
CALIBRATIONS = [
    _calibration(
        "half a camera map",
        _without("registration/displacement_y"),
        "calibration.nc",
        "displacement_y",
    ),
    _bytes(
        "a driver that claims a gigabyte",
        "fixture/calibration.nc",
        claim_driver,
        "process run",
        *("calibration.nc", "damaged", "erlif calibrate"),
    ),
    _bytes(
        "a heap without end",
        "fixture/calibration.nc",
        empty_heap,
        "process run",
        *("calibration.nc", "processor time", "erlif calibrate"),
    ),
    _calibration("complex curve", _complex("curve_ratio"), "curve_ratio", "complex"),
    _calibration("inverse ratio", _attribute("ratio_direction", "camera1/camera2"), "again"),
    _bytes("cut", "fixture/calibration.nc", lambda d: d[:4000], INTO, "erlif calibrate"),
    _bytes(
        "a film",
        "fixture/calibration.nc",
        lambda data: data,
        "process run --calibration films/film.nc",
        "erlif calibrate",
    ),
]

FILMS = [
    *(
        _film(name, _attribute(*row[:3]), *row[3:], command=command)
        for name, (command, *row) in TEXTS["film_attributes"].items()
    ),
    *(
        _film(name, _without(lost), *words, command=command)
        for name, (command, lost, *words) in TEXTS["film_variables"].items()
    ),
    _film("history is no text", _history(b"\xff\xff\x7ff"), "history", "UTF-8", command="report"),
    _film(
        "half a pair in JSON",
        _attribute("input_hashes", '{"run.toml": "\\ud800"}'),
        *("input_hashes", "UTF-8"),
        command="report",
    ),
    _bytes(
        "a driver that claims a gigabyte",
        "films/film.nc",
        claim_driver,
        "figures films/film.nc",
        "film.nc",
    ),
    _bytes(
        "a heap without end", "films/film.nc", empty_heap, "report films/film.nc", "processor time"
    ),
    _film("exponent at rest", _set("rocker_speed", 0.0), "rocker_speed is zero", command="report"),
    _film("infinite film", _first("film_min", np.inf), "film_min has the value inf"),
    _film("impossible film", _first("film_mean", 1e300), "film_mean has the value"),
    _film("positions fall", lambda f: _set("x", f["x"][()][::-1])(f), "positions x do not rise"),
    _film("positions NaN", _set("y", np.nan), "y has no value"),
    _film("triggers repeat", _set("trigger", 0), "not numbered from 0"),
    _film("calibration of NaN", _attribute("calibration", json.dumps({"a": 1})), "calibration"),
    _film(
        "values elsewhere",
        lambda f: (
            _without("joint_load")(f),
            f.__setitem__("joint_load", h5py.ExternalLink("a.nc", "/a")),
        ),
        "load is a link",
    ),
    _film(
        "claims 8 GB",
        lambda f: (
            _without("joint_load")(f),
            f.create_dataset("joint_load", (10**9,), "f8", chunks=(9,)),
        ),
        "claims 8.0 GB",
    ),
    _bytes("cut", "films/film.nc", lambda d: d[: len(d) // 2], "figures films/film.nc", "process"),
    _bytes("head alone", "films/film.nc", lambda d: d[:100], "report films/film.nc", "process"),
    _state(
        "film: zarr of nonsense",
        lambda b: ((b.run / "film.zarr").mkdir(), b.write(b.run / "film.zarr/zarr.json", "[]")),
        "report run/film.zarr",
        "describes no array",
    ),
]


def _nothing(bench):
    """Leave the bench as it is: the command line is what is wrong."""


OUTPUTS = [
    _state(
        "output: film exists",
        lambda b: os.link(b.film, b.run / "film.nc"),
        "process run",
        "--overwrite",
    )
]

USAGE = [_state(name, _nothing, *row) for name, row in TEXTS["usage"].items()]


def _table(name, content, *words):
    return _state(
        f"table of runs: {name}",
        lambda b: b.write(b.directory / "runs.csv", content),
        "process runs.csv",
        *words,
    )


TABLES = [
    *(_table(name, *row) for name, row in TEXTS["runs"].items()),
    _table("binary", bytes(range(128, 256)), "UTF-8"),
]


def _written(name, path, content, command, *words):
    return Damage(name, lambda b: b.write(b.directory / path, content), command, words)


def _nothing_in_it(path):
    with path.open("wb") as file:
        file.truncate(300_000_000)


KINDS = {
    "pipe": os.mkfifo,
    "folder": os.mkdir,
    "device": lambda path: path.symlink_to("/dev/zero"),
    "link": lambda path: path.symlink_to("/etc/hostname"),
    "nothing": _nothing_in_it,
}


def _special(name, path, kind, command, *words):
    """Another kind of file in the place of one."""

    def damage(bench):
        (bench.directory / path).unlink(missing_ok=True)
        KINDS[kind](bench.directory / path)

    return Damage(name, damage, command, words)


PLACES = [
    *(_written(name, *row) for name, row in TEXTS["written"].items()),
    *(_special(name, *row) for name, row in TEXTS["special"].items()),
]
"""Something else in the place of a file, or in the way of an output."""
