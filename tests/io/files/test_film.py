"""film.nc and film.zarr: names, dims and units as documented, the same bytes however made."""

import json
import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import erlif
from erlif.core.errors import OutputError
from erlif.core.variables import FILM
from erlif.io.ingest import open_run
from erlif.io.settings import RunSettings, read_run_settings
from erlif.pipeline.cycle import describe_triggers
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.physics.prediction import predict_theory
from erlif.pipeline.recording.omissions import note_omissions

LEFT_OUT = {
    "mechanism": {"stroke", "crank_angle", "rocker_speed", "sliding_speed", "theory", "exponents"},
    "joint": {"sliding_speed", "theory", "film_parameter", "position"},
    "oil": {"theory"},
}
"""What a film of this run lacks without a table of run.toml; maps and statistics need none."""
GROUPS = {
    "theory": {"film_hamrock_dowson", "film_theory"},
    # that of the central film needs a contact
    "exponents": {name for name in FILM if re.match("speed_exponent(?!_central)", name)},
    "position": {"pin_displacement", "pin_tilt", "film_curvature", "film_curvature_axial"},
}


@pytest.mark.parametrize("missing", LEFT_OUT)
def test_film_without_a_table_lacks_what_needs_it(small_rig, missing):
    """The log gives the load, and the joint belongs to the oil."""
    run = open_run(small_rig.run)
    tables = {missing: None} | ({"oil": None} if missing == "joint" else {})
    run = replace(run, settings=run.settings.model_copy(update=tables))
    triggers = describe_triggers(run, locate_run(run))
    film = triggers.assign(film_min=("trigger", np.ones(6)))
    found = {*triggers, *predict_theory(run.settings, film)}  # exponents need the maps

    lacking = set().union(*(GROUPS.get(name, {name}) for name in LEFT_OUT[missing]))
    named = " ".join(note.text for note in note_omissions(run.settings, triggers))
    for name in lacking:
        assert name not in found, name
        # a note names what any motion gives, and a standard deviation with its quantity
        assert name in named or name == "rocker_speed" or name.endswith("_std"), name
    assert {"joint_load", "temperature", "encoder_angle"} <= found


def test_names_of_the_film_are_reserved_in_the_log(opened):
    from erlif.io.ingest.logs.columns import _RESERVED

    assert set(map(str, opened.variables)) - {"laser_mJ"} <= _RESERVED


def test_frames_have_the_names_of_their_files(film):
    with erlif.open_film(film, group="frames") as frames:
        assert frames.file_camera1.values.tolist() == [f"frame_{k:04d}.tif" for k in range(6)]


def test_thickness_is_nan_exactly_where_flags_are_set(opened):
    flagged = opened.flags.values != 0
    assert flagged.any()
    assert not flagged.all()
    for name in ("thickness", "thickness_std", "thickness_std_shared"):
        np.testing.assert_array_equal(np.isnan(opened[name].values), flagged)


def test_film_holds_its_history(small_rig, opened):
    attrs = opened.attrs
    assert attrs["Conventions"] == "CF-1.11"
    assert attrs["erlif_version"] == erlif.__version__
    assert attrs["history"]
    assert RunSettings.model_validate(tomllib.loads(attrs["settings"])) == read_run_settings(
        small_rig.run
    )
    hashes = json.loads(attrs["input_hashes"])
    assert {"run.toml", "encoder.csv", "camera1/*.tif", "camera2_flat.tif"} <= set(hashes)
    assert all(len(value) == 64 for value in hashes.values())
    assert {"regime", "reason"} <= set(opened.film_theory.attrs)
    assert not any(str(small_rig.directory) in str(value) for value in attrs.values())


def test_the_film_does_not_depend_on_threads_repetition_or_place(small_rig, film, tmp_path):
    path = tmp_path / "elsewhere" / "film.nc"
    path.parent.mkdir()
    erlif.process(small_rig.run, output=path, workers=3).close()
    assert path.read_bytes() == film.read_bytes()


def test_zarr_holds_the_same_as_netcdf(small_rig, film, tmp_path):
    path = tmp_path / "film.zarr"
    returned = erlif.process(small_rig.run, output=path)
    xr.testing.assert_identical(returned.load(), erlif.open_film(path).load())
    for group in (None, "frames", "registration"):
        with erlif.open_film(film, group=group) as expected:
            found = erlif.open_film(path, group=group).load()
            xr.testing.assert_identical(found, expected.load())
            assert found.dtypes == expected.dtypes
        # another program opens it without a warning
        assert xr.open_zarr(path, group=group).sizes == found.sizes
    returned.close()
    assert [entry.name for entry in tmp_path.iterdir()] == ["film.zarr"]


def test_a_film_that_is_not_written_is_the_same(small_rig, opened):
    made = erlif.process(small_rig.run)
    xr.testing.assert_identical(made, opened)

    # its groups are kept beside it
    assert made.isel(trigger=[0, 1]).erlif.frames.sizes["frame"] == 6
    assert "displacement_std" in made.erlif.registration


def test_a_full_disk_is_reported_before_a_map_is_written(small_rig, tmp_path, monkeypatch):
    """HDF5 may crash when the disk becomes full; room is taken first."""
    usage = type("Usage", (), {"free": 1000})
    monkeypatch.setattr("erlif.io.files.netcdf_maps.shutil.disk_usage", lambda path: usage)
    with pytest.raises(OutputError, match="No space left on device"):
        erlif.process(small_rig.run, output=tmp_path / "film.nc")
    assert not (tmp_path / "film.nc").exists()
