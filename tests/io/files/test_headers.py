"""Films whose headers claim what the file does not hold."""

import json
import os
import resource
import shutil
import time
import zlib

import h5py
import numcodecs
import numpy as np
import pytest
import xarray as xr
import zarr

from erlif.core.errors import OutputError
from erlif.io.files import (
    MapVariable,
    PartialFilm,
    open_film,
    reading_film,
    refuse_existing,
    write_film,
)
from erlif.io.files.headers import check_netcdf, check_zarr
from erlif.show.plots import example_film

MAPS = ("thickness", "thickness_std", "thickness_std_shared", "flags")


@pytest.fixture(params=["film.nc", "film.zarr"])
def path(request, tmp_path):
    """The example film as the pipeline stores it, one chunk for each map."""
    return store(tmp_path / request.param)


def store(path):
    film = example_film()
    grid = xr.Dataset(coords={name: film[name] for name in ("trigger", "y", "x")})
    variables = [MapVariable(name, str(film[name].dtype), film[name].attrs) for name in MAPS]
    with PartialFilm(path, "key", grid, variables) as work:
        for trigger in range(film.sizes["trigger"]):
            maps = {name: film[name].values[trigger] for name in MAPS}
            work.put(trigger, work.maps.encode(maps), {})
        write_film(work, film.drop_vars(MAPS), {})
    return path


def check(path):
    (check_zarr if path.is_dir() else check_netcdf)(path)


def describe(path, name, **changes):
    description = path / name / "zarr.json"
    description.write_text(json.dumps(json.loads(description.read_text()) | changes))


def test_a_film_as_it_was_written_is_accepted(path):
    check(path)
    with open_film(path) as film:
        np.testing.assert_allclose(film.x, example_film().x)


def test_missing_maps_are_not_read_as_valid_pixels(path):
    if path.is_dir():
        (path / "flags" / "c.2.0.0").unlink()
    else:
        with h5py.File(path, "r+") as file:
            shape, kept = file["flags"].shape, file["flags"][0]
            del file["flags"]
            file.create_dataset("flags", shape, "u2", chunks=(1, *shape[1:]))[0] = kept
    with pytest.raises(ValueError, match=r"of flags (is|are) missing"):
        check(path)


@pytest.mark.parametrize("kind", ["external", "soft", "virtual", "raw"])
def test_values_in_another_file_are_refused(tmp_path, kind):
    path = store(tmp_path / "film.nc")
    shutil.copy(path, tmp_path / "other.nc")
    with h5py.File(path, "r+") as file:
        count = file["joint_load"].shape
        del file["joint_load"]
        if kind == "external":
            file["joint_load"] = h5py.ExternalLink("other.nc", "/joint_load")
        elif kind == "soft":
            file["joint_load"] = h5py.SoftLink("/time")
        elif kind == "virtual":
            layout = h5py.VirtualLayout(count, "f8")
            layout[:] = h5py.VirtualSource(tmp_path / "other.nc", "joint_load", count)
            file.create_virtual_dataset("joint_load", layout)
        else:
            file.create_dataset(
                "joint_load", count, "f8", external=[("/dev/zero", 0, 8 * count[0])]
            )
    with pytest.raises(ValueError, match=r"load is a link|load are in another file"):
        check_netcdf(path)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"codecs": [{"name": "pickle"}]}, "has the codecs"),
        ({"shape": [-1]}, "has the shape"),
        ({"shape": [6, 6]}, "has the shape"),
        (
            {"chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [10**9]}}},
            r"claims 8\.0 GB",
        ),
    ],
)
def test_a_description_that_erlif_does_not_write_is_refused(tmp_path, changes, words):
    path = store(tmp_path / "film.zarr")
    describe(path, "joint_load", **changes)
    with pytest.raises(ValueError, match=words):
        check_zarr(path)


@pytest.mark.parametrize(
    ("place", "kind"),
    [
        *((place, "pipe") for place in ("zarr.json", ".zattrs", "joint_load/zarr.json")),
        *((place, "pipe") for place in ("joint_load/c/0", "flags/c.2.0.0", "frames/zarr.json")),
        ("joint_load/c/0", "/dev/zero"),
        ("flags/c.2.0.0", "/dev/zero"),
        ("again", "."),
        ("joint_load/c/0", "terabyte"),
    ],
)
def test_a_store_without_end_is_refused_at_once(tmp_path, place, kind):
    path = store(tmp_path / "film.zarr")
    entry = path / place
    entry.parent.mkdir(exist_ok=True)
    entry.unlink(missing_ok=True)
    if kind == "pipe":
        os.mkfifo(entry)
    elif kind == "terabyte":
        with entry.open("wb") as file:
            file.truncate(2**40)
    else:
        entry.symlink_to(kind)
    began = time.monotonic()
    with pytest.raises(OutputError, match=f"{place} is not a regular file|claims .* GB of {place}"):
        open_film(path)
    with pytest.raises(OutputError, match=r"something else|exists"):
        refuse_existing(path, overwrite=place in ("zarr.json", "joint_load"), holds="thickness")
    assert time.monotonic() - began < 5


def add_unknown(path, number, length, **options):
    """A variable without values, with the shape that its header claims."""
    if path.is_dir():
        group = zarr.open_group(path, mode="a", zarr_format=3)
        group.create_array(f"u{number}", shape=(length,), dtype="f8", **options)
    else:
        with h5py.File(path, "r+") as file:
            file.create_dataset(f"u{number}", (length,), "f8", **options)


@pytest.mark.parametrize(
    ("count", "length", "chunk"), [(8, 2**27, 2**24), (3, 2**24, 2**20), (1, 2**26, 1)]
)
def test_unknown_variables_are_bounded_together_and_in_chunks(path, count, length, chunk):
    for number in range(count):
        add_unknown(path, number, length - 1, chunks=(chunk,))
    began, before = time.monotonic(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(OutputError, match=r"claims .* GB of its small variables"):
        open_film(path)
    assert time.monotonic() - began < 5
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2e5  # kB


LONG = {"name": "fixed_length_utf32", "configuration": {"length_bytes": 2**29}}


@pytest.mark.parametrize(("kind", "length"), [("string", 2**29), (LONG, 8)])
def test_texts_count_with_their_size_in_memory(tmp_path, kind, length):
    path = store(tmp_path / "film.zarr")
    add_unknown(path, 0, length, chunks=(2,))
    describe(path, "u0", data_type=kind)
    with pytest.raises(OutputError, match=r"claims .* GB of u0"):
        open_film(path)


def deflated_zeros(size, wbits):
    """Compressed zeros: one block over and over."""
    stream = zlib.compressobj(9, zlib.DEFLATED, wbits)
    start = stream.compress(bytes(2**20)) + stream.flush(zlib.Z_FULL_FLUSH)
    block = stream.compress(bytes(2**20)) + stream.flush(zlib.Z_FULL_FLUSH)
    return start + block * (size >> 20)


BOMB = 2**30

# settings and bytes of a chunk that holds a gigabyte
BOMBS = {
    "gzip": ({"level": 5}, lambda: deflated_zeros(BOMB, 31)),
    "zstd": ({"level": 1, "checksum": False}, lambda: numcodecs.Zstd(1).encode(bytes(BOMB))),
    "blosc": (
        {"typesize": 1, "cname": "lz4", "clevel": 1, "shuffle": "noshuffle", "blocksize": 0},
        lambda: numcodecs.Blosc("lz4", 1).encode(np.zeros(BOMB, np.uint8)),
    ),
}


def plant(path, name, codec):
    """Put chunks that hold a gigabyte in the place of those of a variable."""
    if path.is_dir():
        settings, make = BOMBS[codec]
        content = make()
        codecs = json.loads((path / name / "zarr.json").read_text())["codecs"][:1]
        describe(path, name, codecs=[*codecs, {"name": codec, "configuration": settings}])
        for chunk in (path / name).rglob("*"):
            if chunk.is_file() and chunk.name != "zarr.json":
                chunk.write_bytes(content)
        return
    with h5py.File(path, "r+") as file:
        old = file[name]
        shape, kind, unit = old.shape, old.dtype, old.attrs["units"]
        scales = [dict(one) for one in old.dims]
        chunk = (1, *shape[1:]) if len(shape) == 3 else shape
        del file[name]
        new = file.create_dataset(name, shape, kind, chunks=chunk, compression="gzip")
        new.attrs["units"] = unit
        for dim, scale in zip(new.dims, scales, strict=True):
            dim.attach_scale(*scale.values())
        for k in range(0, shape[0], chunk[0]):
            new.id.write_direct_chunk((k, 0, 0)[: len(shape)], deflated_zeros(BOMB, 15))


@pytest.mark.parametrize("name", ["joint_load", "thickness"])
@pytest.mark.parametrize("codec", [*BOMBS, "deflate"])
def test_a_chunk_that_holds_more_than_it_states_is_not_decompressed(tmp_path, codec, name):
    path = store(tmp_path / ("film.nc" if codec == "deflate" else "film.zarr"))
    plant(path, name, codec)
    began, before = time.monotonic(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with (
        pytest.raises(OutputError, match=rf"{name}.* holds more than the \d+ bytes"),
        reading_film(path),
        open_film(path) as film,
    ):
        film.thickness[0].load()
    assert time.monotonic() - began < 5
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2e5  # kB
