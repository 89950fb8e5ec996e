"""One small simulation on disk, read by several tests and changed by none."""

import pytest
import xarray as xr
from scenes.rig import SMALL

from erlif.rig import simulate


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """Directory of a small simulation."""
    return simulate(tmp_path_factory.mktemp("rig") / "out", seed=5, rig=SMALL)


@pytest.fixture(scope="session")
def truth(written):
    """truth.nc of the small simulation."""
    with xr.open_dataset(written / "truth.nc", engine="h5netcdf") as file:
        return file.load()
