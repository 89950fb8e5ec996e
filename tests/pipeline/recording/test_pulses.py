"""Pulse energies of the log."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.products import EncoderLog
from erlif.pipeline.recording.pulses import ENERGY_COLUMNS, read_energies


def log_with(**columns):
    return EncoderLog(xr.Dataset({name: ("frame", values) for name, values in columns.items()}))


@pytest.mark.parametrize("name", ENERGY_COLUMNS)
def test_energies_are_relative_to_their_mean(name):
    energies = read_energies(log_with(angle=[0.0, 1.0], **{name: [40.0, 60.0]}))
    npt.assert_allclose(energies, [0.8, 1.2])


@pytest.mark.parametrize("values", [["low", "high"], [-1.0, 2.0], [0.0, 0.0], [np.nan, 1.0]])
def test_a_column_that_holds_no_energies_is_not_used(values):
    assert read_energies(log_with(pulse_energy=values)) is None


def test_energies_of_the_rig_are_those_of_its_pulses(run, truth):
    """The energy meter of the rig is good to half a per cent."""
    energies = read_energies(run.log)
    npt.assert_allclose(energies, truth.pulse_energy / truth.pulse_energy.mean(), atol=0.025)
