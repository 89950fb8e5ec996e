"""Wall of springs: the pressure carries the load, and worn profiles keep their volume."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.models.slider.wall import PinCells, Wall

WALL = Wall(1e-5, cells=180, area=2e-6, stiffness=8e10)


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
