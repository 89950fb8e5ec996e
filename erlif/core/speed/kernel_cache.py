"""Directory in which compiled kernels are kept between starts of the program."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from pathlib import Path


def ensure_kernel_cache() -> Path | None:
    """Set a temporary directory for compiled kernels if numba finds no writable one.

    numba takes the directory that NUMBA_CACHE_DIR names, that of the installed package, or one in
    the home of the user, and refuses to load a kernel where it can write to none of them. It then
    gets a directory that lasts as long as the program. To be called before numba is imported.

    Returns
    -------
    Path or None
        The directory; None where numba finds one by itself.

    Examples
    --------
    A home or an installation that can be written to needs nothing:

    >>> ensure_kernel_cache() is None
    True
    """
    named = os.environ.get("NUMBA_CACHE_DIR")
    home = Path("~").expanduser()
    kept = os.environ.get("XDG_CACHE_HOME", home / ".cache")
    places = [Path(__file__).parent, Path(kept), *([Path(named)] if named else [])]
    if any(_accepts_files(place) for place in places):
        return None

    # only this user may write there, because numba runs what it finds in the directory
    place = Path(tempfile.mkdtemp(prefix="erlif-"))
    atexit.register(shutil.rmtree, place, ignore_errors=True)
    os.environ["NUMBA_CACHE_DIR"] = str(place)
    return place


def _accepts_files(directory: Path) -> bool:
    """Whether a file can be made in a directory, which is made if it does not exist."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory):
            return True
    except (OSError, RuntimeError):
        return False
