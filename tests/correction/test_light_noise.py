"""Variances of rows of light, held to the equations in double precision."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import EPS, camera_noise, scene, variances

from erlif.correction.light_noise import fill_noise

SHAPE = (37, 51)


def fill(light, noise, rows, energy=1.0):
    """All rows, of which as many are kept."""
    kept = np.zeros((2, rows, light.shape[1]), np.float32)
    fill_noise(light, tuple(noise), np.float32(energy), *kept, 0, light.shape[0])
    return kept


@pytest.mark.parametrize("camera", [0, 1])
def test_variances_are_those_of_the_light(camera):
    light, noise = scene(SHAPE, dark=0.1), camera_noise(SHAPE)
    expected = np.array(variances(light, noise))[:, camera]
    # four roundings of half a unit each, one of them in the expected value
    npt.assert_allclose(fill(light.light[camera], noise[camera], SHAPE[0]), expected, rtol=3 * EPS)


@pytest.mark.parametrize(("recorded", "energy"), [(1.0, 1.2), (0.0, 0.8)])
def test_dry_joint_adds_its_shot_noise_and_that_of_its_page(recorded, energy):
    """Light is (counts - dark - energy (page - dark))/flat: derivatives by dark, page and flat."""
    rng = np.random.default_rng(3)
    light, noise = scene(SHAPE).light[0], camera_noise(SHAPE)[0]
    dry, page = (rng.uniform(low, 2 * low, SHAPE).astype(np.float32) for low in (20, 0.3))
    per_gain, read_var, _ = noise.numbers.tolist()
    numbers = np.array([per_gain, read_var, recorded], np.float32)
    found = fill(
        light, noise._replace(dry_light=dry, dry_var=page, numbers=numbers), SHAPE[0], energy
    )
    scale, seen = noise.per_flat.astype(float), light + energy * dry.astype(float)
    new = (seen / scale * per_gain + read_var) * scale**2
    of_dark = (1 - energy * recorded) ** 2 * noise.dark_var * scale**2
    repeated = of_dark + energy**2 * page + light.astype(float) ** 2 * noise.flat_var
    npt.assert_allclose(found, [new, repeated], rtol=6 * EPS)
