"""Linear equations of a gap whose form is known, in all frames, and of the errors of the ratio.

Unknowns are the positions of the pin, the form of the gap, errors that are common to all cells, and
those of each cell by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from erlif.core.arrays import Array
from erlif.core.statistics import covariance_root

_ROUNDNESS = 0.5  # um: smooth departure of pin and bore from circles at the edge of the image
_MARKS = 0.1  # um: marks of the surfaces, in the mean over a cell
_BEND = 0.01  # um: change of the form from frame to frame, at the edge of the image
_FREE = 1e3  # um: standard deviation of a position that is not known


class RatioEquations(NamedTuple):
    """Linearised dependence of the log ratio of the cells on film, errors and motion.

    Attributes
    ----------
    slope : Array
        Derivative by the film, (frame, cell). [1/um]
    errors : Array
        Derivatives by the errors, (error, frame, cell).
    variance : Array
        (frame, cell); infinite where a cell is not used. [1]
    motion : Array
        Change of the film with the position of the pin and with a bend, (motion, cell).
    motion_std : Array
        Standard deviations of these, (motion,). [um]
    form : Array
        Covariance of the form of the gap, (cell, cell). [um2]
    pattern : Array
        Derivatives by further errors, one of each cell and part that acts there alone,
        (part, frame, cell).
    """

    slope: Array
    errors: Array
    variance: Array
    motion: Array
    motion_std: Array
    form: Array
    pattern: Array = np.zeros((0, 1, 1))

    def by_errors(self, errors: Array) -> Array:
        """Change of the logarithm of the ratio by errors, (frame, cell). [1]"""
        common, each = np.split(errors, [len(self.errors)])
        parts, _, cells = self.pattern.shape
        local = (each.reshape(parts, 1, cells) * self.pattern).sum(axis=0)
        return np.asarray(np.tensordot(common, self.errors, axes=1) + local)


class RigidityUnknowns(NamedTuple):
    """Values of all unknowns, or a change of them.

    Attributes
    ----------
    errors : Array
        (error,), those of the pattern last, part by part.
    form : Array
        Of the gap, (cell,). [um]
    motion : Array
        Of the pin, (frame, motion). [um]
    """

    errors: Array
    form: Array
    motion: Array


def solve_equations(
    equations: RatioEquations,
    prior: Array,
    rest: Array,
    at: RigidityUnknowns,
    *,
    pattern: Array | None = None,
) -> tuple[RigidityUnknowns, Array, Array]:
    """Solve the equations of all frames together.

    Parameters
    ----------
    equations : RatioEquations
    prior : array, (error, error)
        Covariance of the errors, without those of the pattern.
    rest : array, (frame, cell)
        Measured less expected logarithm of the ratio. [1]
    at : RigidityUnknowns
        Where the equations hold; the priors draw towards zero.
    pattern : array, (cell, cell), optional
        Covariance of each part of the pattern, where the equations have one.

    Returns
    -------
    change : RigidityUnknowns
    covariance : array, (error, error)
        Of all errors with the run.
    scatter : array, (error, error)
        The part of it by noise, which is new in every run. The rest is what the priors leave.

    Examples
    --------
    A shift of the ratio at one film is a displacement; its error stays as it was:

    >>> x = np.linspace(-8, 8, 40)
    >>> gap = gap_of_pin(x, np.tile([-6.0, 6.0], 20), 33.5, clearance_std=2.0)
    >>> still = np.full((20, 40), 0.1)
    >>> equations = RatioEquations(still, 0 * still[None] + 1, 1e-6 + 0 * still, *gap)
    >>> at = RigidityUnknowns(np.zeros(1), np.zeros(40), np.zeros((20, 5)))
    >>> _, covariance, _ = solve_equations(equations, np.array([[1e-4]]), 0 * still, at)
    >>> round(float(covariance[0, 0] / 1e-4), 1)
    1.0
    """
    # causes of unit variance; all parts of the pattern have the same root
    cells, roots, whitening = len(equations.form), [], []
    for covariance, count in ((prior, 1), (pattern, len(equations.pattern))):
        if covariance is not None:
            one = covariance_root(covariance)
            roots += [one] * count
            whitening += [np.linalg.pinv(one)] * count
    causes, root = roots[0].shape[1], block_diag(*roots)
    shown, pull, solved = _add_frames(equations, roots, rest, at.motion)

    # in the order causes, form, pattern
    form = slice(causes, causes + cells)
    errors = np.r_[:causes, form.stop : len(pull)]
    known, start = np.eye(len(pull)), np.zeros(len(pull))
    known[form, form] = np.linalg.inv(equations.form)
    start[form], start[errors] = at.form, block_diag(*whitening) @ at.errors
    inverse = np.linalg.inv(known + shown)
    change = inverse @ (pull - known @ start)
    motion = solved[..., -1] - solved[..., :-1] @ change
    scatter = inverse @ shown @ inverse
    found = RigidityUnknowns(root @ change[errors], change[form], motion)
    whole, scatter = (root @ one[np.ix_(errors, errors)] @ root.T for one in (inverse, scatter))
    return found, whole, scatter


def _add_frames(
    equations: RatioEquations, roots: Sequence[Array], rest: Array, motion: Array
) -> tuple[Array, Array, Array]:
    """Information of all frames on causes, form and pattern; its product with them; motion by them.

    The last are those of each frame by all of these, and by the rest, (frame, motion, unknown + 1).
    """
    weight = 1 / equations.variance
    common = np.einsum("efc,en->nfc", equations.errors, roots[0], optimize=True)

    # form and pattern act in each cell alone, all other causes in every one
    acts = [equations.slope, *equations.pattern]
    bases = [np.eye(len(equations.form)), *roots[1:]]
    local = list(zip(acts, bases, strict=True))
    beside = [np.einsum("fc,nfc->nc", weight * act, common) @ base for act, base in local]
    rows = [[common.reshape(len(common), -1) @ (weight * common).reshape(len(common), -1).T]]
    rows[0] += beside
    for (act, base), mixed in zip(local, beside, strict=True):
        sums = [(weight * act * other).sum(axis=0)[:, None] * of for other, of in local]
        rows.append([mixed.T, *(base.T @ each for each in sums)])
    shown = np.block(rows)
    of_cells = [(weight * act * rest).sum(axis=0) @ base for act, base in local]
    pull = np.concatenate([np.tensordot(common, weight * rest, axes=2), *of_cells])

    # the position of each frame is eliminated
    each = equations.motion_std**-2.0
    own = equations.motion * equations.slope[:, None]
    weighted = own * weight[:, None]
    parts = [np.einsum("fmc,nfc->fmn", weighted, common)]
    parts += [(weighted * act[:, None]) @ base for act, base in local]
    right = (weighted @ rest[..., None]) - (each * motion)[..., None]
    known = own @ np.swapaxes(weighted, 1, 2) + np.diag(each)
    solved = np.linalg.solve(known, np.concatenate([*parts, right], axis=2))
    taken = np.tensordot(np.concatenate(parts, axis=2), solved, axes=((0, 1), (0, 1)))
    return shown - taken[:, :-1], pull - taken[:, -1], solved


def gap_of_pin(
    along: Array, across: Array, radius: float, *, clearance_std: float, flattening: float = 0.0
) -> tuple[Array, Array, Array]:
    """Motion of a pin in its bore, and what is known of the form of the gap.

    Parameters
    ----------
    along, across : array, (cell,)
        Positions along sliding and along the axis, from the load line. [mm]
    radius : float
        `PinView.radius`. [mm]
    clearance_std : float
        Standard deviation of the radial clearance by the radii. [um]
    flattening : float
        As for `estimate_errors`. [um]

    Returns
    -------
    motion, motion_std, form : array
        As in `RatioEquations`.

    Examples
    --------
    Tilts count as films at the edge of the image; the last motion is a bend:

    >>> x, z = np.meshgrid(np.linspace(-8, 8, 12), np.linspace(-6, 6, 10))
    >>> motion, std, form = gap_of_pin(x.ravel(), z.ravel(), 33.5, clearance_std=3.0)
    >>> motion.shape, form.shape, float(std[-1])
    ((5, 120), (120, 120), 0.01)
    """
    phi = along / radius
    u, v = along / np.abs(along).max(), across / np.abs(across).max()
    cosine, sine = np.cos(phi), np.sin(phi)
    motion = np.stack([-cosine, -sine, -v * cosine, -v * sine, u**2])
    roundness, bend = np.hypot(_ROUNDNESS, flattening), np.hypot(_BEND, flattening)
    powers = ((2, 0), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (4, 0))
    shapes = np.stack([clearance_std * (1 - cosine), *(roundness * u**a * v**b for a, b in powers)])
    form = shapes.T @ shapes + _MARKS**2 * np.eye(along.size)
    return motion, np.array([_FREE] * 4 + [bend]), form
