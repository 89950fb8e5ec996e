"""The shortest list of remedies with which the films of a run reach a target.

All errors are those of `Systematics`, linear and in the middle of a run. A remedy lowers the widths
of some of them; a patch of known film measures all of them together. So does the gap of a joint,
which holds for smaller widths too.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
import xarray as xr

from erlif.calibration import Systematics
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.core.remedies import REMEDIES
from erlif.core.statistics import covariance_root
from erlif.core.units import parse_quantity

FILMS = (1.0, 3.0, 5.0, 10.0)
"""Films whose errors are stated. [um]"""

NINE_OF_TEN = 1.645
"""Standard deviations within which nine of ten normal errors lie."""

PATCH_STD = 0.02
"""Standard deviation of the film of a patch, where none is stated. [um]"""

_NOTHING = 1e-9  # share of a variance, or width
_NEARLY = 1.02  # of the smallest standard deviation: where nothing reaches the target


def read_target(text: str) -> tuple[float, float]:
    """Read a target.

    Parameters
    ----------
    text : str

    Returns
    -------
    share : float
        Of the film; 0 for a length. [1]
    length : float
        0 for a share. [um]

    Raises
    ------
    ConfigError
        If the text is neither a share nor a length above 0.

    Examples
    --------
    >>> read_target("1 %"), read_target("50 nm")
    ((0.01, 0.0), (0.0, 0.05))
    """
    for unit in ("%", "um"):
        with suppress(ValueError):
            if (size := parse_quantity(text, unit)) > 0:
                return (size / 100, 0.0) if unit == "%" else (0.0, size)
    raise ConfigError(f'Expected a target such as "1 %" of the film or "50 nm"; got "{text}".')


def information_of(prior: Array, posterior: Array) -> Array:
    """Inverse covariance that a measurement has added to a prior, (error, error).

    Examples
    --------
    >>> information_of(np.eye(1), np.array([[0.2]])).round(6)
    array([[4.]])
    """
    back = np.linalg.pinv(covariance_root(prior))
    sizes, axes = np.linalg.eigh(back @ posterior @ back.T)
    axes = (back.T @ axes)[:, sizes > _NOTHING]  # what has no prior has no information
    return np.asarray(axes * np.maximum(1 / sizes[sizes > _NOTHING] - 1, 0.0) @ axes.T)


@dataclass(frozen=True)
class FilmErrors:
    """Errors of some films in the middle of a run, and what remedies leave of them.

    Attributes
    ----------
    films : Array
        `FILMS`, the film that decides, and that of the patch. [um]
    acts : Array
        Derivatives of the logarithm of the ratio by all errors, (error, film); NaN for a film that
        is not covered.
    slope : Array
        The same by the film, (film,). [1/um]
    systematics : Systematics
        The last of these errors; before them stand those of the calibration.
    covariance : Array
        Of all errors, for films anywhere in the picture, (error, error).
    information : Array | None
        What the gap of the joint adds to its inverse; None without one.
    shares : mapping of str to float
        Widths of the sources of error. [1]
    had : frozenset[str]
        Remedies that the run has; the covariance contains the widths that they leave.
    noise : float
        Error of the logarithm of the ratio that no remedy lowers. [1]
    patch_std : float
        [um]
    """

    films: Array
    acts: Array
    slope: Array
    systematics: Systematics
    covariance: Array
    information: Array | None = None
    shares: Mapping[str, float] = field(default_factory=dict)
    had: frozenset[str] = frozenset()
    noise: float = 0.0
    patch_std: float = PATCH_STD

    def has_gap(self, remedies: Collection[str]) -> bool:
        """Whether the gap of the joint takes errors out beside these remedies."""
        alone = any(REMEDIES[key].without_gap for key in {*self.had, *remedies})
        return self.information is not None and not alone

    def std(self, remedies: Collection[str] = ()) -> Array:
        """Standard deviation of all films but the patch with some remedies. [um]"""
        return np.asarray(np.sqrt(sum(self.split(remedies).values())))

    @property
    def terms(self) -> tuple[str, ...]:
        """Source of each error."""
        own = len(self.acts) - len(self.systematics.terms)
        return ("calibration",) * own + self.systematics.terms

    def split(self, remedies: Collection[str] = ()) -> dict[str, Array]:
        """Variance of these films by source of error; errors that compensate lower it. [um2]"""
        acts, scale = self.acts[:, :-1], self.slope[:-1] ** -2.0
        covariance = self._covariance(remedies)
        parts = {"noise": scale * self.noise**2}
        if any(REMEDIES[key].to_patch for key in {*self.had, *remedies}):
            # changes over the field are independent at both places: errors of what the patch shows
            placed = len(acts) - len(self.systematics.terms) + self.systematics.placed
            of_patch = self.acts[:, -1].copy()
            field = float(of_patch[placed] ** 2 @ np.diag(covariance)[placed])
            of_patch[placed] = 0.0
            film = float(self.slope[-1] * self.patch_std) ** 2

            pull = covariance @ of_patch
            share = pull @ acts / (of_patch @ pull + field + film)
            acts = acts - of_patch[:, None] * share
            parts |= {"patch": scale * share**2 * film, "field": scale * share**2 * field}
        for term, part in zip(self.terms, acts * (covariance @ acts), strict=True):
            parts[term] = parts.get(term, 0.0) + scale * part
        return parts

    def lowered(self, remedies: Collection[str]) -> Array:
        """Covariance of all errors with the widths that some remedies leave, without the gap."""
        std, terms = np.sqrt(np.diag(self.covariance)), np.array(self.terms)
        left, grown = np.ones((2, std.size))
        grown[std.size - len(self.systematics.terms) :] = self.systematics.weight_at(0.5)
        for term, width in (one for key in remedies for one in REMEDIES[key].leaves.items()):
            if isinstance(width, str):  # of what has grown until the end
                share = float(self.shares.get(width, width)) / grown
            else:
                share = 0.01 * width / np.maximum(std, _NOTHING)
            left = np.where(terms == term, np.minimum(left, share), left)
        return left[:, None] * self.covariance * left

    def _covariance(self, remedies: Collection[str]) -> Array:
        """Covariance of all errors with some remedies."""
        covariance = self.lowered(remedies)
        if self.information is None or not self.has_gap(remedies):
            return covariance
        root = covariance_root(covariance)
        inner = np.eye(root.shape[1]) + root.T @ self.information @ root
        return np.asarray(root @ np.linalg.solve(inner, root.T))


def shortest_list(
    errors: FilmErrors, target: tuple[float, float], *, within: float = 1.0
) -> xr.DataArray:
    """Find the fewest remedies with which the film that decides reaches a target.

    Of lists of one length, that of the smallest standard deviation is taken. Where none reaches it,
    the list is the shortest that comes within 2 % of the best.

    Parameters
    ----------
    errors : FilmErrors
    target : tuple[float, float]
        As `read_target` returns it.
    within : float
        Standard deviations that a target holds: `NINE_OF_TEN` where nine runs of ten lie within it.

    Returns
    -------
    xarray.DataArray
        Standard deviation (remedy, target_film) with each remedy and those before it, the most
        effective first; the first row is that of the run as it is. [um]
    """
    free = [key for key in REMEDIES if key not in errors.had]
    wanted = target[0] * errors.films[:-1] + target[1]
    lists = (each for size in range(len(free) + 1) for each in combinations(free, size))
    ends = {each: float(errors.std(each)[-1]) for each in lists}
    least, allowed = min(ends.values()), wanted[-1] / within
    enough = allowed if least <= allowed else _NEARLY * least
    best = min(ends, key=lambda each: (ends[each] > enough, len(each), ends[each]))

    order: list[str] = []
    while rest := [key for key in best if key not in order]:
        order.append(min(rest, key=lambda key: float(errors.std([*order, key])[-1])))
    steps = [order[:n] for n in range(len(order) + 1)]
    parts = {term: float(part[-1]) for term, part in errors.split(order).items()}
    largest = max(parts, key=lambda term: parts[term])
    coords = {"remedy": ["", *order], "target_film": errors.films[:-1]}
    attrs = {
        "target": wanted,
        "within": within,
        "largest": largest,
        "largest_std": parts[largest] ** 0.5,
    }
    attrs |= {"long_name": "standard deviation of a film with this remedy and those before it"}
    attrs |= {"units": "um", "gap": [int(errors.has_gap(step)) for step in steps]}
    return xr.DataArray([errors.std(step) for step in steps], coords, attrs=attrs)
