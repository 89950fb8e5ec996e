"""The sample run and its calibration, processed once for all scripts of the gallery.

`RUN`, `FIXTURE`, `FILM` and `CALIBRATION` are paths below build/sample, `ENDURANCE` holds logs of
endurance tests. To use your own data, put
your own paths in their place: FILM is what ``erlif process`` wrote, CALIBRATION what
``erlif calibrate`` wrote.
"""

import hashlib
import os
import shutil
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 300
"""Longest time to wait for another process that makes the sample. [s]"""


def fingerprint() -> str:
    """Hash of everything the sample's film depends on: erlif itself and the frames."""
    digest = hashlib.sha256()
    for folder in ("erlif", "calibration", "data_samples"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in {".py", ".tif", ".toml", ".csv"}:
                digest.update(path.relative_to(ROOT).as_posix().encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def make_sample(home: Path) -> None:
    """Copy the sample's inputs and process them; the directory appears once it is complete."""
    import erlif

    scratch = home.with_name(f"{home.name}.{os.getpid()}")
    inputs = shutil.ignore_patterns("film.nc*", "calibration.*", "figures", "report.html")
    for folder in ("calibration", "data_samples/straight_bushing"):
        shutil.copytree(ROOT / folder, scratch / folder, ignore=inputs)
    run = scratch / "data_samples" / "straight_bushing"
    for name in ("wedge", "wedge_after"):
        fixture = scratch / "calibration" / name
        erlif.save_calibration(erlif.calibrate(fixture), fixture / "calibration.nc")
    erlif.process(run, output=run / "film.nc").close()
    try:
        scratch.rename(home)
    except OSError:  # another process was quicker
        shutil.rmtree(scratch)


def sample_directory() -> Path:
    """Directory of the processed sample; made on the first call, and again where erlif changed."""
    home = ROOT / "build" / "sample" / fingerprint()
    home.parent.mkdir(parents=True, exist_ok=True)
    lock = home.with_suffix(".lock")
    end = time.monotonic() + PATIENCE
    while not home.exists():
        try:
            lock.touch(exist_ok=False)
        except FileExistsError:
            if time.monotonic() > end:
                raise TimeoutError(f"{lock} is older than {PATIENCE} s; delete it.") from None
            time.sleep(0.2)
            continue
        try:
            make_sample(home)
        finally:
            lock.unlink()
    return home


HOME = sample_directory()
RUN = HOME / "data_samples" / "straight_bushing"
FIXTURE = HOME / "calibration" / "wedge"
FILM = RUN / "film.nc"
CALIBRATION = FIXTURE / "calibration.nc"
ENDURANCE = ROOT / "data_samples" / "endurance"
