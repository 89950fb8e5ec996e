"""Order of files as programs write them, against the order of their names by hand."""

import random
from pathlib import Path

import pytest

from erlif.io.ingest.order import number_files, sort_files

# in the order of the recording
RECORDINGS = {
    "HCImage": ["run.tif", "run-file002.tif", "run-file003.tif", "run-file010.tif"],
    "Windows": ["run.tif", "run (2).tif", "run (10).tif"],
    "macOS": ["run.tif", "run copy.tif", "run copy 2.tif"],
    "browser": ["run.tif", "run(1).tif", "run(2).tif"],
    "ImageJ": ["run.tif", "run1.tif", "run2.tif"],
    "Micro-Manager": [f"run_MMStack_Pos0{n}.ome.tif" for n in ("", "_1", "_2", "_10")],
    "PCO": ["run.tif", "run@0001.tif", "run@0002.tif"],
    "OME": ["run.ome.tif", "run-1.ome.tif", "run-2.ome.tif"],
    "without a suffix": ["run.1", "run.2", "run.10"],
    "before the trigger": [*(f"Img-{n:04d}.tif" for n in (20, 3, 1)), "Img0000.tif", "Img0029.tif"],
    "with plus": ["shot -2.tif", "shot -1.tif", "shot +0.tif", "shot +1.tif", "shot +10.tif"],
    "numbers alone": ["-10.tif", "-2.tif", "0.tif", "3.tif"],
    "sign before the camera": ["Img-0002_c1.tif", "Img-0001_c1.tif", "Img0000_c1.tif"],
    "session and number": ["S0001-000002.tif", "S0001-000001.tif", "S0001000000.tif"],
    "hyphens": ["run-1.tif", "run-2.tif", "run-10.tif"],
    "days": ["2026-1-5.tif", "2026-1-22.tif", "2026-11-5.tif"],
    "folders": ["a/2/f_9.tif", "a/10/f_1.tif", "a/10/f_2.tif"],
}


@pytest.mark.parametrize("names", RECORDINGS.values(), ids=RECORDINGS)
def test_files_are_in_the_order_of_the_recording(names):
    for seed in range(5):
        mixed = random.Random(seed).sample(names, len(names))
        assert [str(path) for path in sort_files(map(Path, mixed))] == names


def test_a_hyphen_is_a_sign_only_beside_the_same_stem_without_it():
    assert number_files([Path("Img-0002.tif"), Path("Img0001.tif")]) == [-2, 1]
    assert number_files([Path("Img-0002.tif"), Path("Img-0001.tif")]) == [2, 1]
