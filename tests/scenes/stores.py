"""A small film with known maps, and the stores that hold it while it is made."""

import numpy as np
import xarray as xr

from erlif.io.files import MapVariable, NetcdfMaps, ZarrMaps, open_netcdf

VARIABLES = (
    MapVariable("thickness", "float32", {"units": "um"}, std="thickness_std"),
    MapVariable("thickness_std", "float32", {"units": "um"}, bits=5),
    MapVariable("flags", "uint16", {"flag_masks": np.array([1, 2], np.uint16)}),
)
GRID = xr.Dataset(
    coords={
        "trigger": np.arange(4),
        "y": ("y", np.arange(20) / 10, {"units": "mm"}),
        "x": ("x", np.arange(30) / 10, {"units": "mm"}),
    }
)
FILM = GRID.assign(
    joint_load=("trigger", [220.0, 230.0, 240.0, 250.0], {"units": "N"})
).assign_attrs(title="µm")
GROUPS = {"frames": xr.Dataset({"file_camera1": ("frame", np.array(["a.tif", "ä.tif"]))})}


def open_store(kind, directory):
    """A store of this kind in a directory, with what an earlier one left there."""
    directory.mkdir(parents=True, exist_ok=True)
    if kind == "netcdf":
        return NetcdfMaps(directory, GRID, VARIABLES)
    store = ZarrMaps(directory, VARIABLES, (4, 20, 30))
    store.create()
    return store


def maps_of(trigger):
    """Maps of a trigger, known by its number."""
    rng = np.random.default_rng(trigger)
    return {
        "thickness": rng.normal(5, 0.3, (20, 30)).astype(np.float32),
        "thickness_std": np.full((20, 30), 0.3, np.float32),
        "flags": rng.integers(0, 2, (20, 30)).astype(np.uint16),
    }


def put(store, *triggers):
    """Keep the known maps and numbers of some triggers."""
    for trigger in triggers:
        store.put(trigger, store.encode(maps_of(trigger)), {"mean": trigger / 3, "drift": [1, 2]})


def finish(store):
    """Complete the film; gives its unfinished name."""
    store.finish(FILM, GROUPS)
    store.close()
    return store.path


def whole_film(kind, directory):
    """Contents of a film made without an interruption."""
    store = open_store(kind, directory)
    put(store, 0, 1, 2, 3)
    return contents(finish(store))


def read_store(path, group=None):
    """A completed film, or a group of it, as it stands in the file."""
    if path.is_dir():
        return xr.open_zarr(path, group=group, consolidated=False, chunks=None)
    return open_netcdf(path, group=group)


def contents(path):
    """Bytes of a file, or of every file of a directory by its name."""
    if path.is_file():
        return path.read_bytes()
    return {
        str(file.relative_to(path)): file.read_bytes()
        for file in sorted(path.rglob("*"))
        if file.is_file()
    }
