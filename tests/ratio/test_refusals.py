"""The table of refusals of the noise and the smoothing of a ratio."""

from erlif.core.errors import FrameError
from erlif.ratio.refusals import refusal


def test_a_refusal_names_the_slope_with_its_standard_deviation():
    error = refusal("unknown_gain", camera=2, slope=0.2274, std=0.31)
    assert type(error) is FrameError
    assert "camera2 has no gain" in str(error)
    assert "1/gain = 0.227 ± 0.31 DN/electron" in str(error)
