"""Errors that the frames do not show, as further parameters of a calibration (GUM, type B).

Each parameter has a standard deviation, and the derivative of the logarithm of the ratio by it
follows from the curve of the calibration:

================  ==================================================================
ratio             gain, exposure and filters between fixture and run: 1
lag               light that a camera keeps from the frame before: 1
temperature       brightness of both dyes, between fixture and run and during it: 1
bleaching         brightness of both dyes: 1; their absorption: -h s
wall              reflectance behind the film: the derivative of the model by R
linearity         counts that a camera loses in proportion to its light: -L1, +L2
background        light that is not film, in both bands: -1/L1, +1/L2
position          origin of the fixture's profile: s
size              scale of the fixture's profile: h s
course            change between the fixtures before and after a run, off a straight line: D
later             curve of the fixture after a run, beyond the error of that before it: 1
================  ==================================================================

with the film h, the slope s of the curve, the light L of each band over its median in the run and
the change D of the curve from fixture to fixture. What grows during the run is multiplied by the
share t of it that has passed, the course by 4 t (1 - t): it is known at both ends. A change of the
ratio that a run shows is a further parameter of the term ratio: a drift that grows, or a step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from erlif.calibration.regression import LASER_SHARE, Reabsorption
from erlif.core.arrays import Array, Mask

# Parameters of each term. What is "rising" grows from nothing at the first frame of the run.
TERMS: dict[str, tuple[str, ...]] = {
    "ratio": ("constant",),
    "lag": ("constant",),
    "temperature": ("constant", "rising constant"),
    "bleaching": ("rising constant", "rising absorption"),
    "wall": ("wall",),
    "linearity": ("light 1", "light 2"),
    "background": ("background 1", "background 2"),
    "position": ("position",),
    "size": ("size",),
    "course": ("course",),
    "later": ("rising constant",),
}

# Kinds of the ratio that a run adds, with a step or a drift (`Systematics.with_course`).
COURSES = (("ratio", "rising constant"), ("ratio", "stepped constant"))

# Correlation of the background of both bands where it is not measured: fluorescence of a window
# and light that leaks through a filter change little from 580 to 610 nm.
ALIKE = 0.9

_THINNEST = 0.01  # um: film below which the light is not extrapolated
_LEVEL = 0.4  # median light of a run, of full scale


@dataclass(frozen=True)
class Systematics:
    """Errors that the frames do not show.

    Attributes
    ----------
    terms : tuple[str, ...]
        Term of each parameter, (parameter,).
    kinds : tuple[str, ...]
        How each acts on the ratio, (parameter,).
    covariance : Array
        Covariance of the parameters, (parameter, parameter). [1; um for a position]
    cross : Array
        Covariance of the errors of the calibration (row) and of the parameters (column).
    light : tuple[float, float]
        Light of both bands that a share of 1 stands for, over the light per um of a very thin film
        in band 1. [um]
    passed : float
        Share of the run that has passed. [1]
    start : float
        Share of the run that had passed when a step came. [1]
    fit_covariance : Array | None
        Covariance of the calibration where a run has lowered it; None: that of the fixture.
    value : Array | None
        What a run adds to the parameters of the calibration and to these; None: nothing.
    """

    terms: tuple[str, ...]
    kinds: tuple[str, ...]
    covariance: Array
    cross: Array
    light: tuple[float, float]
    passed: float = 1.0
    start: float = 0.0
    fit_covariance: Array | None = None
    value: Array | None = None

    @classmethod
    def of(
        cls,
        widths: dict[str, float],
        *,
        parameters: int,
        light: tuple[float, float] = (1.0, 1.0),
    ) -> Systematics:
        """Errors of given widths.

        Parameters
        ----------
        widths : dict of str to float
            Standard deviation of each term of `TERMS`; one that is not named has no parameter, one
            of 0 has no error until a run measures it. [1; um for a position]
        parameters : int
            Of the calibration, its departure included.
        light : tuple of float, optional
            As the attribute.

        Returns
        -------
        Systematics
            Without a parameter where nothing has an error.
        """
        rows = [
            (term, kind, widths[term])
            for term, kinds in TERMS.items()
            for kind in kinds
            if term in widths
        ]
        terms, kinds = (tuple(str(row[n]) for row in rows) for n in (0, 1))
        std = np.array([width for _, _, width in rows])
        covariance = np.diag(std**2)
        found = cls(terms, kinds, covariance, np.zeros((parameters, len(rows))), light)
        if (shares := found.places("background")).size:
            one, two = shares
            covariance[one, two] = covariance[two, one] = ALIKE * std[one] * std[two]
        return found

    def __bool__(self) -> bool:
        return bool(self.terms)

    @property
    def widths(self) -> dict[str, float]:
        """Standard deviation of each term, that of its first parameter. [1; um for a position]"""
        std = np.sqrt(np.diag(self.covariance))
        return {term: float(std[self.terms.index(term)]) for term in self.terms}

    @property
    def rising(self) -> Mask:
        """Parameters that grow during the run, (parameter,)."""
        return np.array([kind.startswith("rising") for kind in self.kinds], bool)

    @property
    def rise(self) -> float:
        """Width of the change of the ratio of all films alike during the run. [1]"""
        rises = [kind == "rising constant" for kind in self.kinds]
        return float(np.sqrt(np.diag(self.covariance)[rises].sum()))

    @property
    def grows_apart(self) -> bool:
        """Whether errors that grow during the run are uncorrelated with all other errors."""
        grows = self.rising
        return not (self.covariance[np.ix_(grows, ~grows)].any() or self.cross[:, grows].any())

    @property
    def varies(self) -> Mask:
        """Parameters that act differently during the run, (parameter,)."""
        return np.array(
            [kind.startswith(("rising", "stepped", "course")) for kind in self.kinds], bool
        )

    def weight_at(self, passed: npt.ArrayLike) -> Array:
        """Factors of the parameters when shares of the run have passed, (parameter, ...). [1]"""
        share = np.asarray(passed, float)
        shape = (-1, *[1] * share.ndim)
        stepped = np.array([kind.startswith("stepped") for kind in self.kinds], bool)
        cases = [each.reshape(shape) for each in (self.rising, stepped, self.varies)]
        factors = [share, share >= self.start, 4 * share * (1 - share)]
        return np.select(cases, factors, 1.0)

    def place(self, term: str, kind: str) -> int:
        """Number of the parameter of a term that acts in one way."""
        return list(zip(self.terms, self.kinds, strict=True)).index((term, kind))

    def places(self, term: str) -> npt.NDArray[np.intp]:
        """Numbers of the parameters of a term; empty if it is not among the terms."""
        return np.flatnonzero([name == term for name in self.terms])

    @property
    def prior(self) -> Systematics:
        """Systematics without the background: terms with an error that no run measures."""
        kept = self._of_prior
        return replace(
            self,
            terms=tuple(self.terms[n] for n in kept),
            kinds=tuple(self.kinds[n] for n in kept),
            covariance=self.covariance[np.ix_(kept, kept)],
            cross=self.cross[:, kept],
            value=None
            if self.value is None
            else np.concatenate(
                [self.value[: len(self.cross)], self.value[len(self.cross) + kept]]
            ),
        )

    @property
    def _of_prior(self) -> npt.NDArray[np.intp]:
        """Numbers of the parameters of `prior`."""
        other = np.array([term != "background" for term in self.terms], bool)
        return np.flatnonzero(other & (np.diag(self.covariance) > 0))

    def with_background(self, measured: Systematics) -> Systematics:
        """Return a copy with the measured error of the background.

        Parameters
        ----------
        measured : Systematics
            The two shares alone; rows of its `cross` are the parameters of the calibration, then
            those of `prior`.

        Returns
        -------
        Systematics
            With the same parameters, shares of the same light.
        """
        parameters, shares, kept = len(self.cross), self.places("background"), self._of_prior
        scale = np.divide(measured.light, self.light)
        with_fit, with_prior = np.split(scale * measured.cross, [parameters])

        covariance, cross = self.covariance.copy(), self.cross.copy()
        covariance[np.ix_(shares, shares)] = np.outer(scale, scale) * measured.covariance
        covariance[np.ix_(kept, shares)] = with_prior
        covariance[np.ix_(shares, kept)] = with_prior.T
        cross[:, shares] = with_fit
        return replace(self, covariance=covariance, cross=cross)

    def adding(self, term: str, covariance: Array) -> Systematics:
        """Return a copy with `covariance` added to that of the parameters of a term. [1]"""
        own, whole = self.places(term), self.covariance.copy()
        whole[np.ix_(own, own)] += covariance
        return replace(self, covariance=whole)

    def with_errors(self, covariance: Array, value: Array | None = None) -> Systematics:
        """Return a copy with the errors that remain after those of the run were estimated.

        Parameters
        ----------
        covariance : array
            Of the parameters of the calibration, then of these.
        value : array, optional
            What the run adds to them.

        Returns
        -------
        Systematics
        """
        fitted = len(self.cross)
        return replace(
            self,
            covariance=covariance[fitted:, fitted:],
            cross=covariance[:fitted, fitted:],
            fit_covariance=covariance[:fitted, :fitted],
            value=value,
        )

    def with_width(self, kind: str, width: float, *, term: str) -> Systematics:
        """Return a copy with another standard deviation of one parameter of a term. [1]"""
        covariance, n = self.covariance.copy(), self.place(term, kind)
        covariance[n, :] = covariance[:, n] = 0.0
        covariance[n, n] = width**2
        cross = self.cross.copy()
        cross[:, n] = 0.0
        return replace(self, covariance=covariance, cross=cross)

    def with_rise(self, width: float) -> Systematics:
        """Return a copy with another width of the rise of the ratio of all films in the run.

        The terms share it in proportion to their own widths; without any, it is the bleaching's.

        Parameters
        ----------
        width : float
            [1]

        Returns
        -------
        Systematics
        """
        before, found = self.rise, self
        stds = np.sqrt(np.diag(self.covariance))
        for term, kind, std in zip(self.terms, self.kinds, stds, strict=True):
            if kind == "rising constant":
                own = std / before if before else float(term == "bleaching")
                found = found.with_width(kind, own * width, term=term)
        return found

    def with_course(self, size: float, *, start: float | None) -> Systematics:
        """Return a copy with a drift or step of the ratio during the run as last parameter.

        Parameters
        ----------
        size : float
            Root mean square of the change. [1]
        start : float or None
            Share of the run after which a step comes; None for a drift, which grows from nothing at
            the first frame. Which part of the run before and after a step has the ratio of the
            calibration is not known: each has an error of this size, independent of the other.

        Returns
        -------
        Systematics
            Unchanged where the ratio is not among the terms.
        """
        if not (own := self.places("ratio")).size:
            return self
        count, constant = len(self.terms), own[0]
        covariance = np.zeros((count + 1, count + 1))
        covariance[:count, :count] = self.covariance
        covariance[count, count] = size**2
        if start is not None:
            covariance[constant, constant] += size**2
            covariance[count, count] *= 2
            covariance[constant, count] = covariance[count, constant] = -(size**2)
        return replace(
            self,
            terms=(*self.terms, "ratio"),
            kinds=(*self.kinds, "rising constant" if start is None else "stepped constant"),
            covariance=covariance,
            cross=np.column_stack([self.cross, np.zeros(len(self.cross))]),
            start=self.start if start is None else start,
        )

    def gradient(
        self,
        thickness: npt.ArrayLike,
        model: Reabsorption,
        slope: Array,
        change: Array,
        *,
        illumination: Array | float = 1.0,
        passed: Array | float | None = None,
    ) -> Array:
        """Derivatives of the logarithm of the ratio by the parameters, (parameter, ...).

        Parameters
        ----------
        thickness : array
            [um]
        model : Reabsorption
            Of the calibration.
        slope : array
            Derivative of the logarithm of the ratio by thickness. [1/um]
        change : array
            Logarithm of the ratio of this film after the run less that before it. [1]
        illumination : array, optional
            Over that of the median light. [1]
        passed : array, optional
            Share of the run that has passed, with the axes of the films; default: the attribute.

        Returns
        -------
        array
            By each parameter at its full size, times its factor at that share.
        """
        h = np.asarray(thickness, float)
        one = illumination * model.light(np.maximum(h, _THINNEST)).signal
        two = one * np.exp(model.predict(h))
        acts: dict[str, Any] = {
            "constant": np.ones_like(h),
            "absorption": -h * slope,
            "wall": _with_wall(model).before_wall(h).by_reflectance,
            "light 1": -_LEVEL * one / self.light[0],
            "light 2": _LEVEL * two / self.light[1],
            "background 1": -self.light[0] / one,
            "background 2": self.light[1] / two,
            "position": slope,
            "size": h * slope,
            "course": change,
        }
        rows = np.empty((len(self.kinds), *h.shape))
        for n, kind in enumerate(self.kinds):
            rows[n] = acts[_act_of(kind)]
        return self._weigh(rows, passed)

    def _weigh(self, rows: Array, passed: Array | float | None) -> Array:
        """Rows (parameter, ...) times the factors of the parameters."""
        if passed is None:
            passed = np.full([1] * (rows.ndim - 1), self.passed)
        return np.asarray(rows * self.weight_at(passed))

    def light_gradient(
        self,
        thickness: npt.ArrayLike,
        model: Reabsorption,
        *,
        illumination: Array | float = 1.0,
        passed: Array | float | None = None,
    ) -> Array:
        """Derivatives of the logarithm of the light of camera 1, (parameter, ...).

        What changes the light of all films alike, or is a background, is left out.

        Parameters
        ----------
        thickness, model, illumination, passed
            As for `gradient`.

        Returns
        -------
        array
            By each parameter at its full size, times its factor at that share.
        """
        h = np.maximum(np.asarray(thickness, float), _THINNEST)
        light = model.light(h)
        shape = h * light.slope - 1  # of a film that is thicker, or absorbs more, by a share
        acts = {
            "absorption": -shape,
            "wall": _with_wall(model).light(h).gradient[-1],
            "light 1": -_LEVEL * illumination * light.signal / self.light[0],
            "size": shape,
        }
        rows = np.zeros((len(self.kinds), *h.shape))
        for n, kind in enumerate(self.kinds):
            rows[n] = acts.get(_act_of(kind), 0.0)
        return self._weigh(rows, passed)

    def to_record(self) -> dict[str, Any]:
        """Fields for a file."""
        return {
            name: value.tolist() if isinstance(value, np.ndarray) else value
            for name, value in vars(self).items()
            if value is not None
        }

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Systematics:
        """Systematics of the fields that `to_record` gives."""
        size = len(record["terms"])
        one, two = record["light"]
        return cls(
            terms=tuple(map(str, record["terms"])),
            kinds=tuple(map(str, record["kinds"])),
            covariance=np.asarray(record["covariance"], float).reshape(size, size),
            cross=np.asarray(record["cross"], float).reshape(-1, size),
            light=(float(one), float(two)),
            passed=float(record["passed"]),
            start=float(record.get("start", 0.0)),
            **{
                name: np.asarray(record[name], float)
                for name in ("fit_covariance", "value")
                if name in record
            },
        )

    def extend(self, covariance: Array) -> Array:
        """Covariance of a calibration with these as further parameters."""
        if not self:
            return covariance
        if self.fit_covariance is not None:
            covariance = self.fit_covariance
        return np.block([[covariance, self.cross], [self.cross.T, self.covariance]])

    def split(self) -> dict[str, tuple[npt.NDArray[np.intp], Array]]:
        """Numbers of the parameters of each term and their covariance, in their order."""
        places = {term: self.places(term) for term in dict.fromkeys(self.terms)}
        return {term: (own, self.covariance[np.ix_(own, own)]) for term, own in places.items()}


# A calibration whose fixture has no error but those that its frames show.
NO_SYSTEMATICS = Systematics.of({}, parameters=0)


def _act_of(kind: str) -> str:
    """Strip "rising" or "stepped" from a kind: the effect of the parameter at full size."""
    return kind.removeprefix("rising ").removeprefix("stepped ")


def _with_wall(model: Reabsorption) -> Reabsorption:
    """Add the parameters of a black wall to a model that has none."""
    if model.reflects:
        return model
    K, p, q = model.parameters
    return Reabsorption(np.array([K, p, q, LASER_SHARE * q, 0.0]))
