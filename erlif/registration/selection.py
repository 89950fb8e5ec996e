"""Choice of the fineness of a surface that the data support.

A finer surface always fits better. Takeuchi's criterion estimates by how much it would still fit
better on data that took no part in the fit: the gain less twice the trace of M^-1 K, with M the
normal matrix and K the scatter of the scores (Takeuchi, 1976; for independent blocks it equals
leave-one-out cross-validation: Stone, 1977). Hold-out blocks gave the same results where they
could test a surface, but they cannot test elements of the size of a block, and they cost four fits
each.
"""

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.registration.matching import EE, SYSTEM, merge_cells, move_sums, system_of
from erlif.registration.surface import Box, Cells, Surface, degree_basis, equations, solve_surface

# Elements along the longer side of the frame, tried always.
LADDER: Final = (1, 2, 3, 4, 6, 8)

# The same, tried only where the best of `LADDER` leaves a displacement.
FINE_LADDER: Final = (12, 16, 20, 24, 32)

# No element is made shorter than this. [px]
SHORTEST_ELEMENT: Final = 36.0

# Standard deviations of a gain by chance that the gain of a finer surface must add to its need.
CLEAR: Final = 2.0

# Finer models are tried only while each coefficient has this many cells.
CELLS_PER_COEFFICIENT: Final = 4

# Finer surfaces are tried where the excess of the tiles is this many standard errors.
LEFT_OVER: Final = 4.0

# The same for pairs of cells: excess of their joint disagreement, 3 if they move together. [1]
LEFT_BETWEEN: Final = 0.6

# A displacement is left for windows if its excess is this many times what makes finer surfaces a
# trial. [1]
UNRESOLVED: Final = 2.0

# Squared displacement over the variance of the windows' own noise from which on windows are worth
# it; a tile sees only the part of a displacement that all of it shares. [1]
WORTH: Final = 0.5

# Sides of the tiles whose disagreement is compared with that of single cells. [cells]
TILES: Final = (2, 4, 8)

# Fewer tiles than this give no mean worth a comparison.
FEWEST_TILES: Final = 8

# Tiles with less than this part of the median gradient product are left out. [1]
LEAST_TEXTURE: Final = 0.1

# Tiles with a determinant below this part of their squared trace have one direction only. [1]
SINGULAR: Final = 1e-4


@dataclass(frozen=True)
class Model:
    """A family of surfaces: polynomials of a total degree, or splines of some elements.

    Attributes
    ----------
    elements : tuple[int, int]
        Spline elements along x and along y.
    degree : int | None
        Total degree of the polynomials on one element; None for the splines themselves.
    """

    elements: tuple[int, int]
    degree: int | None = None

    @property
    def basis(self) -> Array | None:
        """Restriction of the spline coefficients, if any."""
        return None if self.degree is None else degree_basis(self.degree)

    @property
    def coefficients(self) -> int:
        """Number of coefficients of each component."""
        if self.degree is not None:
            return (self.degree + 1) * (self.degree + 2) // 2
        nx, ny = self.elements
        return (nx + 3) * (ny + 3)

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
    """Models from coarse to fine; polynomials first if the ladder begins with one element."""
    longer = max(box[1] - box[0], box[3] - box[2])
    models = [Model((1, 1), 1), Model((1, 1), 2), Model((1, 1), 3)] if ladder[0] == 1 else []
    return models + [
        Model(elements_of(n, box)) for n in ladder if n == 1 or longer / n >= SHORTEST_ELEMENT
    ]


def moved_to(cells: Cells, surface: Surface) -> Cells:
    """The cells as if they had been summed on that surface, to first order."""
    dx, dy = surface.evaluate(cells.x, cells.y)
    sums = move_sums(cells.sums, dx - cells.here_x, dy - cells.here_y)
    return Cells(sums, cells.x, cells.y, dx, dy, cells.weight)


def disagreement(cells: Cells, factor: int) -> Array:
    """Remaining displacement of tiles of ``factor`` by ``factor`` cells, squared and weighted.

    Parameters
    ----------
    cells : Cells
        Sums on a surface.
    factor : int
        Side of the tiles. [cells]

    Returns
    -------
    array, (tile,)
        s' M^-1 s of every tile with enough texture, s its scores and M its normal matrix: the
        squared displacement that the tile asks for, in units of the weight of the cells.
    """
    weighted = merge_cells(cells.sums[..., SYSTEM] * cells.weight[..., None], factor)
    gxx, gxy, gyy, bx, by = system_of(weighted)
    det = gxx * gyy - gxy**2
    trace = gxx + gyy
    if not (trace > 0).any():
        return np.zeros(0)

    ok = (trace > LEAST_TEXTURE * np.median(trace[trace > 0])) & (det > SINGULAR * trace**2)
    return np.asarray((gyy * bx**2 - 2 * gxy * bx * by + gxx * by**2)[ok] / det[ok])


class Excess(NamedTuple):
    """Excess of the disagreement of tiles with a surface over that of single cells.

    Attributes
    ----------
    side : int
        Side of the tiles. [cells]
    value : float
        Mean of s' M^-1 s over that of single cells, less 1; 0 for noise. [1]
    limit : float
        Values above this are not chance. [1]
    """

    side: int
    value: float
    limit: float


def excesses(cells: Cells) -> list[Excess]:
    """Compare the disagreement of tiles with that of single cells.

    The scores of noise add up like noise, so s' M^-1 s has one mean whatever the size of a tile;
    the scores of a missed displacement add up in proportion. For tiles of four and eight cells
    chance is the only limit. Tiles of two are for distortion too fine for those; their limit is
    fixed, because texture may reach from cell to cell.

    Parameters
    ----------
    cells : Cells
        Sums on a fitted surface.

    Returns
    -------
    list of Excess
        For the tiles of which there are enough.
    """
    small = disagreement(cells, 1)
    if not len(small) or not small.mean() > 0:
        return []

    selected = []
    for factor in TILES:
        large = disagreement(cells, factor)
        if len(large) < FEWEST_TILES:
            continue
        limit = LEFT_BETWEEN if factor == 2 else LEFT_OVER / float(np.sqrt(len(large)))
        selected.append(Excess(factor, float(large.mean() / small.mean()) - 1, limit))
    return selected


def left_over(cells: Cells) -> float:
    """Significance of the displacement that remains beside a surface.

    Returns
    -------
    float
        The largest excess over its limit; finer surfaces are worth a trial from 1 on. [1]
    """
    return max((max(found.value, 0.0) / found.limit for found in excesses(cells)), default=0.0)


def is_unresolved(cells: Cells, window: float) -> bool:
    """Whether a displacement remains that windows would follow better than the surface.

    The vectors of windows have noise of their own. A displacement as large as that noise gives
    tiles of the side of a window an excess of 1, and larger tiles one in proportion to their area.
    What is significant only over larger tiles is smaller than the noise that windows would bring.

    Parameters
    ----------
    cells : Cells
        Sums on a fitted surface.
    window : float
        Side of the windows. [px]

    Returns
    -------
    bool
    """
    pitch = float(cells.x[1] - cells.x[0])
    return any(
        found.value > max(UNRESOLVED * found.limit, WORTH * (found.side * pitch / window) ** 2)
        for found in excesses(cells)
    )


def noise_of_scores(cells: Cells, used_up: int) -> float:
    """Mean of s' M^-1 s per degree of freedom, for a surface of `used_up` coefficients.

    That of single cells or of tiles of two by two, whichever is larger: texture that reaches from
    cell to cell shows in the tiles.
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
    """Choose the coarsest model on which no finer one is a clear gain.

    Parameters
    ----------
    cells : Cells
        Sums of one pair of frames, or of many.
    ladder : tuple of int
        Elements along the longer side.
    best : Model, optional
        A model to begin with; the first of the ladder if missing.

    Returns
    -------
    Model
    """
    models = candidates(cells.box, ladder)
    if best is not None:
        models.insert(0, best)
    count = int((cells.weight > 0).sum())

    # all that may gain enough are tried, for a ripple shows only at its own scale
    best, best_gain = models[0], 0.0
    most, noise = np.inf, 0.0
    system = None
    for number, model in enumerate(models):
        more = 2 * (model.coefficients - best.coefficients)
        if number > 0 and (
            CELLS_PER_COEFFICIENT * model.coefficients > count
            or noise * _need(more) > most + noise * more
        ):
            break

        if system is None or system.elements != model.elements:
            system = equations(cells, model.elements)
        surface = solve_surface(system, basis=model.basis)
        moved = moved_to(cells, surface)
        gain = float((cells.weight * (cells.sums[..., EE] - moved.sums[..., EE])).sum())
        noise = noise_of_scores(moved, 2 * model.coefficients)
        if number == 0:
            best_gain, most = gain, attainable_gain(moved)
        elif more > 0 and gain - best_gain > noise * _need(more):
            best, best_gain = model, gain
    return best


def _need(more: int) -> float:
    """Gain, in units of the noise, that justifies `more` further coefficients.

    Noise alone gives each coefficient a gain of one, which data not fitted lose once more.
    """
    return 2 * more + CLEAR * float(np.sqrt(2 * max(more, 0)))


def attainable_gain(cells: Cells) -> float:
    """Gain above chance that finer surfaces may have at most, for cells on a fitted surface.

    Tiles with a displacement of their own follow everything that a surface can. What they gain
    above chance is uncertain by the scatter of chance, of which three standard deviations are
    added. In units of the weight of the cells, as the gain of a model; infinite for too few tiles.
    """
    small = disagreement(cells, 1)
    gains = []
    for factor in TILES:
        large = disagreement(cells, factor)
        if len(large) >= FEWEST_TILES:
            # s' M^-1 s of noise has the mean and the variance of chi-square, 2 and 4
            chance = float(small.mean()) * (len(large) - 3 * float(np.sqrt(len(large))))
            gains.append(float(large.sum()) - chance)
    return max(gains, default=np.inf)
