"""Linkages of the tests, and a position solver that shares nothing with the models."""

import numpy as np
import pytest


class Solver:
    """Positions of a four-bar linkage by the intersection of two circles, in complex numbers."""

    def __init__(self, links):
        self.crank, self.coupler, self.rocker, self.ground = links

    def rocker_pin(self, crank_angle):
        pin = self.crank * np.exp(1j * crank_angle)
        line = self.ground - pin
        reach = np.abs(line)
        along = (self.coupler**2 - self.rocker**2 + reach**2) / (2 * reach)
        aside = np.sqrt(self.coupler**2 - along**2)
        return pin + (along + 1j * aside) * line / reach

    def rocker_angle(self, crank_angle):
        """Interior angle at the rocker pivot."""
        return np.pi - np.angle(self.rocker_pin(crank_angle) - self.ground)

    def extreme(self, function, sign):
        """Crank angle and value of the greatest sign * function over a turn."""
        angles = np.linspace(0, 2 * np.pi, 181)
        for _ in range(4):
            values = sign * function(angles)
            k = int(np.argmax(values))
            step = angles[1] - angles[0]
            angles = np.linspace(angles[k] - step, angles[k] + step, 41)
        return angles[20], sign * float(values[k])

    def swing(self):
        return self.extreme(self.rocker_angle, 1)[1] - self.extreme(self.rocker_angle, -1)[1]

    def rising_part(self):
        """Share of a turn in which the rocker angle grows, from its positions alone."""
        top, bottom = (self.extreme(self.rocker_angle, sign)[0] for sign in (1, -1))
        return (top - bottom) % (2 * np.pi) / (2 * np.pi)

    def speed(self, crank_angle):
        """Rate of the rocker angle, by a difference of sixth order."""
        step, angle = 2e-3, self.rocker_angle
        weights = {1: 45, 2: -9, 3: 1, -1: -45, -2: 9, -3: -1}
        return sum(w * angle(crank_angle + k * step) for k, w in weights.items()) / (60 * step)

    def speed_ratio(self):
        return max(self.extreme(self.speed, 1)[1], -self.extreme(self.speed, -1)[1])


@pytest.fixture(scope="session")
def solver():
    return Solver


@pytest.fixture(scope="session")
def draw_linkage():
    """Random crank-rockers whose transmission angle leaves room for finite differences."""

    def draw(rng, least=25.0):
        while True:
            crank, *others = rng.uniform(0.05, 1.0, 4)
            shortest, middle, longest = sorted(others)
            if not (crank < 0.9 * shortest and crank + longest < 0.97 * (shortest + middle)):
                continue
            coupler, rocker, ground = others
            cosines = [
                (coupler**2 + rocker**2 - (ground + s * crank) ** 2) / (2 * coupler * rocker)
                for s in (-1, 1)
            ]
            angles = np.degrees(np.arccos(cosines))
            if min(angles[0], 180 - angles[1]) > least:
                return crank, coupler, rocker, ground

    return draw
