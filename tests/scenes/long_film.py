"""Films of many triggers, made by repeating a few maps."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import xarray as xr

from erlif.core.flags import Flag
from erlif.io.files import NetcdfMaps, ZarrMaps
from erlif.pipeline.engines.triggers import MAPS
from erlif.show.plots.example import example_film, example_frames, example_registration

PHASES = 8
"""Maps that are repeated over the cycle, from the thinnest film to the thickest."""


def write_long_film(
    path: Path,
    *,
    triggers: int,
    shape: tuple[int, int],
    name: str = "long",
    noise: float = 0.05,
    grain: int = 1,
) -> Path:
    """Write film.nc, or film.zarr, of one turn of the crank whose triggers share a few maps.

    `noise` is the standard deviation of a pixel [um]; `grain` pixels on a side share it, which
    compresses better.
    """
    film = _numbers(triggers, shape, name)
    phase = phases(triggers)
    maps = [phase_map(n, shape, noise=noise, grain=grain) for n in range(PHASES)]
    groups = {"registration": example_registration(), "frames": example_frames()}
    with TemporaryDirectory(dir=path.parent) as folder:
        if path.suffix == ".zarr":
            store = ZarrMaps(Path(folder), tuple(MAPS), (triggers, *shape))
            store.create()
            first = [int(np.flatnonzero(phase == n)[0]) for n in range(PHASES)]
            for n, trigger in enumerate(first):
                store.put(trigger, store.encode(maps[n]), {})
            for trigger, n in enumerate(phase.tolist()):
                for one in MAPS:
                    chunk = store.path / one.name / f"c.{trigger}.0.0"
                    if not chunk.exists():
                        os.link(chunk.with_name(f"c.{first[n]}.0.0"), chunk)
            store.finish(film, groups)
            store.path.rename(path)
        else:
            grid = film[["trigger", "y", "x"]]
            file = NetcdfMaps(Path(folder), grid, MAPS)
            chunks = [file.encode(one) for one in maps]
            for trigger, n in enumerate(phase.tolist()):
                file.put(trigger, chunks[n], {})
            file.finish(film, groups)
            file.close()
            file.path.rename(path)
    return path


def crank_angles(triggers: int) -> np.ndarray:
    """Crank angle of each trigger. [degree]"""
    return 360.0 * np.arange(triggers) / triggers


def phases(triggers: int) -> np.ndarray:
    """Number of the map of each trigger: thick where the rocker is fast."""
    speed = np.abs(np.sin(np.radians(crank_angles(triggers))))
    return np.minimum((speed * PHASES).astype(int), PHASES - 1)


def phase_map(
    n: int, shape: tuple[int, int], *, noise: float = 0.05, grain: int = 1
) -> dict[str, np.ndarray]:
    """Thickness, standard deviations and flags of one of the repeated maps.

    A parabola along x of 8 um at its ends, `n` + 2 um thick in the middle; two columns outside the
    overlap on the left, a bubble, and a saturated corner.
    """
    rows, columns = shape
    across = np.linspace(-1, 1, columns)
    truth = np.broadcast_to(2.0 + n + 8.0 * across**2, shape)
    rng = np.random.default_rng(n)
    coarse = rng.standard_normal((-(-rows // grain), -(-columns // grain)))
    scatter = np.kron(coarse, np.ones((grain, grain)))[:rows, :columns]

    flags = np.zeros(shape, np.uint16)
    flags[:, :2] = Flag.OUTSIDE_OVERLAP
    flags[rows // 8 : rows // 4, columns // 6 : columns // 4] = Flag.NO_FILM
    flags[-rows // 8 :, -columns // 8 :] = Flag.SATURATED
    valid = flags == 0
    values = {
        "thickness": truth + noise * scatter,
        "thickness_std": np.full(shape, noise),
        "thickness_std_shared": np.full(shape, 0.02),
    }
    maps = {key: np.where(valid, one, np.nan).astype(np.float32) for key, one in values.items()}
    return {**maps, "flags": flags}


def _numbers(triggers: int, shape: tuple[int, int], name: str) -> xr.Dataset:
    """Everything of the film but its maps."""
    example = example_film().drop_dims(["x", "y"])
    film = example.isel(trigger=np.arange(triggers) % example.sizes["trigger"])
    crank = crank_angles(triggers)
    sine = np.sin(np.radians(crank))
    minimum = 2.0 + 6.0 * np.abs(sine) ** 0.6
    columns = {
        "trigger": np.arange(triggers),
        "crank_angle": crank,
        "encoder_angle": 30 - 30 * np.cos(np.radians(crank)),
        "rocker_speed": 4 * sine,
        "sliding_speed": 0.13 * np.abs(sine),
        "joint_load": 220 + 20 * np.cos(np.radians(2 * crank)),
        "stroke": np.where(sine < 0, -1.0, 1.0),
        "film_min": minimum,
        "film_mean": minimum + 2.6,
        "film_theory": 0.9 * minimum,
        "film_hamrock_dowson": 0.8 * minimum,
        "film_predicted_min": 1.05 * minimum,
        "film_predicted_mean": minimum + 2.4,
    }
    film = film.assign(
        {key: (film[key].dims, one, film[key].attrs) for key, one in columns.items()}
    )

    # the pitch keeps the field of view, so that the region of interest of the example fits
    x = np.linspace(0, 16, shape[1], endpoint=False)
    y = x[1] * np.arange(shape[0])
    settings = film.attrs["settings"].replace('"example"', _quoted(name))
    film = film.assign_coords(
        {"x": ("x", x, {"units": "mm"}), "y": ("y", y, {"units": "mm"})}
    ).assign_attrs(settings=settings)
    return film


def _quoted(name: str) -> str:
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'
