"""One camera reduced in a pass: what its darks and flats hold, page by page."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.correction import measure_camera

EMPTY = np.zeros(4096, np.int64)
SHAPE = (50, 60)


def measure(darks, flats, *, histogram=EMPTY, shape=SHAPE):
    return measure_camera(
        darks=darks, flats=flats, histogram=histogram, shape=shape, camera="camera1"
    )


def test_levels_and_light_are_those_of_the_flats(simulated):
    rng = np.random.default_rng(2)
    camera = simulated(shape=SHAPE)
    flats = camera.flats((4400, 8800), 4, rng, flicker=0)
    measured = measure(camera.darks(8, rng), iter(flats))
    assert measured.has_flat
    assert measured.flat_pages == 8
    mean = camera.response.mean()
    npt.assert_allclose(
        [level.light for level in measured.levels], [1000 * mean, 2000 * mean], rtol=0.002
    )
    expected = np.sum(flats, axis=0, dtype=float) - 8 * 64
    npt.assert_allclose(measured.flat_light, expected, rtol=0.01)


@pytest.mark.parametrize(("share", "used"), [(0.94, True), (0.96, False)])
def test_pixels_within_5_percent_of_saturation_are_left_out_of_the_noise(share, used):
    """Half of the image is near saturation: its level then has the light of the other half."""
    rng = np.random.default_rng(5)
    light = np.where(np.arange(60) < 30, 1000.0, share * 4095 - 64) * np.ones(SHAPE)
    flats = [np.rint(light + 64 + rng.normal(0, 3, SHAPE)).astype(np.uint16) for _ in range(4)]
    (level,) = measure(64.0, flats).levels
    expected = light.mean() if used else 1000.0
    assert level.light == pytest.approx(expected, rel=0.001)
