"""A camera of known gain, read noise and defects, drawn by numpy alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest


@dataclass(frozen=True)
class SimulatedCamera:
    """Poisson electrons, normal read noise, an offset, rounding and a count at which it stops."""

    gain: float = 4.4
    """[electron/DN]"""
    read_noise: float = 9.0
    """[electron]"""
    offset: float = 64.0
    """[DN]"""
    shape: tuple[int, int] = (72, 80)
    top: int = 4095
    """Largest count that it writes. [DN]"""
    hot: tuple[tuple[int, int], ...] = ()
    """Pixels with 400 DN more than the light gives."""
    dead: tuple[tuple[int, int], ...] = ()
    """Pixels that stay at the offset."""

    @property
    def temporal_var(self) -> float:
        """Variance of a dark pixel, rounding included. [DN2]"""
        return (self.read_noise / self.gain) ** 2 + 1 / 12

    def expose(self, electrons, rng) -> np.ndarray:
        light = rng.poisson(np.broadcast_to(electrons, self.shape))
        counts = (light + rng.normal(0, self.read_noise, self.shape)) / self.gain + self.offset
        for pixel in self.hot:
            counts[pixel] += 400
        for pixel in self.dead:
            counts[pixel] = self.offset
        return np.clip(np.rint(counts), 0, self.top).astype(np.uint16)

    def darks(self, pages: int, rng) -> list[np.ndarray]:
        return [self.expose(0, rng) for _ in range(pages)]

    def flats(self, levels, pages: int, rng, *, flicker: float = 0.005) -> list[np.ndarray]:
        """Pages of each light level, under a lamp that flickers."""
        return [
            self.expose(level * rng.normal(1, flicker) * self.response, rng)
            for level in levels
            for _ in range(pages)
        ]

    @property
    def response(self) -> np.ndarray:
        """Vignetting and a pattern of the pixels."""
        y, x = np.indices(self.shape)
        rows, columns = self.shape
        falloff = 1 - 0.3 * ((x / columns - 0.5) ** 2 + (y / rows - 0.5) ** 2)
        return falloff * (1 + 0.01 * np.sin(1.7 * x + 2.3 * y))


@pytest.fixture(scope="session")
def simulated() -> type[SimulatedCamera]:
    """The class of cameras, so that a test names what it wants."""
    return SimulatedCamera


@pytest.fixture(scope="session")
def check_coverage():
    """Compare the share of pulls within 1 and 2 standard deviations with that of a normal one."""

    def check(pulls, *, sigmas: float = 3.5) -> None:
        pulls = np.abs(np.asarray(pulls, float).ravel())
        for limit, share in ((1, 0.6827), (2, 0.9545)):
            binomial = np.sqrt(share * (1 - share) / pulls.size)
            assert abs(np.mean(pulls < limit) - share) < sigmas * binomial

    return check
