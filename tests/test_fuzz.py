"""Files damaged at random: they are read, or refused by an error of erlif.

The seeds are fixed and the number of damages is small; long runs are made by hand.
"""

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from readers.mutations import mutate

from erlif.calibration import open_calibration, read_profile
from erlif.core.errors import ErlifError
from erlif.files import open_film
from erlif.ingest.encoder_log import read_log
from erlif.ingest.logs.columns import ColumnChoice
from erlif.plots import write_example
from erlif.settings import read_fixture_settings, read_run_settings

TRIES = 150
"""Damaged files of each kind."""

NUMBERS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, 1e-300)

TEXTS = {
    "settings of a run": ("run/run.toml", lambda path: read_run_settings(path.parent)),
    "settings of a fixture": (
        "fixture/fixture.toml",
        lambda path: read_fixture_settings(path.parent),
    ),
    "log": ("run/encoder.csv", lambda path: read_log(path, ColumnChoice({}, {}), frames=6)),
    "profile": ("fixture/profile.csv", read_profile),
}


@pytest.mark.parametrize("kind", TEXTS)
def test_a_text_damaged_at_random_is_read_or_refused(kind, small_rig, tmp_path):
    name, read = TEXTS[kind]
    whole = (small_rig.directory / name).read_bytes()
    path = tmp_path / Path(name).name
    rng = np.random.default_rng(7)
    outcomes = []
    for _ in range(TRIES):
        path.write_bytes(mutate(whole, rng))
        try:
            read(path)
        except ErlifError as error:
            outcomes.append(str(error))
        else:
            outcomes.append("")
    assert 0 < sum(map(bool, outcomes)) <= TRIES
    assert all("Expected" in message for message in outcomes if message)


def damage(file, rng):
    """One change of a variable or an attribute; names that HDF5 keeps for itself are spared."""
    names: list[str] = []
    file.visititems(lambda name, entry: names.append(name) if hasattr(entry, "dtype") else None)
    entry = file[names[rng.integers(len(names))]]
    own = [name for name in (*file.attrs, *entry.attrs) if name[0].islower() and name != "x"]
    match rng.integers(4):
        case 0:
            del file[entry.name]
        case 1 if entry.dtype.kind == "f" and entry.size:
            values = np.array(entry[()])
            values.reshape(-1)[rng.integers(values.size)] = rng.choice(NUMBERS)
            entry[...] = values
        case 2 if own:
            name = own[rng.integers(len(own))]
            holder = file if name in file.attrs else entry
            del holder.attrs[name]
        case _ if own:
            name = own[rng.integers(len(own))]
            holder = file if name in file.attrs else entry
            holder.attrs[name] = [7, "[[", np.nan, ""][rng.integers(4)]


@pytest.mark.parametrize("kind", ["calibration", "film"])
def test_a_product_damaged_at_random_is_opened_or_refused(kind, small_rig, tmp_path):
    whole = small_rig.fixture / "calibration.nc"
    if kind == "film":
        whole = Path(write_example(tmp_path / "whole.nc"))
    open_one = open_calibration if kind == "calibration" else lambda path: open_film(path).close()
    rng = np.random.default_rng(8)
    messages = []
    for _ in range(TRIES // 8):
        path = tmp_path / "product.nc"
        shutil.copy(whole, path)
        with h5py.File(path, "r+") as file:
            damage(file, rng)
        try:
            open_one(path)
        except ErlifError as error:
            messages.append(str(error))
    assert messages
    assert all("product.nc" in message or "erlif calibrate" in message for message in messages)
