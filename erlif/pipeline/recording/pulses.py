"""The energy of the laser pulses, as the log has it."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array
from erlif.core.products import EncoderLog

ENERGY_COLUMNS = ("pulse_energy", "laser_energy", "pulse_energy_mJ", "laser_energy_mJ", "laser_mJ")
"""Names under which a log holds the energy of each pulse; the first one found is used."""


def read_energies(log: EncoderLog) -> Array | None:
    """Energy of each pulse over the mean of the run.

    Parameters
    ----------
    log : EncoderLog

    Returns
    -------
    array, (frame,), or None
        None where the log has no such column, or one with text, with a negative value or with
        zeros alone. [1]

    Examples
    --------
    >>> import xarray as xr
    >>> log = EncoderLog(xr.Dataset({"laser_mJ": ("frame", [49.0, 51.0])}))
    >>> read_energies(log)
    array([0.98, 1.02])
    """
    for name in ENERGY_COLUMNS:
        if name not in log:
            continue
        energy = log[name].values
        if not np.issubdtype(energy.dtype, np.number) or not np.isfinite(energy).all():
            return None
        if energy.min() < 0 or energy.max() == 0:
            return None
        return np.asarray(energy / energy.mean(), float)
    return None
