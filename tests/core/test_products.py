"""Products: a skipped stage is named."""

import pytest
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.core.products import require

FRAMES = xr.Dataset({"signal": ("x", [1.0]), "flags": ("x", [0])}, {"x": [0.5]})


def test_all_missing_variables_are_named_with_those_present():
    with pytest.raises(ErlifError) as error:
        require(FRAMES, "signal", "signal_var", "displacement_std")
    message = str(error.value)
    assert "signal_var, displacement_std is missing" in message
    assert "holds signal, flags, x" in message or "holds x, signal, flags" in message
    assert message.endswith("Call the stage before it first.")
