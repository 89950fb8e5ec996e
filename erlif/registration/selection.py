"""How fine a surface the data support: hold-out blocks decide, and only a clear gain counts."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from erlif.registration.matching import BX, BY, GXX, GXY, GYY
from erlif.registration.surface import Box, Cells, Surface, degree_basis, equations, solve_surface

Array = NDArray[Any]

LADDER: Final = (1, 2, 4, 8, 16)
"""Elements along the longer side of the frame."""
LEAST_ELEMENT: Final = 60.0
"""No element is made shorter than this: hold-out blocks could not test it. [px]"""
BLOCK: Final = 48.0
"""Side of a hold-out block. [px]"""
CLEAR: Final = 3.0
"""A finer surface must be better by this many standard errors over the blocks."""


@dataclass(frozen=True)
class Model:
    """A family of surfaces: polynomials of a total degree, or splines of some elements."""

    elements: tuple[int, int]
    degree: int | None = None

    @property
    def basis(self) -> Array | None:
        """Restriction of the spline coefficients, if any."""
        return None if self.degree is None else degree_basis(self.degree)

    @property
    def coefficients(self) -> int:
        """Coefficients for each component."""
        nx, ny = self.elements
        return (nx + 3) * (ny + 3) if self.degree is None else (self.degree + 1) * (self.degree + 2) // 2

    def __str__(self) -> str:
        if self.degree is not None:
            return f"surface, polynomial of degree {self.degree}"
        nx, ny = self.elements
        return f"surface, {nx} x {ny} cubic spline elements"


def elements_of(longer: int, box: Box) -> tuple[int, int]:
    """Nearly square elements, ``longer`` of them along the longer side of the box."""
    across, down = box[1] - box[0], box[3] - box[2]
    if across >= down:
        return longer, max(1, round(longer * down / across))
    return max(1, round(longer * across / down)), longer


def candidates(box: Box) -> list[Model]:
    """Models in the order of their coefficients, as fine as hold-out blocks can test."""
    longer = max(box[1] - box[0], box[3] - box[2])
    models = [Model((1, 1), 1), Model((1, 1), 2), Model((1, 1), 3)]
    models += [Model(elements_of(n, box)) for n in LADDER if n == 1 or longer / n >= LEAST_ELEMENT]
    return models


def hold_out_gain(cells: Cells, surface: Surface) -> Array:
    """Reduction of the weighted squared difference of each cell by going from where it was summed to the surface."""
    dx, dy = surface.evaluate(cells.x, cells.y)
    dx, dy = dx - cells.here_x, dy - cells.here_y
    s = cells.sums
    linear = 2 * (s[..., BX] * dx + s[..., BY] * dy)
    square = s[..., GXX] * dx**2 + 2 * s[..., GXY] * dx * dy + s[..., GYY] * dy**2
    return np.asarray(cells.weight * (linear - square))


def _blocks(cells: Cells, side: float) -> tuple[Array, Array]:
    """Number of the hold-out block of each cell, and its fold: the blocks alternate like the fields of a chessboard."""
    column = ((cells.x - cells.x[0]) // side).astype(np.int64)
    row = ((cells.y - cells.y[0]) // side).astype(np.int64)
    number = row[:, None] * (column[-1] + 1) + column[None, :]
    return number, (row[:, None] + column[None, :]) % 2


def choose_model(cells: Cells, *, block: float = BLOCK, models: list[Model] | None = None) -> Model:
    """The coarsest model that no finer one beats clearly on blocks that neither has seen.

    All are tried, for a ripple shows only at its own scale.

    Parameters
    ----------
    cells : Cells
        Sums of one pair of frames, or of many.
    block : float
        Side of a hold-out block. [px]
    models : list of Model, optional
        In the order of their coefficients; `candidates` if missing.
    """
    models = candidates(cells.box) if models is None else models
    across, down = cells.box[1] - cells.box[0], cells.box[3] - cells.box[2]
    block = max(min(block, across / 4, down / 4), 2 * float(cells.x[1] - cells.x[0]))
    number, fold = _blocks(cells, block)
    used = np.bincount(number.ravel(), weights=(cells.weight > 0).ravel()) > 0
    best = models[0]
    best_gain: Array = np.zeros(0)
    system = None
    for model in models:
        if 4 * model.coefficients > used.sum() and model is not models[0]:
            continue
        if system is None or system.elements != model.elements:
            system = equations(cells, model.elements, fold=fold)
        gain = np.zeros(cells.weight.shape)
        for test in (0, 1):
            surface = solve_surface(system, basis=model.basis, use=(1 - test,))
            gain = np.where(fold == test, hold_out_gain(cells, surface), gain)
        per_block: Array = np.bincount(number.ravel(), weights=gain.ravel())[used]
        if not best_gain.size:
            best_gain = per_block
            continue
        better = per_block - best_gain
        if better.mean() > CLEAR * better.std() / np.sqrt(better.size):
            best, best_gain = model, per_block
    return best
