"""Hashes of the inputs against hashlib over the bytes on the disk."""

import hashlib
import os
from dataclasses import replace

import pytest

from erlif.io.ingest import (
    InputChangedError,
    hash_files_beside_frames,
    hash_inputs,
    open_fixture,
    open_run,
    refuse_changed,
    sign_inputs,
    stamp_inputs,
)

KEYS = [f"camera{n}{rest}" for n in (1, 2) for rest in ("/*.tif", "_dark.tif", "_flat.tif")]


def expected(paths):
    """SHA-256 of the SHA-256 digests of the files, one after the other."""
    digests = [hashlib.sha256(path.read_bytes()).digest() for path in paths]
    return hashlib.sha256(b"".join(digests)).hexdigest()


def test_a_run_has_a_hash_for_each_input(lab):
    hashes = hash_inputs(open_run(lab.run))
    assert set(hashes) == {"run.toml", "encoder.csv", *KEYS}
    for name in ("run.toml", "encoder.csv", "camera1_dark.tif"):
        assert hashes[name] == expected([lab.run / name])
    for camera in (1, 2):
        assert hashes[f"camera{camera}/*.tif"] == expected(lab.frames(camera))


def test_a_fixture_has_its_profile_among_the_inputs(lab):
    hashes = hash_inputs(open_fixture(lab.fixture))
    assert set(hashes) == {"fixture.toml", "profile.csv", *KEYS}
    assert hashes["profile.csv"] == expected([lab.fixture / "profile.csv"])


CHANGED = ["run.toml", "camera1/*.tif", "camera2_dark.tif"]


def test_names_are_relative_and_as_short_as_possible(lab):
    directory = lab.run
    absolute = os.fspath(directory / "camera1" / "*.tif")
    lab.edit(
        "run/run.toml",
        ('"camera1/*.tif"', f"'{absolute}'"),
        ('"camera2/*.tif"', f'"../{directory.name}/camera2/*.tif"'),
    )
    hashes = hash_inputs(open_run(directory))
    assert {"camera1/*.tif", "camera2/*.tif"} <= set(hashes)


def test_a_file_that_is_left_out_and_unreadable_has_a_place_in_the_hash(lab):
    path = lab.frames(2)[2]
    path.unlink()
    path.symlink_to(lab.run / "gone.tif")
    recording = open_run(lab.run, skip_bad_frames=True)
    digests = [
        b"unreadable" if k == 2 else hashlib.sha256(one.read_bytes()).digest()
        for k, one in enumerate(lab.frames(2))
    ]
    found = hash_inputs(recording)["camera2/*.tif"]
    assert found == hashlib.sha256(b"".join(digests)).hexdigest()


# hashes that are known


def test_files_that_were_hashed_before_are_not_read_again(lab, monkeypatch):
    recording = open_run(lab.run)
    hashes = hash_inputs(recording)
    known = {path: hashlib.sha256(path.read_bytes()).hexdigest() for path in lab.frames(1)}
    known |= hash_files_beside_frames(recording)
    read = []
    digest = hashlib.file_digest
    monkeypatch.setattr(
        hashlib, "file_digest", lambda file, kind: read.append(file.name) or digest(file, kind)
    )
    assert hash_inputs(recording, known) == hashes
    assert sorted(read) == sorted(os.fspath(path) for path in lab.frames(2))


def test_files_beside_the_frames_are_settings_log_darks_and_flats(lab):
    found = hash_files_beside_frames(open_run(lab.run))
    names = {"run.toml", "encoder.csv"}
    names |= {f"camera{n}_{kind}.tif" for n in (1, 2) for kind in ("dark", "flat")}
    assert {path.name for path in found} == names
    for path, digest in found.items():
        assert digest == hashlib.sha256(path.read_bytes()).hexdigest()


# the sign of unfinished work


def sign(directory):
    recording = open_run(directory, skip_bad_frames=True)
    return sign_inputs(recording, hash_files_beside_frames(recording))


@pytest.mark.parametrize("name", CHANGED)
def test_a_changed_input_changes_the_sign(lab, name):
    before = sign(lab.run)
    path = lab.frames(int(name[6]))[5] if "*" in name else lab.run / name
    if path.suffix == ".tif":
        path.write_bytes(path.read_bytes() + b"0")
    else:
        path.write_text(path.read_text() + "\n")
    assert sign(lab.run) != before


def test_a_frame_of_the_same_size_written_a_nanosecond_later_changes_the_sign(lab):
    before = sign(lab.run)
    path = lab.frames(2)[3]
    stamp = path.stat()
    os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns + 1))
    assert sign(lab.run) != before


def test_a_file_beside_the_frames_is_an_input(lab):
    opened = open_run(lab.run)
    header = lab.run / "camera1.cihx"
    header.write_bytes(b"header")
    pairs = replace(opened.pairs, companions=((header,), ()))
    hashes = hash_inputs(replace(opened, pairs=pairs))
    assert hashes["camera1/*.tif"] == expected([header, *lab.frames(1)])
    assert hashes["camera2/*.tif"] == expected(lab.frames(2))
    assert sign_inputs(opened, {}) != sign_inputs(replace(opened, pairs=pairs), {})


@pytest.mark.parametrize("how", ["written", "replaced", "removed"])
def test_a_file_that_changes_while_it_is_in_use_is_refused(lab, how):
    opened = open_run(lab.run)
    stamps = stamp_inputs(opened)
    refuse_changed(opened, stamps)
    path = opened.pairs.pages[1][0].path
    content, time = path.read_bytes(), path.stat().st_mtime_ns
    if how == "removed":
        path.unlink()
    elif how == "written":
        path.write_bytes(content[:-1] + b"\1")
    else:  # a copy that keeps size and time
        other = path.with_suffix(".new")
        other.write_bytes(content)
        os.utime(other, ns=(time, time))
        other.replace(path)
    with pytest.raises(InputChangedError, match=f"{path.name} was changed or replaced"):
        refuse_changed(opened, stamps)
