"""Energy of a laser pulse from the light of camera 1."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import light

from erlif.calibration import Reabsorption
from erlif.core.flags import Flag
from erlif.thickness import measure_pulse_energy

ATTENUATION = 0.40  # [1/um]
MODEL = Reabsorption(np.array([0.65, ATTENUATION, 0.25]))
SHAPE = (96, 128)


@pytest.fixture
def film():
    return np.random.default_rng(1).uniform(2.0, 6.0, SHAPE).astype(np.float32)


def light_of(film, energy):
    return (energy * light(film, ATTENUATION)).astype(np.float32)


def energy_of(seen, film, flags=None):
    flags = np.zeros(SHAPE, np.uint16) if flags is None else flags
    return measure_pulse_energy(seen, film, flags, model=MODEL)


@pytest.mark.parametrize("energy", [200.0, 900.0])
def test_energy_is_that_of_the_pulse_whatever_the_film(film, energy):
    npt.assert_allclose(energy_of(light_of(film, energy), film), energy, rtol=1e-3)
    npt.assert_allclose(energy_of(light_of(film / 2, energy), film / 2), energy, rtol=1e-3)


def test_one_pixel_in_sixteen_of_a_large_image_is_enough():
    """15 % contrast leaves 0.2 % in the median, with the 64 by 128 pixels of half a megapixel."""
    film = np.full((512, 1024), 4.0, np.float32)
    seen = light_of(4.0, 500.0) * np.random.default_rng(3).normal(1, 0.15, film.shape)
    found = energy_of(seen.astype(np.float32), film, np.zeros(film.shape, np.uint8))
    npt.assert_allclose(found, 500.0, rtol=4 * 0.15 * np.sqrt(np.pi / 2 / (64 * 128)) + 1e-3)


@pytest.mark.parametrize(("valid", "expected"), [(64, 500.0), (63, np.nan)])
def test_at_least_64_pixels_are_needed(film, valid, expected):
    flags = np.full(SHAPE, Flag.DIM, np.uint16)
    rows, columns = np.divmod(np.arange(valid), 16)
    flags[24 + 2 * rows, 32 + 2 * columns] = 0
    npt.assert_allclose(energy_of(light_of(film, 500.0), film, flags), expected, rtol=1e-3)
