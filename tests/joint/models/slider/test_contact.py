"""Contact of the pin in a round and a worn bore: closed forms, and the force as a gradient."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scipy.integrate import quad

from erlif.joint.models.slider.contact import ContactLaw, PinCells, RoundBore, Wall, WornBore

LAW = ContactLaw(6.523e8)
GAP = 1e-4
PER_ANGLE = 3 / (4 * np.sqrt(2)) * 6.523e8 * np.sqrt(GAP)  # N/m per rad, from eq. 13

WALL = Wall(1e-5, cells=180, area=2e-6, stiffness=8e10)


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


@pytest.mark.parametrize("softened", [1.0, 50.0])
@pytest.mark.parametrize(
    "worn",
    [
        np.zeros(180),
        1e-4 * (1 + np.cos(2 * WALL.angle)),
        np.maximum(6e-4 * np.cos(WALL.angle) - 1e-5, 0.0),
    ],
    ids=["unworn", "two sides", "pocket"],
)
def test_pressure_carries_every_load_from_any_start(worn, softened):
    rng = np.random.default_rng(5)
    angle, size = rng.uniform(-np.pi, np.pi, 60), 10 ** rng.uniform(0, 3, 60)
    force = size[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    worn = np.broadcast_to(worn, (60, 180))
    place, pressure = WALL.balance(worn, force, softened, 1e-5 * np.ones((60, 2)))
    carried = WALL.area * np.einsum("nc,ic->ni", pressure, WALL.normal)
    npt.assert_allclose(carried, force, atol=1e-11 * size.max())

    # each cell bears its own overlap
    overlap = place @ WALL.normal - 1e-5 - worn
    npt.assert_allclose(pressure, 8e10 / softened * np.maximum(overlap, 0.0), rtol=1e-9)


def test_indentation_of_a_round_pocket_is_the_load_over_its_stiffness():
    """A pocket of the shape of the pin over half of the bushing: stiffness area / cell pi/2."""
    pocket = np.maximum(1e-3 * np.cos(WALL.angle), 0.0) - 1e-5
    place, _ = WALL.balance(pocket[None], np.array([[100.0, 0.0]]), 1.0, np.array([[1.1e-3, 0.0]]))
    expected = 100.0 / (8e10 * 2e-6 / WALL.cell * np.pi / 2)
    npt.assert_allclose(place[0], [1e-3 + expected, 0.0], atol=1e-12)


def test_wear_of_the_pin_is_kept_whatever_its_turn():
    cells = PinCells(WALL, np.array([0.0, 1.234, -7.5]))
    worn = np.random.default_rng(3).random((3, 180))
    npt.assert_allclose(cells.scatter(worn).sum(), worn.sum(), rtol=1e-13)

    # a depth of one place is seen where the pin has turned to: 2 radians further on
    mark = np.exp(-((WALL.angle / 0.2) ** 2))
    seen = PinCells(WALL, np.array([2.0])).gather(mark)[0]
    npt.assert_allclose(
        seen, np.exp(-(((WALL.angle - 2.0) / 0.2) ** 2)), atol=0.008
    )  # linear: h^2 f'' / 8
