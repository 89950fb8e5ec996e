"""Camera 2 on the grid of camera 1, held to the plain alignment and to the scatter of noise."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pair import EPS, as_corrected, camera_map, camera_noise, map_with, scene
from scenes.plain import LIGHT
from scenes.plain import align_frames as align_plainly

from erlif.core.products import CorrectedFrames
from erlif.registration import align_frames
from erlif.registration.settings import ORIENTATIONS


@pytest.mark.parametrize("orientation", ORIENTATIONS)
def test_light_noise_and_flags_are_those_of_the_plain_alignment(orientation):
    """Five drifts, whole and fractional; one leaves the image, one is not known."""
    shape = (40, 40)
    drift = np.array([[0.37, -1.2], [-2.0, 3.0], [0.0, 0.0], [50.0, 0.0], [np.nan, np.nan]])
    one = as_corrected(scene(shape), camera_noise(shape))
    frames = CorrectedFrames(xr.concat([one] * len(drift), "frame"))
    given = frames, camera_map(shape, orientation=orientation)
    found, plain = (align(*given, drift=drift) for align in (align_frames, align_plainly))
    npt.assert_array_equal(found["flags"], plain["flags"])

    # one spline; a dozen roundings in the interpolation of a variance and as many in its factor
    npt.assert_array_equal(found.signal, plain.signal)
    for name in LIGHT[1:3]:
        npt.assert_allclose(found[name], plain[name], rtol=12 * EPS)
    npt.assert_allclose(found.interpolation, plain.interpolation, rtol=8 * EPS)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.5, 0.5), (0.3, 0.8)])
def test_variance_is_the_scatter_of_interpolated_noise(shift):
    shape, inside = (800, 64, 80), (slice(8, -8), slice(8, -8))
    noise = np.random.default_rng(6).normal(100, 2.0, shape).astype(np.float32)
    dims = ("camera", "frame", "y", "x")
    images = {"signal": noise, "signal_var": 4.0, "signal_var_fixed": 0.0}
    variables = {
        name: (dims, np.broadcast_to(np.float32(image), (2, *shape)))
        for name, image in images.items()
    }
    flags = (dims, np.zeros((2, *shape), np.uint16))
    frames = CorrectedFrames(xr.Dataset({**variables, "flags": flags}))
    aligned = align_frames(frames, map_with(*shift, shape[1:]))
    scatter = aligned.signal.values[1].var(axis=0)[inside]
    # 800 draws of 3,000 pixels: the mean is good to about 0.2 %
    npt.assert_allclose(aligned.signal_var.values[1, 0][inside].mean(), scatter.mean(), rtol=0.006)
