"""Contact of the pin in a round and a worn bore: closed forms, and the force as a gradient."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scipy.integrate import quad

from erlif.models.slider.contact import ContactLaw, RoundBore, WornBore

LAW = ContactLaw(6.523e8)
GAP = 1e-4
PER_ANGLE = 3 / (4 * np.sqrt(2)) * 6.523e8 * np.sqrt(GAP)  # N/m per rad, from eq. 13


def profile(cells, depth=0.0, pin_depth=0.0):
    angle = (np.arange(cells) - cells // 2) * 2 * np.pi / cells
    both = {
        name: ("angle", np.broadcast_to(shape(angle) if callable(shape) else shape, cells))
        for name, shape in (("depth", depth), ("pin_depth", pin_depth))
    }
    return xr.Dataset(both, {"angle": angle})


def test_unworn_wall_has_the_law_of_the_round_bore_where_it_is_shallow():
    """The next term of the closed form is 0.15 of penetration over clearance."""
    worn, round_bore = WornBore(LAW, GAP, profile(7200)), RoundBore(LAW, GAP)
    for share in (1e-3, 1e-2):
        place = (-GAP * (1 + share), 0.0, 1.0, 0.0, 0.0)
        npt.assert_allclose(worn.press(*place).force, round_bore.press(*place).force, rtol=share)


@pytest.mark.parametrize("cells", [90, 360])
def test_deep_wall_has_the_force_of_its_integral(cells):
    """k int (e cos b - c) cos b db over |b| < acos(c/e); the midpoint rule is of second order."""
    e, a = 2 * GAP, np.arccos(0.5)
    expected = PER_ANGLE * (e * (a + np.sin(a) * np.cos(a)) - 2 * GAP * np.sin(a))
    found = WornBore(LAW, GAP, profile(cells)).press(-e, 0.0, 1.0, 0.0, 0.0)
    npt.assert_allclose(found.force, expected, rtol=(2 * np.pi / cells) ** 2 / 4)
    npt.assert_allclose((found.penetration, found.x, found.y), (GAP, -1.0, 0.0), atol=1e-15)


def test_force_and_couple_are_the_gradient_of_the_energy():
    worn = profile(
        72, lambda b: 2e-4 * np.cos(b / 2) ** 2, lambda b: 3e-5 * (1 + np.cos(2 * b - 0.4))
    )
    bore = WornBore(LAW, GAP, worn)
    ex, ey, phi, turned = -2.7e-4, 1.1e-4, 0.3, 2.0

    def energy(dx=0.0, dy=0.0, dt=0.0):
        return bore.press(ex + dx, ey + dy, np.cos(phi), np.sin(phi), turned + dt).energy

    found = bore.press(ex, ey, np.cos(phi), np.sin(phi), turned)
    step, turn = 1e-9, 1e-5  # central differences; no cell enters or leaves the contact between
    gradient = (
        (energy(dx=step) - energy(dx=-step)) / (2 * step),
        (energy(dy=step) - energy(dy=-step)) / (2 * step),
        (energy(dt=turn) - energy(dt=-turn)) / (2 * turn),
    )
    claimed = found.force * np.array([found.x, found.y, found.twist])
    npt.assert_allclose(claimed, gradient, rtol=1e-6)
    assert abs(found.twist) > 1e-6


@pytest.mark.parametrize(("x", "y"), [(1e-6, 0.0), (0.8e-6, 0.4e-6)])
def test_pin_in_its_worn_pocket_has_no_clearance(x, y):
    """A pocket of the shape of the pin presses against every move in it, where it has a depth."""
    bore = WornBore(LAW, GAP, profile(360, lambda b: np.maximum(6e-4 * np.cos(b) - GAP, 0.0)))
    found = bore.press(-6e-4 - x, -y, 1.0, 0.0, 0.0)
    end = np.arccos(1 / 6)

    def bears(b):
        return PER_ANGLE * max(x * np.cos(b) + y * np.sin(b), 0.0)

    expected = [-quad(lambda b, f=f: bears(b) * f(b), -end, end)[0] for f in (np.cos, np.sin)]
    claimed = found.force * np.array([found.x, found.y])
    npt.assert_allclose(claimed, expected, rtol=2e-3, atol=1e-12)


@pytest.mark.parametrize("phi", [0.0, 0.7])
def test_pin_rests_where_the_contact_carries_the_force(phi):
    worn = profile(120, lambda b: 1e-4 * np.cos(b / 2) ** 4, lambda b: 1e-5 * (1 + np.cos(b)))
    for bore in (RoundBore(LAW, GAP), WornBore(LAW, GAP, worn)):
        angles = (np.cos(phi), np.sin(phi), 1.3)
        found = bore.press(*bore.rest(-80.0, 30.0, *angles), *angles)
        npt.assert_allclose((found.force * found.x, found.force * found.y), (-80.0, 30.0))
