"""The virtual rig: a known film, photographed. It shares no code with the stages that will measure it."""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from erlif.core.errors import OutputError
from erlif.rig.settings import RigSettings

__all__ = ["RigSettings", "simulate"]

WRITTEN = ("fixture", "run", "truth.nc")
"""What a simulation leaves in its directory."""


def simulate(
    out: Path,
    *,
    seed: int = 0,
    rig: RigSettings | None = None,
    overwrite: bool = False,
    progress: Callable[[str, int, int], None] | None = None,
) -> Path:
    """Photograph a known film with two virtual cameras, and a wedge to calibrate them with.

    Parameters
    ----------
    out : Path
        Directory that receives ``fixture/`` and ``run/``, as the laboratory would have written them, and ``truth.nc``
        with the film, the displacement between the cameras and everything else that was put in.
    seed : int
        The same seed and settings write the same bytes.
    rig : RigSettings, optional
        The rig and what it does; the defaults are the thesis's joint.
    overwrite : bool
        Replace ``fixture``, ``run`` and ``truth.nc`` as a whole once the new ones are complete.
    progress : callable, optional
        Told after each frame: what it was, its number from 1, and how many there will be.

    Returns
    -------
    Path
        `out`.

    Raises
    ------
    OutputError
        If something of that name exists and `overwrite` is not set, or the directory cannot be written.
    ModelError
        If the settings describe no rig that could work.
    """
    from erlif.rig.run import write_rig  # heavy imports only when the work starts

    out = Path(out)
    existing = [name for name in WRITTEN if (out / name).exists()]
    if existing and not overwrite:
        raise OutputError(
            f"{out} holds {', '.join(existing)} already; choose another directory or pass --overwrite."
        )
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".simulate-", dir=out) as scratch:
            write_rig(
                Path(scratch),
                seed=seed,
                rig=rig or RigSettings(),
                progress=progress or (lambda *_: None),
            )
            for name in existing:
                shutil.rmtree(out / name) if (out / name).is_dir() else (out / name).unlink()
            for name in WRITTEN:
                (Path(scratch) / name).rename(out / name)
    except OSError as error:
        raise OutputError(f"{out} could not be written: {error.strerror or error}.") from error
    return out
