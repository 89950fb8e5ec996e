"""The light that lamp, lens and film shape, taken out before two bands are compared."""

import numpy as np
import numpy.testing as npt

from erlif.registration.background import divide_by_light, local_light

Y, X = np.indices((120, 160), dtype=np.float64)


def test_light_of_a_wedge_is_found_to_its_border():
    """Linear and quadratic light, also at the edge of the image, where a local mean is off by its slope."""
    for light in (20 + 5 * X, 2000 - 0.1 * (X - 40) ** 2 + 3 * Y):
        npt.assert_allclose(local_light(light, np.ones_like(light)), light, rtol=2e-3)


def test_texture_is_left_and_light_is_gone():
    rng = np.random.default_rng(1)
    texture = 1 + 0.05 * rng.standard_normal(X.shape)
    light = 3000 * (1 - np.exp(-0.02 * (X + 3))) * (1 - 1e-5 * (Y - 60) ** 2)
    found, weight = divide_by_light(
        (light * texture).astype(np.float32), np.ones(X.shape, np.float32)
    )
    lit = weight > 0
    assert lit.mean() > 0.95
    slope, before = (
        np.polyfit(X[lit], image[lit], 1)[0] for image in (found, light / light.mean())
    )
    assert abs(slope) < 0.01 * before
    assert np.corrcoef(found[lit], texture[lit])[0, 1] > 0.99


def test_flagged_pixels_do_not_shape_the_light():
    light = 1000 + 2 * X
    spoilt = light.copy()
    spoilt[50:56, 70:76] = 1e5
    weight = np.ones_like(light)
    weight[50:56, 70:76] = 0
    npt.assert_allclose(local_light(spoilt, weight), light, rtol=2e-3)
    _, used = divide_by_light(spoilt.astype(np.float32), weight)
    assert not used[50:56, 70:76].any()
