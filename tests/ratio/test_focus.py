"""Sharpness of a texture that is blurred by a known amount, whatever its light, film and noise."""

import numpy as np
import numpy.testing as npt
from scipy.ndimage import gaussian_filter, gaussian_filter1d

from erlif.correction import NoiseTables
from erlif.ratio import measure_sharpness

SHAPE = (256, 320)
NOTHING = np.zeros((0, 0), np.float32)
READ_VAR, GAIN = 4.0, 4.4  # DN2, electron/DN


def texture(rng, blur, contrast=0.1):
    """Gaussian speckle with a Gaussian correlation; blur is that of the image. [px]"""
    grains = gaussian_filter(rng.standard_normal(SHAPE), blur, mode="wrap")
    return 1 + contrast * grains / grains.std()


def measure(light, rng=None, flags=None):
    tables = NoiseTables(
        np.ones(SHAPE, np.float32),
        *[NOTHING] * 4,
        np.array([1 / GAIN, READ_VAR if rng else 0.0, 0.0], np.float32),
    )
    if rng is None:
        tables.numbers[:] = 0.0
    else:
        electrons = rng.poisson(GAIN * light)
        light = electrons / GAIN + np.sqrt(READ_VAR) * rng.standard_normal(SHAPE)
    flags = np.zeros(SHAPE, np.uint16) if flags is None else flags
    return measure_sharpness(light.astype(np.float32), flags, tables)


def expected(blur):
    """1 - r(1) over 1 - r(4), r the correlation that the kernel of the blur leaves."""
    kernel = gaussian_filter1d(np.eye(1, 41, 20)[0], blur)
    correlation = np.correlate(kernel, kernel, "full")[40:]
    one, four = 1 - correlation[[1, 4]] / correlation[0]
    return one / four


def test_sharpness_is_that_of_the_correlation_of_neighbours():
    rng = np.random.default_rng(1)
    for blur in (0.8, 1.0, 1.5):
        found = np.mean([measure(1000 * texture(rng, blur)) for _ in range(8)])
        npt.assert_allclose(found, expected(blur), rtol=0.02)


def test_light_film_and_noise_do_not_enter():
    rng = np.random.default_rng(2)
    y, x = np.indices(SHAPE)
    film = 0.2 + (x / SHAPE[1] - 0.5) ** 2 + 0.1 * y / SHAPE[0]
    for light in (3000.0, 600.0):
        found = [measure(light * film * texture(rng, 1.0), rng) for _ in range(12)]
        npt.assert_allclose(np.mean(found), expected(1.0), rtol=0.03)


def test_flagged_pixels_are_left_out_and_few_pixels_show_nothing():
    rng = np.random.default_rng(3)
    light, flags = 1000 * texture(rng, 1.0), np.zeros(SHAPE, np.uint16)
    plain = measure(light)
    light[100:120, 50:90], flags[100:120, 50:90] = 5.0, 1
    npt.assert_allclose(measure(light, flags=flags), plain, rtol=0.02)
    flags[:] = 1
    assert np.isnan(measure(light, flags=flags))
    assert np.isnan(measure(np.full(SHAPE, 1000.0)))
