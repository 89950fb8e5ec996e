"""The directory of a simulation: written whole, and never in the place of something else."""

from __future__ import annotations

import re
import shutil
import tempfile
from os import PathLike
from pathlib import Path

from erlif.core.errors import ModelError, OutputError
from erlif.core.progress import ShowProgress, choose_progress
from erlif.rig.run import write_rig
from erlif.rig.settings import RigSettings

# Names that a simulation writes into its directory.
WRITTEN = ("fixture", "fixture_after", "run", "truth.nc")

# Files that a simulation writes, and those that the commands write beside them by default.
_OWN = re.compile(
    r"truth\.nc"
    r"|(run|fixture(_after)?)/camera[12]/frame_\d+\.tif"
    r"|(run|fixture(_after)?)/camera[12]_(dark|flat|background)\.tif"
    r"|run/(run\.toml|encoder\.\w+)|fixture(_after)?/(fixture\.toml|profile\.csv)"
    r"|run/(\.?film\.(nc|zarr)[^/]*(/.*)?|figures/.*|report\.html)"
    r"|fixture(_after)?/calibration\.\w+"
)

_HDF5 = b"\x89HDF\r\n\x1a\n"


def simulate(
    out: str | Path,
    *,
    seed: int = 0,
    rig: RigSettings | None = None,
    overwrite: bool = False,
    progress: ShowProgress = None,
) -> Path:
    """Photograph a known film with two virtual cameras, and a wedge to calibrate them with.

    Parameters
    ----------
    out : path
        Directory that receives ``fixture/`` and ``run/`` as the laboratory would have written
        them, and ``truth.nc`` with the film, the displacement between the cameras and all other
        inputs of the simulation.
    seed : int
        The same seed and settings write the same bytes.
    rig : RigSettings, optional
        The rig and its run; the defaults describe the joint of the thesis.
    overwrite : bool
        Replace ``fixture``, ``run`` and ``truth.nc`` as a whole once the new ones are complete.
    progress : "bar", bool or callable, optional
        "bar" or True shows bars; a function is called after each frame with the kind of frame, its
        number from 1, and their total.

    Returns
    -------
    Path
        `out`.

    Raises
    ------
    OutputError
        If something of that name exists and `overwrite` is not set, or the directory cannot be
        written.
    ModelError
        If the settings describe no rig that could work.

    Examples
    --------
    A run of six triggers, 8 degrees apart, has six frame pairs:

    >>> rig = RigSettings(width=64, height=48, spacing=8.0, fixture_frames=1)
    >>> with tempfile.TemporaryDirectory() as directory:
    ...     out = simulate(Path(directory), seed=1, rig=rig)
    ...     print(len(list((out / "run" / "camera1").iterdir())))
    6
    """
    report = choose_progress(progress)
    if not isinstance(out, str | PathLike):
        raise OutputError(
            f"Expected the path of a directory as out=, got {type(out).__name__}. Name a directory."
        )
    if rig is not None and not isinstance(rig, RigSettings):
        raise ModelError(
            f"Expected erlif.rig.RigSettings as rig=, got {type(rig).__name__}. Write "
            "rig=erlif.rig.RigSettings(width=256, height=192)."
        )
    out = Path(out)
    existing = [name for name in WRITTEN if (out / name).exists()]
    if existing and not overwrite:
        raise OutputError(
            f"{out} holds {', '.join(existing)} already; choose another directory or pass "
            "--overwrite."
        )
    _refuse_foreign(out, existing)

    # the old directories stay until the new ones are complete
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".simulate-", dir=out) as scratch:
            write_rig(
                Path(scratch),
                seed=seed,
                rig=rig or RigSettings(),
                progress=report,
            )
            for name in existing:
                shutil.rmtree(out / name) if (out / name).is_dir() else (out / name).unlink()
            for path in Path(scratch).iterdir():
                path.rename(out / path.name)
    except OSError as error:
        raise OutputError(
            f"{out} could not be written: {error.strerror or error}. Choose another directory, or "
            "make room."
        ) from error
    return out


def _refuse_foreign(out: Path, existing: list[str]) -> None:
    """Refuse to replace a directory with a file in it that no command has written."""
    places = [path for name in existing for path in (out / name, *(out / name).rglob("*"))]
    files = [path for path in places if path.is_symlink() or not path.is_dir()]
    foreign = [path for path in files if not _OWN.fullmatch(path.relative_to(out).as_posix())]

    truth = out / "truth.nc"
    if truth in files:
        with truth.open("rb") as file:
            foreign += [truth] if file.read(len(_HDF5)) != _HDF5 else []
    if foreign:
        raise OutputError(
            f"Expected nothing but an earlier simulation in {out}; "
            f"{foreign[0].relative_to(out).as_posix()} is something else, which --overwrite does "
            "not remove. Move it away, or choose another directory."
        )
