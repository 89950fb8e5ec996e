"""Files of cameras and of their programs, against what other decoders read in them."""

import hashlib
import os
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scenes.reading import read, times_of

from erlif.core.errors import FrameError
from erlif.io.ingest.images import check_depth

FOLDER = Path(__file__).parents[2] / "samples"
SAMPLES = tomllib.loads((FOLDER / "samples.toml").read_text("utf-8"))


def digest(path):
    return hashlib.sha256(read(path).astype("<u2").tobytes()).hexdigest()


@pytest.mark.parametrize("name", SAMPLES["pylon"])
def test_files_of_pylon_are_read_as_by_pylon(name):
    assert digest(FOLDER / name) == SAMPLES["pylon"][name]


@pytest.mark.parametrize(
    ("name", "bits"), [("mono10.tiff", 10), ("mono12.tiff", 12), ("mono12.png", 12)]
)
def test_counts_that_pylon_left_aligns_are_named(name, bits):
    counts = read(FOLDER / f"pylon_{name}")[0]
    with pytest.raises(FrameError, match=f'alignment = "left" and bit_depth = {bits}'):
        check_depth(counts, bit_depth=bits, name=name)


@pytest.mark.parametrize("sample", SAMPLES["public"], ids=lambda sample: sample["file"])
def test_public_files_are_read_as_by_other_decoders(sample):
    path = Path(os.environ.get("ERLIF_SAMPLES", "")) / sample["file"]
    if not path.is_file():
        pytest.skip(f"ERLIF_SAMPLES has no {path.name}, {sample['place']}")
    assert hashlib.sha256(path.read_bytes()).hexdigest() == sample["sha256"]
    assert digest(path) == sample["counts"]
    if "times" in sample:
        times = sample["times"]
        np.testing.assert_allclose(times_of(path)[: len(times)], times, atol=1e-9)
