"""Parts of the work by themselves, which benchmarks/speed.py runs as processes of their own.

Each function prints its seconds and processor seconds for one pair as a JSON list.
"""

import json
import time
from pathlib import Path

import numpy as np

from erlif.io.files import PartialFilm, open_film, write_film
from erlif.io.ingest import open_run, read_frames
from erlif.pipeline.engines.triggers import MAPS
from erlif.registration import RegistrationSettings, divide_by_light, register

FILMS = 10
"""Maps that are held in memory and written again and again."""


def read_and_write(run_dir: str, film_path: str, output: str) -> None:
    """Read every pair of a run and write a map for it as `erlif process` would."""
    run = open_run(Path(run_dir))
    with open_film(film_path) as film:
        step = -(-film.sizes["trigger"] // FILMS)
        maps = film[[variable.name for variable in MAPS]].isel(trigger=slice(None, None, step))
        maps.load()
    images = [
        {name: maps[name].values[k] for name in maps.data_vars}
        for k in range(maps.sizes["trigger"])
    ]
    pairs = len(run.pairs.usable)
    grid = maps.drop_vars(list(maps.data_vars)).isel(trigger=[0] * pairs)
    grid["trigger"] = np.arange(pairs)

    wall, processor = time.perf_counter(), time.process_time()
    with PartialFilm(Path(output), "reading and writing alone", grid, MAPS) as work:
        for trigger, frame in enumerate(run.pairs.usable):
            read_frames(run.pairs, [frame])
            work.put(trigger, work.maps.encode(images[trigger % len(images)]), {})
        write_film(work, grid, {})
    spent = (time.perf_counter() - wall, time.process_time() - processor)
    print(json.dumps([value / pairs for value in spent]))


def register_each(run_dir: str) -> None:
    """Register every pair of a run by itself, as a displacement field per pair needs it."""
    run = open_run(Path(run_dir))
    spent = []
    for k in run.pairs.usable:
        counts = read_frames(run.pairs, [k]).counts.values[:, 0].astype(np.float32)
        start = (time.perf_counter(), time.process_time())
        one, two = (divide_by_light(image, np.ones_like(image))[0] for image in counts)
        register(one, two, settings=RegistrationSettings(threads=1))
        spent.append((time.perf_counter() - start[0], time.process_time() - start[1]))
    print(json.dumps(np.mean(spent[1:], axis=0).tolist()))  # the first call compiles
