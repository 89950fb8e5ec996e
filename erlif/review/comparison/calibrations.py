"""Errors of the calibrations of several runs, and which of them the runs have in common.

Runs with one fixture have its errors in common: those of the fit, and position and size of the
fixture. Runs of one rig have the rest in common but for what changes from run to run
(`erlif.core.terms.Term.apart`): wall, linearity and lag of the cameras, most of the scale of the
ratio and of the light that is not film. Temperature and bleaching are new in every run.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import xarray as xr

from erlif.calibration import NO_SYSTEMATICS, RunCurve, record_calibration
from erlif.core.arrays import Array
from erlif.core.terms import TERMS
from erlif.io.files import settings_of

# Entries of the cameras that change the ratio.
_OF_CAMERAS = "band", "gain", "bit_depth"

# Tables of the settings that make a rig, and what of them is the duty of a run.
_OF_RIG = "optics", "joint", "contact"
_OF_DUTY = {"load", "slide_to_roll"}


@dataclass(frozen=True)
class RunErrors:
    """Errors of the calibration of a run.

    Attributes
    ----------
    curve : RunCurve
        With its systematics.
    fixture : str
        Equal for runs with one fixture.
    rig : Mapping[str, str]
        What makes the rig, by its name; equal for runs of one rig. "calibration" is the fixture.
    widths : Mapping[str, float]
        Standard deviation of each term before the run has measured any. [1]
    serials : str
        Serial numbers of the cameras; empty where none is known.
    date : str
        Day of the run; empty where it is not recorded.
    drift : float
        Change of the ratio between calibrations of the rig from day to day. [1]
    """

    curve: RunCurve
    fixture: str
    rig: Mapping[str, str]
    widths: Mapping[str, float]
    serials: str = ""
    date: str = ""
    drift: float = 0.0

    @classmethod
    def of(cls, film: xr.Dataset, curve: RunCurve, *, drift: float = 0.0) -> RunErrors:
        """Errors of the run of a film, by its settings and attributes."""
        settings, fixture = settings_of(film), key_of(curve)
        date = str(film.attrs.get("recorded", ""))
        serials = json.loads(str(film.attrs.get("camera_serials", '["", ""]')))

        rig = {"calibration": fixture}
        for table, serial in zip(("camera1", "camera2"), serials, strict=True):
            camera = getattr(settings, table)
            rig |= {f"{name} of [{table}]": repr(getattr(camera, name)) for name in _OF_CAMERAS}
            rig[f"serial of [{table}]"] = serial
        for name in _OF_RIG:
            table = getattr(settings, name)
            rig[f"[{name}]"] = repr(table.model_dump(exclude=_OF_DUTY)) if table else ""

        known = ", ".join(filter(None, serials))
        return cls(curve, fixture, rig, settings.systematics.shares, known, date, drift)

    @cached_property
    def before(self) -> RunErrors:
        """Errors before the run had shown anything of them."""
        systematics = self.curve.systematics
        if systematics.before is None:
            return self
        return replace(self, curve=replace(self.curve, systematics=systematics.without_run))

    @property
    def taken_out(self) -> bool:
        """Whether errors that the gap of the run has shown were taken out of its films."""
        systematics = self.curve.systematics
        return systematics.value is not None and systematics.before is not None

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the errors, (parameter, parameter).

        A change with the place is not taken out. Its square, which is known of one run, is not
        that of the change between two: it counts as before the run.
        """
        whole = self.curve.full_covariance.copy()
        if self.taken_out:
            placed = np.ix_(*[self.curve.systematics.placed + self._fitted] * 2)
            whole[placed] = self.before.curve.full_covariance[placed]
        return whole

    @cached_property
    def left(self) -> Array:
        """What the run leaves of each error that it had before, (parameter, parameter).

        Where errors are taken out by a linear estimate, that is their covariance after it over that
        before it. All of a change with the place is left, and of every error where none is.
        """
        own = np.eye(len(self.covariance))
        if not self.taken_out:
            return own
        scale, before = np.outer(self._scale, self._scale), self.before.curve.full_covariance
        inverse = np.linalg.pinv(before / scale, hermitian=True) / scale
        left = self.curve.full_covariance @ inverse
        placed = self.curve.systematics.placed + self._fitted
        left[placed] = own[placed]
        return left

    @cached_property
    def by_form(self) -> Array:
        """Root of the covariance by the form of the gap, (parameter, parameter).

        Two runs of one joint have that form in common. It is what is neither left of the errors
        before the run nor new in it, as noise.
        """
        scatter = self.curve.systematics.scatter
        assert scatter is not None
        before = self.before.curve.full_covariance
        rest = self.covariance - self.left @ before @ self.left.T - scatter
        placed = self.curve.systematics.placed + self._fitted
        rest[placed], rest[:, placed] = 0.0, 0.0
        size, axes = np.linalg.eigh(rest / np.outer(self._scale, self._scale))
        root = axes * np.sqrt(np.maximum(size, 0.0)) @ axes.T
        return np.asarray(self._scale[:, None] * root)

    @property
    def _scale(self) -> Array:
        """Size of the errors before the run, of one that has none 1."""
        std = np.sqrt(np.diag(self.before.curve.full_covariance))
        return np.where(std > 0, std, 1.0)

    @property
    def _fitted(self) -> int:
        """Number of the parameters that were fitted to the fixture."""
        return len(self.curve.fitted_covariance)


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


def joint_covariance(runs: Sequence[RunErrors]) -> Array:
    """Covariance of the errors of the calibrations of several runs.

    Parameters
    ----------
    runs : sequence of RunErrors

    Returns
    -------
    array, (all parameters, all parameters)
        The parameters of each run in the order of its `RatioCurve.full_covariance`.

    Examples
    --------
    Two runs with one fixture have its three parameters in common. Of a scale of the ratio of 1 %,
    0.3 % is new in the second run where the rig is the same:

    >>> from erlif.calibration import Systematics
    >>> from erlif.show.plots import example_calibration
    >>> systematics = Systematics.of({"ratio": 0.01}, parameters=3)
    >>> run = replace(example_calibration(), systematics=systematics)
    >>> one, other = (RunErrors(run, "a", {"rig": n}, {"ratio": 0.01}) for n in "12")
    >>> whole = joint_covariance([one, other])
    >>> np.allclose(whole[:3, 4:7], run.covariance), float(whole[3, 7])
    (True, 0.0)
    >>> change = np.array([-1, 1]) @ joint_covariance([one, one])[3::4, 3::4] @ np.array([-1, 1])
    >>> round(float(np.sqrt(change)), 6)
    0.003
    """
    blocks = [
        [one.covariance if n == m else _between(one, other) for m, other in enumerate(runs)]
        for n, one in enumerate(runs)
    ]
    return np.block(blocks)


def _between(one: RunErrors, other: RunErrors) -> Array:
    """Covariance of the errors of two runs, (parameter, parameter)."""
    if one.fixture != other.fixture:
        return np.zeros((len(one.covariance), len(other.covariance)))
    if not (one.taken_out and other.taken_out):
        return _common(one, other)
    left = one.left @ _common(one.before, other.before) @ other.left.T
    return np.asarray(left + one.by_form @ other.by_form.T if one.rig == other.rig else left)


def _common(one: RunErrors, other: RunErrors) -> Array:
    """Covariance of the errors of two runs (parameter, parameter) by what they have in common."""
    places = _common_places(one), _common_places(other)
    both = [kind for kind in places[0] if kind in places[1]]
    if one.rig != other.rig:
        both = [kind for kind in both if _of_fixture(kind[0])]
    here, there = (np.array([place[kind] for kind in both], int) for place in places)
    whole, its = one.curve.full_covariance, other.curve.full_covariance
    std, its_std = (np.sqrt(np.diag(each)[at]) for each, at in ((whole, here), (its, there)))
    share: Array = np.sqrt(np.array([_shared(kind[0], one, other) for kind in both], float))

    # what a run has measured, such as a background, depends on these errors as well
    scale, its_scale = (np.where(each > 0, each, 1.0) for each in (std, its_std))
    correlation = whole[np.ix_(here, here)] / np.outer(scale, scale)
    its_correlation = its[np.ix_(there, there)] / np.outer(its_scale, its_scale)
    pull = whole[:, here] / scale @ np.linalg.pinv(correlation, hermitian=True)
    its_pull = its[:, there] / its_scale @ np.linalg.pinv(its_correlation, hermitian=True)
    return np.asarray(pull @ (share[:, None] * correlation * share) @ its_pull.T)


def _of_fixture(term: str) -> bool:
    """Whether a term is one of the fixture; an error of the fit has none."""
    return not term or TERMS[term].file == "fixture"


def _shared(term: str, one: RunErrors, other: RunErrors) -> float:
    """Share of the variances of a parameter of two runs that they have in common."""
    if _of_fixture(term):
        return 1.0
    changes = float(TERMS[term].apart or 0.0) / 100
    if TERMS[term].between and one.date != other.date:
        changes = max(changes, one.drift, other.drift)
    width = min(run.widths[term] for run in (one, other))
    return max(1 - 0.5 * (changes / width) ** 2, 0.0) if width > 0 else 0.0


def _common_places(run: RunErrors) -> dict[tuple[str, str], int]:
    """Places in the full covariance of errors that runs can have in common, by term and name.

    Errors of the fit have no term. What a run has measured of a term is its own.
    """
    systematics = run.curve.systematics
    fitted = len(run.curve.fitted_covariance)
    places = {("", str(n)): n for n in range(fitted)}
    for key in dict.fromkeys(systematics.terms):
        term, own = TERMS[key], systematics.places(key)
        others = np.delete(systematics.covariance[own], own, axis=1)
        found = (
            (systematics.fit_covariance is not None and systematics.before is not None)
            or own.size > len(term.parameters)
            or bool(others.any() or systematics.cross[:, own].any())
        )
        if _of_fixture(key) or (term.apart is not None and not found):
            for n in own:
                places[key, systematics.parameters[n].name] = fitted + int(n)
    return places


def difference_var(one: Array, other: Array, runs: tuple[RunErrors, RunErrors]) -> Array:
    """Variance that calibrations add to the difference of two films.

    Errors in common cancel as far as the films are equal, others add. A square of what the gap of a
    run shows, and was not taken out, is new in each run: where the errors before the runs make less
    of a difference, they count.

    Parameters
    ----------
    one, other : array, (..., parameter)
        Change of each film with the parameters of its calibration.
    runs : (RunErrors, RunErrors)

    Returns
    -------
    array, (...)
        [um2]
    """
    gradient = np.concatenate([-one, other], axis=-1)
    variances = [quadratic(gradient, joint_covariance(each)) for each in _views(runs)]
    return np.asarray(np.maximum(np.min(variances, axis=0), 0.0))


def _views(runs: tuple[RunErrors, RunErrors]) -> list[tuple[RunErrors, RunErrors]]:
    """Errors of two runs as they are, and before the runs where nothing was taken out."""
    one, other = runs
    if any(run.curve.systematics.value is not None for run in runs):
        return [runs]
    return [runs, (one.before, other.before)]


def largest_term(one: Array, other: Array, runs: tuple[RunErrors, RunErrors]) -> str:
    """Term of `erlif.core.terms.SOURCES` that adds most to the difference of two films.

    Parameters
    ----------
    one, other : array, (parameter,)
        As for `difference_var`.
    runs : (RunErrors, RunErrors)

    Returns
    -------
    str
        Its key.
    """
    keys = [
        key
        for run in runs
        for key in (
            *["calibration"] * len(run.curve.fitted_covariance),
            *run.curve.systematics.terms,
        )
    ]
    gradient = np.concatenate([-one, other])
    covariances = [joint_covariance(each) for each in _views(runs)]
    covariance = min(covariances, key=lambda each: float(quadratic(gradient, each)))
    parts = {
        key: float(quadratic(np.where(np.array(keys) == key, gradient, 0.0), covariance))
        for key in keys
    }
    return max(parts, key=parts.__getitem__)


def quadratic(gradient: Array, covariance: Array) -> Array:
    """Variance of values whose change with the parameters is the last axis of the gradient."""
    return np.asarray(np.einsum("...i,ij,...j->...", gradient, covariance, gradient))
