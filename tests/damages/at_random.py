"""Products, settings and logs, damaged at random, and what erlif may do with them."""

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from scenes.mutations import mutate
from scipy.io import savemat

from erlif.calibration import open_calibration, read_profile
from erlif.io.files import open_film
from erlif.io.ingest.encoder_log import read_log
from erlif.io.ingest.logs.columns import ColumnChoice
from erlif.io.settings import read_fixture_settings, read_run_settings, to_toml
from erlif.review.budget import budget
from erlif.show.plots import write_example, write_figures
from erlif.show.report import print_budget, write_report

NUMBERS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, 1e-300, 1e9, 2.0**31)
LONGEST = 60_000
"""Length of an attribute that HDF5 can store. [byte]"""

ATTRIBUTES = (7, "[[", np.nan, "", np.inf, [1.0, 2.0], "{}", "x" * LONGEST)


@dataclass(frozen=True)
class Product:
    """A kind of file with its reader.

    Attributes
    ----------
    write : Callable[[Path, Path], None]
        Puts whole files into an empty folder, from the directories of the small rig.
    damaged : tuple[str, ...]
        Files one of which is damaged, in the folder; patterns.
    use : Callable[[Path], None]
        What a user does with them; raises an ErlifError, or its result is as documented.
    """

    write: Callable[[Path, Path], None]
    damaged: tuple[str, ...]
    use: Callable[[Path], object]

    def damage(self, folder: Path, rng: np.random.Generator) -> Path:
        """Damage one of the files, and give its path."""
        found = sorted(
            path for name in self.damaged for path in folder.glob(name) if path.is_file()
        )
        target = found[rng.integers(len(found))]
        if target.suffix in {".nc", ".h5"} and rng.random() < 0.6:
            with h5py.File(target, "r+") as file:
                for _ in range(rng.integers(1, 4)):
                    damage_entry(file, rng)
        elif target.suffix in {".nc", ".h5"}:
            target.write_bytes(damage_bytes(target.read_bytes(), rng))
        else:
            target.write_bytes(mutate(target.read_bytes(), rng))
        return target


def damage_bytes(data: bytes, rng: np.random.Generator) -> bytes:
    """Damage a large binary file in one of its parts: its headers lie between its values."""
    start = int(rng.integers(0, max(len(data) - 400, 1)))
    end = start + 4000
    return data[:start] + mutate(data[start:end], rng) + data[end:]


def damage_entry(file: h5py.File, rng: np.random.Generator) -> None:
    """One change of a variable or an attribute; names that HDF5 keeps for itself are spared."""
    names: list[str] = []
    file.visititems(lambda name, entry: names.append(name) if hasattr(entry, "dtype") else None)
    if not names:
        return
    entry = file[names[rng.integers(len(names))]]
    holder = file if rng.random() < 0.3 else entry
    own = [name for name in holder.attrs if name[0].islower() and name != "x"]
    match rng.integers(8):
        case 0:
            del file[entry.name]
        case 1 if entry.dtype.kind in "fiu" and entry.size:
            values = np.array(entry[()]).reshape(-1)
            with np.errstate(all="ignore"):
                values[rng.integers(values.size)] = np.array(rng.choice(NUMBERS)).astype(
                    entry.dtype
                )
            entry[...] = values.reshape(entry.shape)
        case 2 if entry.dtype.kind in "fiu":
            with np.errstate(all="ignore"):
                entry[...] = np.full(entry.shape, rng.choice(NUMBERS)).astype(entry.dtype)
        case 3 if entry.ndim:
            _replace(file, entry, np.array(entry[()])[: int(rng.integers(0, len(entry) + 1))])
        case 4 if entry.dtype.kind in "fiu":
            kind = ("f4", "i2", "u1", "S3", "c16", "f2", "?")[rng.integers(7)]
            with np.errstate(all="ignore"):
                _replace(file, entry, np.array(entry[()]).astype(kind))
        case 5 if own:
            del holder.attrs[own[rng.integers(len(own))]]
        case 6 if own:
            name = own[rng.integers(len(own))]
            value = holder.attrs[name]
            if isinstance(value, bytes | str | np.bytes_):
                text = value.encode() if isinstance(value, str) else bytes(value)
                holder.attrs[name] = np.bytes_(mutate(text, rng)[:LONGEST] or b" ")
        case _ if own:
            name = own[rng.integers(len(own))]
            holder.attrs[name] = ATTRIBUTES[rng.integers(len(ATTRIBUTES))]


def _replace(file: h5py.File, entry: h5py.Dataset, values: Any) -> None:
    """Other values under the name and with the attributes of a variable."""
    name, attributes = entry.name, dict(entry.attrs)
    del file[name]
    new = file.create_dataset(name, data=values)
    for key in attributes.keys() - {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"}:
        new.attrs[key] = attributes[key]


# what a user does


def _check_settings(read: Callable[[Path], Any], name: str) -> Callable[[Path], None]:
    def use(folder: Path) -> None:
        settings = read(folder)
        again = folder / "again"
        again.mkdir(exist_ok=True)
        (again / name).write_text(to_toml(settings), encoding="utf-8")
        assert read(again) == settings

    return use


def _check_log(name: str) -> Callable[[Path], None]:
    def use(folder: Path) -> None:
        log, _ = read_log(folder / name, ColumnChoice({}, {}), frames=6)
        table = log if isinstance(log, xr.Dataset) else log.samples
        assert min(table.sizes.values()) > 0
        for key in ("angle", "time", "load", "temperature"):
            if key in table:
                assert np.isfinite(table[key].values).all(), key
        if not isinstance(log, xr.Dataset):
            assert (np.diff(table.time.values) > 0).all()

    return use


def _check_profile(folder: Path) -> None:
    profile = read_profile(folder / "profile.csv")
    assert np.isfinite(profile.position).all()
    assert np.isfinite(profile.thickness).all()
    assert len(profile.position) == len(profile.thickness) >= 8


def _check_calibration(folder: Path) -> None:
    calibration = open_calibration(folder / "calibration.nc")
    films = np.linspace(*calibration.thickness_range, 20)
    ratio = calibration.predict(films)
    assert np.isfinite(ratio).all()
    assert (calibration.slope(films) > 0).all() or (calibration.slope(films) < 0).all()
    assert np.isfinite(calibration.covariance).all()


def _draw(name: str) -> Callable[[Path], object]:
    return lambda folder: write_figures(
        folder / name, folder / "figures", formats=("pdf",), overwrite=True
    )


def _report(name: str) -> Callable[[Path], object]:
    return lambda folder: write_report(folder / name, folder / "report.html", overwrite=True)


def _budget(folder: Path) -> None:
    print_budget(budget(folder / "run", calibration=folder / "calibration.nc"))


# whole files

TIME = np.arange(40) * 0.01
ANGLE = 50 + 20 * np.sin(20 * TIME)


def _copy(*names: str) -> Callable[[Path, Path], None]:
    def write(rig: Path, folder: Path) -> None:
        for name in names:
            if (rig / name).is_dir():
                shutil.copytree(rig / name, folder / Path(name).name)
            else:
                shutil.copy(rig / name, folder)

    return write


def _write_text(rig: Path, folder: Path) -> None:
    rows = [
        f"{t:.3f};{a:.4f};{t + 21:.2f}".replace(".", ",") for t, a in zip(TIME, ANGLE, strict=True)
    ]
    lines = ["# logger 7", "Time;Encoder angle;Temperature", "s;deg;°C", *rows]
    (folder / "log.csv").write_text("\n".join(lines), encoding="utf-16")


def _write_lvm(rig: Path, folder: Path) -> None:
    head = ["LabVIEW Measurement", "Separator\tTab", "X_Columns\tNo", "***End_of_Header***", ""]
    head += ["Channels\t2", "Y_Unit_Label\tdeg\tN", "X0\t0.0\t0.0", "Delta_X\t0.01\t0.01"]
    head += ["***End_of_Header***", "X_Value\tEncoder\tForce\tComment"]
    rows = [f"\t{angle:.4f}\t{200 + t:.3f}" for t, angle in zip(TIME, ANGLE, strict=True)]
    (folder / "log.lvm").write_text("\r\n".join([*head, *rows]) + "\r\n", newline="")


def _write_tdms(rig: Path, folder: Path) -> None:
    import nptdms

    wave = {"wf_increment": 0.01, "wf_start_offset": 0.0, "unit_string": "deg"}
    with nptdms.TdmsWriter(folder / "log.tdms") as file:
        for part in (slice(0, 20), slice(20, None)):
            angle = nptdms.ChannelObject("run", "angle", ANGLE[part], wave)
            load = nptdms.ChannelObject("run", "load [N]", 200 + TIME[part])
            file.write_segment([angle, load])


def _write_matlab(*, packed: bool) -> Callable[[Path, Path], None]:
    def write(rig: Path, folder: Path) -> None:
        data = {"time_s": TIME, "angle_deg": ANGLE, "log": {"load_N": 200 + TIME}, "note": "x"}
        savemat(folder / "log.mat", data, do_compression=packed)

    return write


def _write_hdf5(**options: Any) -> Callable[[Path, Path], None]:
    def write(rig: Path, folder: Path) -> None:
        with h5py.File(folder / "log.h5", "w", **options) as file:
            file.create_dataset("log/time", data=TIME, chunks=(20,), compression="gzip")
            file["log/time"].attrs["units"] = "s"
            file["log/angle"] = ANGLE[None]
            file["log/angle"].attrs["units"] = "deg"
            file["log/load [N]"] = (200 + TIME).astype("f4")

    return write


def _write_example(rig: Path, folder: Path) -> None:
    write_example(folder / "film.nc")


def _open(folder: Path) -> None:
    for group in (None, "frames", "registration"):
        open_film(folder / "film.nc", group=group).close()


_FILM = ("film.nc",)
_BUDGET = ("run/run.toml", "run/encoder.csv", "calibration.nc", "run/*.tif", "run/camera1/*.tif")

PRODUCTS: dict[str, Product] = {
    "film": Product(_write_example, _FILM, _open),
    "figures example": Product(_write_example, _FILM, _draw("film.nc")),
    "report example": Product(_write_example, _FILM, _report("film.nc")),
    "figures film": Product(_copy("run/film.nc"), _FILM, _draw("film.nc")),
    "report film": Product(_copy("run/film.nc"), _FILM, _report("film.nc")),
    "report zarr": Product(_copy("run/film.zarr"), ("film.zarr/**/*",), _report("film.zarr")),
    "budget": Product(_copy("run", "fixture/calibration.nc"), _BUDGET, _budget),
    "calibration": Product(
        _copy("fixture/calibration.nc"), ("calibration.nc",), _check_calibration
    ),
    "profile": Product(_copy("fixture/profile.csv"), ("profile.csv",), _check_profile),
    "run.toml": Product(
        _copy("run/run.toml"), ("run.toml",), _check_settings(read_run_settings, "run.toml")
    ),
    "fixture.toml": Product(
        _copy("fixture/fixture.toml"),
        ("fixture.toml",),
        _check_settings(read_fixture_settings, "fixture.toml"),
    ),
    "log csv": Product(_copy("run/encoder.csv"), ("encoder.csv",), _check_log("encoder.csv")),
    "log csv in time": Product(_write_text, ("log.csv",), _check_log("log.csv")),
    "log lvm": Product(_write_lvm, ("log.lvm",), _check_log("log.lvm")),
    "log tdms": Product(_write_tdms, ("log.tdms",), _check_log("log.tdms")),
    "log mat": Product(_write_matlab(packed=False), ("log.mat",), _check_log("log.mat")),
    "log mat packed": Product(_write_matlab(packed=True), ("log.mat",), _check_log("log.mat")),
    "log hdf5": Product(_write_hdf5(), ("log.h5",), _check_log("log.h5")),
    "log hdf5 latest": Product(_write_hdf5(libver="latest"), ("log.h5",), _check_log("log.h5")),
    "log mat 7.3": Product(_write_hdf5(userblock_size=512), ("log.h5",), _check_log("log.h5")),
}
"""For each kind its files, what is damaged, and how it is used."""
