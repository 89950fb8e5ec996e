"""Covariance of interpolated noise."""

import numpy as np
import numpy.testing as npt
from scipy import ndimage

from erlif.ratio.camera_noise import _overlap


def test_interpolated_noise_of_differences_has_the_predicted_covariance():
    """White noise through scipy's cubic spline at two sub-pixel places, 160 000 pixels each."""
    rng = np.random.default_rng(1)
    noise = rng.standard_normal((400, 400))
    y, x = np.indices(noise.shape, float)
    kernel = rng.standard_normal((5, 5))
    places = [(0.3, -0.15), (0.45, 0.2)]
    images = [
        ndimage.correlate(
            ndimage.map_coordinates(noise, (y + v, x + u), order=3, mode="grid-wrap"),
            kernel,
            mode="wrap",
        )
        for u, v in places
    ]
    at = [np.reshape(place, (2, 1, 1)) for place in places]
    for a in (0, 1):
        for b in (0, 1):
            expected = (images[a] * images[b]).mean()
            npt.assert_allclose(_overlap(kernel, at[a], at[b])[0, 0], expected, rtol=0.02)
