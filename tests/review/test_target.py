"""Errors of a run before and after remedies, against its maps."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.rig import small_rig

import erlif
from erlif.rig import simulate

pytestmark = pytest.mark.usefixtures("without_theory")


@pytest.mark.parametrize("patch", [0.0, 6.5])
def test_the_run_as_it_is_has_the_errors_of_its_maps(tmp_path, patch):
    """With the gap of the joint, alone and beside a patch that shows the scale of the ratio."""
    changes = {"brightness": (1.0, 1.03 if patch else 1.01), "reference": patch}
    rig = small_rig(write_systematics=False, **changes)
    simulate(tmp_path / "rig", seed=72, rig=rig)
    run = tmp_path / "rig" / "run"
    if patch:
        settings = run / "run.toml"
        text = settings.read_text(encoding="utf-8")
        settings.write_text(f'{text}\n[light]\nratio = "correct"\n', encoding="utf-8")
    table, film = erlif.budget(run, target="1 %").target_std, erlif.process(run)
    median, middle = float(table.target_film[-1]), film.sizes["trigger"] // 2
    with xr.open_dataset(tmp_path / "rig" / "truth.nc", engine="h5netcdf") as truth:
        npt.assert_allclose(median, truth.film.median(), rtol=0.1)
    near = np.abs(film.thickness.values[middle] / median - 1) < 0.02
    shared = film.thickness_std_shared.values[middle][near & (film["flags"].values[middle] == 0)]
    npt.assert_allclose(table[0, -1], np.median(shared), rtol=0.15)
    assert table.attrs["gap"][0]
    assert "patch" not in table["remedy"].values or not patch


def test_an_unreadable_target_is_refused_before_the_run_is_read(tmp_path):
    with pytest.raises(erlif.ErlifError, match='"50 nm"; got "1 kg"'):
        erlif.budget(tmp_path, target="1 kg")
