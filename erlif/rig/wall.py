"""A wall behind the film whose reflectance varies over the picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.rig.settings import RigSettings

_WAVES = 128  # of which the texture is the sum


@dataclass(frozen=True)
class Texture:
    """A wall whose reflectance varies over the picture.

    Attributes
    ----------
    waves : Array
        Cosines of which it is the sum: wave vector along x and y [1/pixel], phase [rad], (wave, 3).
    share : float
        Standard deviation of the reflectance, relative to its mean. [1]
    signals : tuple[tuple[Callable[[Array], Array], Callable[[Array], Array]], ...]
        As those of a set-up, before a black wall, the mean one, and one of twice its reflectance;
        empty before the even wall of the fixture.
    """

    waves: Array
    share: float
    signals: tuple[tuple[Callable[[Array], Array], Callable[[Array], Array]], ...] = ()

    def light(self, number: int, film: Array, x: Array, y: Array) -> Array:
        """Light of a film in camera `number`, relative to a very thick film.

        It is a parabola of the reflectance.
        """
        total = sum(np.cos(along * x + down * y + phase) for along, down, phase in self.waves)
        over_mean = np.maximum(1 + self.share * np.sqrt(2 / _WAVES) * total, 0.0)
        black, mean, twice = (each[number - 1](film) for each in self.signals)
        bend = (black + twice) / 2 - mean
        return np.asarray(black + over_mean * (mean - black + bend * (over_mean - 1)))


def draw_texture(rig: RigSettings, rng: np.random.Generator) -> Texture | None:
    """Draw the wall of the joint; None where it is even."""
    share, size = rig.wall_texture
    std = np.sqrt(2) * rig.field_width / rig.width / size
    vectors, phases = rng.normal(0, std, (_WAVES, 2)), rng.uniform(0, 2 * np.pi, (_WAVES, 1))
    return Texture(np.hstack([vectors, phases]), share) if share else None
