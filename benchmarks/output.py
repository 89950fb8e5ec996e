"""What it costs to write maps: codecs compared on the maps of a film, and growth with the run.

    python benchmarks/output.py film.nc            # processor time and size of each codec
    python benchmarks/output.py film.nc --growth   # time per trigger from 20 to 5000 triggers

The maps of the film are rounded already, so rounding them again changes nothing. Codecs that are
not installed (zlib-ng, deflate) are left out.
"""

import argparse
import importlib
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import xarray as xr
from numcodecs import blosc

from erlif.io.files import NetcdfMaps, ZarrMaps, open_film
from erlif.io.files.compression import encode_netcdf, encode_zarr, round_map
from erlif.pipeline.engines.triggers import MAPS

Codec = Callable[[np.ndarray], bytes]
REPEATS = 3
TRIGGERS = (0, 12, 30)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("film", type=Path)
    parser.add_argument("--growth", action="store_true")
    options = parser.parse_args()
    with open_film(options.film) as film:
        count = film.sizes["trigger"]
        maps = [
            {one.name: film[one.name].values[k % count].squeeze() for one in MAPS} for k in TRIGGERS
        ]
    (show_growth if options.growth else show_codecs)(maps)


def show_codecs(maps: list[dict[str, np.ndarray]]) -> None:
    """Processor time and size of one trigger, mean of three."""
    print(f"{'codec':24}{'ms':>8}{'MB':>8}")
    for name, encode in (("HDF5, whole", encode_netcdf), ("zarr, whole", encode_zarr)):
        encode(maps[0], MAPS)  # compiles
        runs = [measure(lambda one=one, encode=encode: encode(one, MAPS)) for one in maps]
        show(name, [(spent, sum(map(len, chunks.values()))) for spent, chunks in runs])
    runs = [
        measure(lambda one=one: round_map(one["thickness"], one["thickness_std"], 0.2))
        for one in maps
    ]
    show("rounding of one map", [(spent, 0) for spent, _ in runs])

    for name, codec, shuffled in codecs():
        spent = size = 0.0
        for one in maps:
            for values in one.values():
                plain = np.ascontiguousarray(values)
                planes = np.ascontiguousarray(plain.view(np.uint8).reshape(-1, plain.itemsize).T)
                seconds, chunk = measure(lambda: codec(planes if shuffled else plain))  # noqa: B023
                spent, size = spent + seconds, size + len(chunk)
        show(name, [(spent / len(maps), size / len(maps))])


def codecs() -> Iterator[tuple[str, Codec, bool]]:
    """Name, codec, and whether it takes shuffled bytes."""
    for level in (1, 4):
        yield f"zlib {level}", lambda data, level=level: zlib.compress(data, level), True
    yield "zlib 1, run lengths", lambda data: with_strategy(zlib, data), True
    if isal := find("isal.isal_zlib"):
        for level in range(4):
            yield f"isal {level}", lambda data, level=level: isal.compress(data, level), True
    if ng := find("zlib_ng.zlib_ng"):
        yield "zlib-ng 1", lambda data: ng.compress(data, 1), True
        yield "zlib-ng 2", lambda data: ng.compress(data, 2), True
        yield "zlib-ng 1, run lengths", lambda data: with_strategy(ng, data), True
    if libdeflate := find("deflate"):
        yield "libdeflate 1", lambda data: libdeflate.zlib_compress(data.tobytes(), 1), True

    blosc.use_threads = False
    for name, level in (("lz4", 1), ("lz4", 5), ("zstd", 1), ("zstd", 3)):
        for filter_name in ("SHUFFLE", "BITSHUFFLE"):
            codec = blosc.Blosc(name, level, getattr(blosc, filter_name))
            yield f"blosc {name} {level} {filter_name.lower()}", codec.encode, False


def with_strategy(module: object, data: np.ndarray) -> bytes:
    """Run lengths and Huffman codes alone."""
    stream = module.compressobj(1, module.DEFLATED, 15, 8, module.Z_RLE)
    return stream.compress(data) + stream.flush()


def find(name: str) -> object | None:
    """A module, where it is installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def show_growth(maps: list[dict[str, np.ndarray]]) -> None:
    """Processor time of a trigger and of the last step, in runs of different length."""
    small = {name: values[:256, :320] for name, values in maps[0].items()}
    print(f"{'format':8}{'triggers':>10}{'put [ms]':>10}{'last step [s]':>15}")
    for kind in ("netcdf", "zarr"):
        for count in (20, 200, 1000, 5000):
            with tempfile.TemporaryDirectory() as folder:
                put, last = write_film_of(Path(folder), kind, count, small)
            print(f"{kind:8}{count:10}{1e3 * put:10.3f}{last:15.3f}", flush=True)


def write_film_of(
    folder: Path, kind: str, count: int, maps: dict[str, np.ndarray]
) -> tuple[float, float]:
    """Write as many triggers with the same chunks; seconds of one put and of the last step."""
    rows, columns = maps["flags"].shape
    grid = xr.Dataset(
        coords={"trigger": np.arange(count), "y": np.arange(rows) * 0.1, "x": np.arange(columns)}
    )
    film = grid.assign(load=("trigger", np.full(count, 220.0)))
    if kind == "netcdf":
        store: NetcdfMaps | ZarrMaps = NetcdfMaps(folder, grid, MAPS)
    else:
        store = ZarrMaps(folder, tuple(MAPS), (count, rows, columns))
        store.create()
    chunks = store.encode(maps)

    start = time.process_time()
    for trigger in range(count):
        store.put(trigger, chunks, {"mean": 4.5, "gradient": np.zeros(3)})
    put = (time.process_time() - start) / count
    start = time.process_time()
    store.finish(film, {})
    store.close()
    return put, time.process_time() - start


def measure(work: Callable[[], object]) -> tuple[float, object]:
    """Shortest processor time of several calls, and the result."""
    best = np.inf
    for _ in range(REPEATS):
        start = time.process_time()
        result = work()
        best = min(best, time.process_time() - start)
    return best, result


def show(name: str, runs: list[tuple[float, float]]) -> None:
    """One line: mean time and mean size."""
    seconds, size = np.mean(runs, axis=0)
    print(f"{name:24}{1e3 * seconds:8.1f}{size / 1e6:8.2f}", flush=True)


if __name__ == "__main__":
    main()
