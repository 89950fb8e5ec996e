"""Products: a skipped stage is named."""

import pytest
import xarray as xr

from erlif.core import products
from erlif.core.errors import ErlifError
from erlif.core.products import require

FRAMES = xr.Dataset({"signal": ("x", [1.0]), "flags": ("x", [0])}, {"x": [0.5]})


def test_a_complete_product_is_accepted():
    require(FRAMES, "signal", "flags")
    require(FRAMES)


def test_coordinates_count_as_present():
    require(FRAMES, "x")


def test_all_missing_variables_are_named_with_those_present():
    with pytest.raises(ErlifError) as error:
        require(FRAMES, "signal", "signal_var", "displacement_std")
    message = str(error.value)
    assert "signal_var, displacement_std is missing" in message
    assert "holds signal, flags, x" in message or "holds x, signal, flags" in message
    assert message.endswith("Call the stage before it first.")


@pytest.mark.parametrize(
    "name",
    [
        "EncoderLog",
        "Frames",
        "References",
        "CorrectedFrames",
        "AlignedFrames",
        "RatioImages",
        "ThicknessMaps",
    ],
)
def test_each_product_is_a_dataset_under_a_name_of_its_own(name):
    product = getattr(products, name)
    assert product.__supertype__ is xr.Dataset
    assert product(FRAMES) is FRAMES
