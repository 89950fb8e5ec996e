"""What the audits look at."""

from types import SimpleNamespace

import numpy as np
import numpy.testing as npt
import xarray as xr

from erlif.pipeline.audit.evidence import Evidence, median_by_frame


def frame(number, ratio, energy):
    pulse = SimpleNamespace(log_ratio=np.asarray(ratio, np.float32))
    return SimpleNamespace(frame=number, pulse=pulse, pulse_energy=energy)


def test_columns_and_light_are_those_of_the_frames_that_were_measured():
    log = xr.Dataset(
        {"joint_load": ("frame", [1.0, 2, 3, 4]), "laser_mJ": ("frame", [8.0, 8, 16, 8])}
    )
    located = xr.Dataset({"rocker_speed": ("frame", [0.1, 0.2, 0.3, 0.4])})
    frames = [frame(0, [1, 2, 3], 50.0), frame(2, [2, 3, 7], 100.0), frame(3, [5, 5, 5], np.nan)]
    found = Evidence(SimpleNamespace(log=log), located, frames)
    npt.assert_array_equal(found.logged("joint_load"), [1, 3, 4])
    npt.assert_array_equal(found.logged("rocker_speed"), [0.1, 0.3, 0.4])
    assert found.logged("torque") is None
    npt.assert_allclose(found.light, [50 / 75, 100 / 75, np.nan])
    npt.assert_allclose(found.energies, [0.8, 1.6, 0.8])
    npt.assert_array_equal(found.levels, [2, 3, 5])


def test_the_median_is_that_of_places_which_most_frames_have():
    values = np.array([[1.0, 2, 3], [1, 2, np.nan], [np.nan] * 3])
    npt.assert_array_equal(median_by_frame(values), [1.5, 1.5, np.nan])
