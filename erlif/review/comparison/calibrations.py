"""Errors of the calibrations of several runs, and which of them the runs have in common.

Runs with one fixture have its errors in common: those of the fit, and position and size of the
fixture. What lies between the fixture and a run is new in each of them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from erlif.calibration import NO_SYSTEMATICS, RunCurve, record_calibration
from erlif.core.arrays import Array
from erlif.core.terms import TERMS


def key_of(calibration: RunCurve) -> str:
    """Hash of a calibration, the same for all runs with one fixture.

    Parameters
    ----------
    calibration : RunCurve

    Returns
    -------
    str
    """
    record = record_calibration(replace(calibration, systematics=NO_SYSTEMATICS))
    return hashlib.sha256(record.encode()).hexdigest()


def joint_covariance(calibrations: Sequence[RunCurve], keys: Sequence[str]) -> Array:
    """Covariance of the errors of the calibrations of several runs.

    Parameters
    ----------
    calibrations : sequence of RunCurve
        One for each run, with its systematics.
    keys : sequence of str
        As `key_of` gives them; runs with one key have one fixture.

    Returns
    -------
    array, (all parameters, all parameters)
        The parameters of each run in the order of its `RatioCurve.full_covariance`.

    Examples
    --------
    Two runs with one fixture have its three parameters in common, and nothing else:

    >>> from erlif.calibration import Systematics
    >>> from erlif.show.plots import example_calibration
    >>> systematics = Systematics.of({"ratio": 0.01}, parameters=3)
    >>> run = replace(example_calibration(), systematics=systematics)
    >>> whole = joint_covariance([run, run], ["a", "a"])
    >>> np.allclose(whole[:3, 4:7], run.covariance), float(whole[3, 7])
    (True, 0.0)
    """
    blocks = [
        [
            one.full_covariance
            if n == m
            else _common(one, other)
            if keys[n] == keys[m]
            else np.zeros((len(one.full_covariance), len(other.full_covariance)))
            for m, other in enumerate(calibrations)
        ]
        for n, one in enumerate(calibrations)
    ]
    return np.block(blocks)


def _common(one: RunCurve, other: RunCurve) -> Array:
    """Covariance of the errors of two runs (parameter, parameter) by those of their fixture."""
    places = _of_fixture(one), _of_fixture(other)
    both = [kind for kind in places[0] if kind in places[1]]
    here, there = (np.array([place[kind] for kind in both], int) for place in places)
    fixture = one.full_covariance[np.ix_(here, here)]

    # a background that was measured depends on the errors of the fixture as well
    std = np.sqrt(np.diag(fixture))
    scale = np.where(std > 0, std, 1.0)
    inverse = np.linalg.pinv(fixture / np.outer(scale, scale), hermitian=True)
    share = inverse / np.outer(scale, scale)
    return np.asarray(one.full_covariance[:, here] @ share @ other.full_covariance[there])


def _of_fixture(calibration: RunCurve) -> dict[str | int, int]:
    """Places of the errors of the fixture in the full covariance."""
    fitted, terms = len(calibration.fitted_covariance), calibration.systematics.terms
    places: dict[str | int, int] = {n: n for n in range(fitted)}
    for n, term in enumerate(terms):
        if TERMS[term].file == "fixture":
            places[calibration.systematics.parameters[n].name] = fitted + n
    return places


def calibration_var(
    one: Array, other: Array, calibrations: tuple[RunCurve, RunCurve], *, same: bool
) -> Array:
    """Variance that calibrations add to the difference of two films.

    Errors of one fixture cancel as far as the films are equal; those of two add, and so does what
    lies between a fixture and each run.

    Parameters
    ----------
    one, other : array, (..., parameter)
        Change of each film with the parameters of its calibration.
    calibrations : (RunCurve, RunCurve)
    same : bool
        Whether both are of one fixture.

    Returns
    -------
    array, (...)
        [um2]
    """
    covariance = joint_covariance(calibrations, ["one", "one" if same else "other"])
    return np.maximum(quadratic(np.concatenate([-one, other], axis=-1), covariance), 0.0)


def quadratic(gradient: Array, covariance: Array) -> Array:
    """Variance of values whose change with the parameters is the last axis of the gradient."""
    return np.asarray(np.einsum("...i,ij,...j->...", gradient, covariance, gradient))
