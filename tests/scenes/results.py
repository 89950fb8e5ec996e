"""Results of triggers with given numbers, without any image."""

import numpy as np

from erlif.core.arrays import Array
from erlif.pipeline.engines.results import FrameResult, TriggerResult
from erlif.trend import FilmNumber, FilmStatistics, FittedNumbers, GapMinimum, PinPosition


def make_statistics(
    *,
    mean: float = 5.0,
    minimum: float = 3.0,
    random: float = 0.02,
    surface: float = 0.04,
    gradient: Array | None = None,
    beyond_range: float = 0.007,
    misfit: float = 0.1,
) -> FilmStatistics:
    """Statistics whose numbers all differ, with one gradient where it is given."""
    gradients = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [0.5, 1.5, 2.5]])
    if gradient is not None:
        gradients = np.tile(gradient, (3, 1))
    gap = GapMinimum(
        FilmNumber(minimum, 1.5 * random, surface, gradients[1]),
        FilmNumber(mean + 1, 0.5 * random, 0.5 * surface, gradients[2]),
        FilmNumber(0.1 / mean, 0.1 * random / mean**2, 0.0, -0.1 * gradients[2] / mean**2),
        FilmNumber(minimum + 0.5, random, surface, gradients[1]),
        np.array([70.0, 80.0]),
        misfit,
        *np.full((3, 2), np.nan),
    )
    inverse = FilmNumber(1.1 / mean, random / mean**2, 0.0, -gradients[0] / mean**2)
    return FilmStatistics(FilmNumber(mean, random, 0.0, gradients[0]), gap, beyond_range, inverse)


def make_position(
    form: tuple[float, float] = (0.0, 0.0), *, film: float = 3.0, std: float = 0.001
) -> PinPosition:
    """Position of a pin at a film, with a form [um/mm2] of this standard deviation."""
    return PinPosition(
        value=np.array([230.0 - film, 1.0, 0.01, 0.1]),
        random_cov=np.diag([1e-5, 1e-3, 1e-6, 1e-4]),
        surface_cov=np.diag([2e-5, 2e-3, 2e-6, 2e-4]),
        gradient=np.arange(12.0).reshape(4, 3),
        form=FittedNumbers(np.array(form), std**2 * np.eye(2), np.zeros((2, 2)), np.zeros((2, 3))),
    )


def make_result(*frames: int, **changes) -> TriggerResult:
    """Result of a trigger with these frame pairs; every frame has its own numbers."""
    kept = tuple(
        FrameResult(
            k, (0.1 * k, -0.2 * k), (3000 + k, 2000 + k), 100.0 + k, (f"{k:064x}", f"{k + 7:064x}")
        )
        for k in frames
    )
    return TriggerResult(make_statistics(**changes), kept, (50, 1, 2, 3, 4, 5, 6, 7, 8))
