"""How fine a surface the data support.

A finer surface always fits better. Takeuchi's criterion says by how much it would still fit better on data that it has
not seen: the gain less twice the trace of M^-1 K, M the normal matrix and K the scatter of the scores (K. Takeuchi,
Suri-Kagaku 153 (1976) 12; for independent blocks it equals leave-one-out cross-validation, M. Stone, J. R. Stat. Soc. B
39 (1977) 44). Hold-out blocks gave the same answers where they could test a surface, but not for elements of the size
of a block, and they cost four fits each.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.registration.matching import BX, BY, EE, GXX, GXY, GYY, merge_cells, move_sums
from erlif.registration.surface import Box, Cells, Surface, degree_basis, equations, solve_surface

LADDER: Final = (1, 2, 3, 4, 6, 8)
FINE_LADDER: Final = (12, 16, 20, 24, 32)
"""Elements along the longer side of the frame; the fine ones are tried only where the coarse ones leave something."""
LEAST_ELEMENT: Final = 36.0
"""No element is made shorter than this. [px]"""
CLEAR: Final = 2.0
"""The gain of a finer surface must exceed what it needs by this many standard deviations of a gain by chance."""
LEFT_OVER: Final = 4.0
"""Finer surfaces are tried where the best of the coarse leaves something of this many standard errors."""
LEFT_BETWEEN: Final = 0.6
"""The same for neighbouring cells: excess of their joint disagreement, which reaches 3 if they move together."""


@dataclass(frozen=True)
class Model:
    """A family of surfaces: polynomials of a total degree, or splines of some elements."""

    elements: tuple[int, int]
    degree: int | None = None

    @property
    def basis(self) -> AnyArray | None:
        """Restriction of the spline coefficients, if any."""
        return None if self.degree is None else degree_basis(self.degree)

    @property
    def coefficients(self) -> int:
        """Coefficients for each component."""
        nx, ny = self.elements
        return (
            (nx + 3) * (ny + 3)
            if self.degree is None
            else (self.degree + 1) * (self.degree + 2) // 2
        )

    def __str__(self) -> str:
        if self.degree is not None:
            return f"polynomial of degree {self.degree}"
        nx, ny = self.elements
        return f"{nx} x {ny} cubic spline elements"


def elements_of(longer: int, box: Box) -> tuple[int, int]:
    """Nearly square elements, ``longer`` of them along the longer side of the box."""
    across, down = box[1] - box[0], box[3] - box[2]
    if across >= down:
        return longer, max(1, round(longer * down / across))
    return max(1, round(longer * across / down)), longer


def candidates(box: Box, ladder: tuple[int, ...]) -> list[Model]:
    """Models in the order of their coefficients; polynomials first if the ladder begins with one element."""
    longer = max(box[1] - box[0], box[3] - box[2])
    models = [Model((1, 1), 1), Model((1, 1), 2), Model((1, 1), 3)] if ladder[0] == 1 else []
    return models + [
        Model(elements_of(n, box)) for n in ladder if n == 1 or longer / n >= LEAST_ELEMENT
    ]


def moved_to(cells: Cells, surface: Surface) -> Cells:
    """The cells as if they had been summed on that surface, to first order."""
    dx, dy = surface.evaluate(cells.x, cells.y)
    sums = move_sums(cells.sums, dx - cells.here_x, dy - cells.here_y)
    return Cells(sums, cells.x, cells.y, dx, dy, cells.weight)


def disagreement(cells: Cells, factor: int) -> AnyArray:
    """s' M^-1 s of every tile of ``factor`` by ``factor`` cells, s its scores and M its normal matrix."""
    weighted = merge_cells(cells.sums[..., : BY + 1] * cells.weight[..., None], factor)
    gxx, gxy, gyy, bx, by = (weighted[..., k] for k in (GXX, GXY, GYY, BX, BY))
    det = gxx * gyy - gxy**2
    trace = gxx + gyy
    if not (trace > 0).any():
        return np.zeros(0)
    ok = (trace > 0.1 * np.median(trace[trace > 0])) & (det > 1e-4 * trace**2)
    return np.asarray((gyy * bx**2 - 2 * gxy * bx * by + gxx * by**2)[ok] / det[ok])


def left_over(cells: Cells) -> float:
    """How clearly something remains to be moved; 1 where finer surfaces are worth a trial.

    The scores of noise add up like noise, so s' M^-1 s has one mean whatever the size of a tile; what a surface has
    missed adds up in proportion. Tiles of four and eight cells are compared with the single cells, where chance alone
    decides, and tiles of two for distortion too fine for those, where the texture may reach from cell to cell.
    """
    small = disagreement(cells, 1)
    if not len(small) or not small.mean() > 0:
        return 0.0
    largest = 0.0
    for factor in (2, 4, 8):
        large = disagreement(cells, factor)
        if len(large) < 8:
            continue
        excess = float(large.mean() / small.mean()) - 1
        limit = LEFT_BETWEEN if factor == 2 else LEFT_OVER / float(np.sqrt(len(large)))
        largest = max(largest, excess / limit)
    return largest


def noise_of_scores(cells: Cells, used_up: int) -> float:
    """Mean of s' M^-1 s for one degree of freedom, of cells or of tiles of two by two, whichever is larger.

    ``used_up`` degrees of freedom went into the surface on which the cells stand.
    """
    values = []
    for factor in (1, 2):
        tiles = disagreement(cells, factor)
        free = 2 * len(tiles) - used_up
        if free > len(tiles):
            values.append(float(tiles.sum()) / free)
    return max(values, default=0.0)


def choose_model(
    cells: Cells, ladder: tuple[int, ...] = LADDER, best: Model | None = None
) -> Model:
    """The coarsest model on which no finer one is a clear gain. All are tried: a ripple shows only at its own scale.

    Parameters
    ----------
    cells : Cells
        Sums of one pair of frames, or of many.
    ladder : tuple of int
        Elements along the longer side.
    best : Model, optional
        A model to begin with; the first of the ladder if missing.
    """
    models = candidates(cells.box, ladder)
    if best is not None:
        models.insert(0, best)
    best_gain = 0.0
    system = None
    count = int((cells.weight > 0).sum())
    for number, model in enumerate(models):
        if 4 * model.coefficients > count and number > 0:
            break
        if system is None or system.elements != model.elements:
            system = equations(cells, model.elements)
        surface = solve_surface(system, basis=model.basis)
        moved = moved_to(cells, surface)
        gain = float((cells.weight * (cells.sums[..., EE] - moved.sums[..., EE])).sum())
        if number == 0:
            best, best_gain = model, gain
            continue
        assert best is not None
        more = 2 * (model.coefficients - best.coefficients)
        noise = noise_of_scores(moved, 2 * model.coefficients)
        if more > 0 and gain - best_gain > noise * (2 * more + CLEAR * np.sqrt(2 * more)):
            best, best_gain = model, gain
    assert best is not None
    return best
