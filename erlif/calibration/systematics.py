"""Errors that the frames do not show, as further parameters of a calibration (GUM, type B).

Each parameter of the terms of `erlif.core.terms` has a standard deviation, and the derivative of
the logarithm of the ratio by it follows from the curve of the calibration. What grows during the
run is multiplied by the share t of it that has passed, the course between two fixtures by
4 t (1 - t): it is known at both ends. A change of the ratio that a run shows is a further parameter
of the term ratio: a drift that grows, or a step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from erlif.calibration.regression import Reabsorption
from erlif.core.arrays import Array, Mask
from erlif.core.terms import PARAMETERS, RISE, STEP, TERMS, Acts, Parameter, Where

_THINNEST = 0.01  # um: film below which the light is not extrapolated

USUAL_LEVEL = 0.4, 0.4
"""Median light of both cameras over their full scale, where no frames show it. [1]"""


@dataclass(frozen=True)
class Systematics:
    """Errors that the frames do not show.

    Attributes
    ----------
    terms : tuple[str, ...]
        Key of the term of each parameter, (parameter,).
    parameters : tuple[Parameter, ...]
        (parameter,).
    covariance : Array
        Covariance of the parameters, (parameter, parameter). [1; um for a position]
    cross : Array
        Covariance of the errors of the calibration (row) and of the parameters (column).
    light : tuple[float, float]
        Light of both bands that a share of 1 stands for, over the light per um of a very thin film
        in band 1. [um]
    level : tuple[float, float]
        Median light of both cameras over their full scale. [1]
    passed : float
        Share of the run that has passed. [1]
    start : float
        Share of the run that had passed when a step came. [1]
    fit_covariance : Array | None
        Covariance of the calibration where a run has lowered it; None: that of the fixture.
    value : Array | None
        What a run adds to the parameters of the calibration and to these; None: nothing.
    frame : tuple[int, int]
        Rows and columns of the picture. [px]
    before : Array | None
        Covariance of the parameters of the calibration and of these before the run had shown
        anything of them; None where it has not.
    scatter : Array | None
        The part of the same covariance after the run that is new in every run, by noise.
    """

    terms: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    covariance: Array
    cross: Array
    light: tuple[float, float]
    level: tuple[float, float] = USUAL_LEVEL
    passed: float = 1.0
    start: float = 0.0
    fit_covariance: Array | None = None
    value: Array | None = None
    frame: tuple[int, int] = (2, 2)
    before: Array | None = None
    scatter: Array | None = None

    @classmethod
    def of(
        cls,
        widths: dict[str, float],
        *,
        parameters: int,
        light: tuple[float, float] = (1.0, 1.0),
        level: tuple[float, float] = USUAL_LEVEL,
        frame: tuple[int, int] = (2, 2),
    ) -> Systematics:
        """Errors of given widths.

        Parameters
        ----------
        widths : dict of str to float
            Standard deviation of each term of `erlif.core.terms.TERMS`; one that is not named has
            no parameter, one of 0 has no error until a run measures it. [1; um for a position]
        parameters : int
            Of the calibration, its departure included.
        light, level, frame : optional
            As the attributes.

        Returns
        -------
        Systematics
            Without a parameter where nothing has an error.
        """
        rows = [(key, one) for key in TERMS if key in widths for one in TERMS[key].parameters]
        terms = np.array([key for key, _ in rows])
        correlation = np.where(
            np.equal.outer(terms, terms), [TERMS[key].correlation for key in terms], 0.0
        )
        np.fill_diagonal(correlation, 1.0)
        std = np.array([widths[key] for key in terms])
        return cls(
            tuple(key for key, _ in rows),
            tuple(one for _, one in rows),
            correlation * std[:, None] * std,
            np.zeros((parameters, len(rows))),
            light,
            level,
            frame=frame,
        )

    def __bool__(self) -> bool:
        return bool(self.terms)

    @property
    def widths(self) -> dict[str, float]:
        """Standard deviation of each term, that of its first parameter. [1; um for a position]"""
        std = np.sqrt(np.diag(self.covariance))
        return {term: float(std[self.terms.index(term)]) for term in self.terms}

    @property
    def rise(self) -> float:
        """Width of the change of the ratio of all films alike during the run. [1]"""
        return float(np.sqrt(np.diag(self.covariance)[self._rises].sum()))

    @property
    def _rises(self) -> npt.NDArray[np.intp]:
        """Numbers of the parameters of `rise`."""
        return np.flatnonzero([one is RISE for one in self.parameters])

    @property
    def grows_apart(self) -> bool:
        """Whether errors that grow during the run are uncorrelated with all other errors."""
        grows = np.array([one.acts is Acts.RISING for one in self.parameters], bool)
        return not (self.covariance[np.ix_(grows, ~grows)].any() or self.cross[:, grows].any())

    @property
    def varies(self) -> Mask:
        """Parameters that act differently during the run, (parameter,)."""
        return np.array([one.acts is not Acts.ALWAYS for one in self.parameters], bool)

    @property
    def placed(self) -> npt.NDArray[np.intp]:
        """Numbers of the parameters that depend on the place in the picture."""
        return np.flatnonzero([one.placed for one in self.parameters])

    def weight_at(self, passed: npt.ArrayLike) -> Array:
        """Factors of the parameters when shares of the run have passed, (parameter, ...). [1]"""
        share = np.asarray(passed, float)
        factors = {
            Acts.ALWAYS: 1.0,
            Acts.RISING: share,
            Acts.STEPPED: share >= self.start,
            Acts.BETWEEN: 4 * share * (1 - share),
        }
        rows = np.empty((len(self.parameters), *share.shape))
        for n, parameter in enumerate(self.parameters):
            rows[n] = factors[parameter.acts]
        return rows

    def place(self, term: str, parameter: Parameter) -> int:
        """Number of a parameter of a term."""
        return list(zip(self.terms, self.parameters, strict=True)).index((term, parameter))

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
            parameters=tuple(self.parameters[n] for n in kept),
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

    def with_errors(
        self,
        covariance: Array,
        value: Array | None = None,
        *,
        before: Array | None = None,
        scatter: Array | None = None,
    ) -> Systematics:
        """Return a copy with the errors that remain after those of the run were estimated.

        Parameters
        ----------
        covariance : array
            Of the parameters of the calibration, then of these.
        value : array, optional
            What the run adds to them.
        before, scatter : array, optional
            The same covariance before the run, and the part of it that is new in every run.

        Returns
        -------
        Systematics
        """
        found = self._with_covariance(covariance)
        return replace(found, value=value, before=before, scatter=scatter)

    def _with_covariance(self, covariance: Array) -> Systematics:
        fitted = len(self.cross)
        return replace(
            self,
            covariance=covariance[fitted:, fitted:],
            cross=covariance[:fitted, fitted:],
            fit_covariance=covariance[:fitted, :fitted],
        )

    @property
    def without_run(self) -> Systematics:
        """Systematics as they were before the run had shown anything of them."""
        if self.before is None:
            return self
        earlier = self._with_covariance(self.before)
        return replace(earlier, value=None, before=None, scatter=None)

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
        rises, before = self._rises, self.rise
        std = np.sqrt(np.diag(self.covariance))[rises]
        alone = np.array([self.terms[n] == "bleaching" for n in rises], float)
        share = std / before if before else alone
        covariance, cross = self.covariance.copy(), self.cross.copy()
        covariance[rises, :] = covariance[:, rises] = cross[:, rises] = 0.0
        covariance[rises, rises] = (share * width) ** 2
        return replace(self, covariance=covariance, cross=cross)

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
        added = RISE if start is None else STEP
        found, constant = self.with_parameter("ratio", added, size**2), own[0]
        if start is not None:
            covariance = found.covariance
            covariance[constant, constant] += size**2
            covariance[-1, -1] *= 2
            covariance[constant, -1] = covariance[-1, constant] = -(size**2)
        return replace(found, start=self.start if start is None else start)

    def with_parameter(self, term: str, parameter: Parameter, variance: float) -> Systematics:
        """Return a copy with one more parameter, as the last, independent of all others."""
        covariance = np.pad(self.covariance, (0, 1))
        covariance[-1, -1] = variance
        both = self.before, self.scatter
        before, scatter = (None if one is None else np.pad(one, (0, 1)) for one in both)
        return replace(
            self,
            terms=(*self.terms, term),
            parameters=(*self.parameters, parameter),
            covariance=covariance,
            cross=np.pad(self.cross, ((0, 0), (0, 1))),
            value=None if self.value is None else np.append(self.value, 0.0),
            before=before,
            scatter=scatter,
        )

    def gradient(
        self,
        thickness: npt.ArrayLike,
        model: Reabsorption,
        slope: Array,
        change: Array,
        *,
        of: Literal["ratio", "light"] = "ratio",
        illumination: Array | float = 1.0,
        passed: Array | float | None = None,
        place: tuple[Array, Array] | None = None,
    ) -> Array:
        """Derivatives by the parameters, (parameter, ...).

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
        of : {"ratio", "light"}
            Of which the logarithm is derived: the ratio, or the light of camera 1, without what
            changes the light of all films alike, or is a background.
        illumination : array, optional
            Over that of the median light. [1]
        passed : array, optional
            Share of the run that has passed, with the axes of the films; default: the attribute.
        place : (array, array), optional
            Columns and rows of the films in the picture; films anywhere in it have the root mean
            square over it. [px]

        Returns
        -------
        array
            By each parameter at its full size, times its factor at that share.
        """
        film = np.asarray(thickness, float)
        lit = np.maximum(film, _THINNEST)
        light, wall = model.light(lit), model.with_wall
        reabsorbed = model.parameters[1] - model.parameters[2]
        if place is not None:
            x, y = (
                2 * np.asarray(at, float) / (size - 1) - 1
                for at, size in zip(place, self.frame[::-1], strict=True)
            )
            place = x, y
        one = illumination * light.signal
        at = Where(
            film=film,
            slope=slope,
            change=change,
            light=light.signal,
            illumination=illumination,
            one=one,
            two=one * np.exp(model.predict(film)),
            unit=self.light,
            level=self.level,
            by_dye_2=1 + reabsorbed * model.gradient(film)[1],
            light_by_dye_2=reabsorbed * light.gradient[0],
            by_wall=wall.ratio(film).by_reflectance,
            light_by_share=lit * light.slope - 1,
            light_by_wall=wall.light(lit).gradient[-1],
            passed=np.full([1] * film.ndim, self.passed) if passed is None else passed,
            place=place,
        )
        rows = np.empty((len(self.parameters), *film.shape))
        for n, parameter in enumerate(self.parameters):
            rows[n] = parameter.of_ratio(at) if of == "ratio" else parameter.of_light(at)
        return np.asarray(rows * self.weight_at(at.passed))

    def to_record(self) -> dict[str, Any]:
        """Fields for a file."""
        fields = {"terms": self.terms, "kinds": [one.name for one in self.parameters], **vars(self)}
        return {
            name: value.tolist() if isinstance(value, np.ndarray) else value
            for name, value in fields.items()
            if value is not None and name != "parameters"
        }

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Systematics:
        """Systematics of the fields that `to_record` gives.

        Raises
        ------
        ValueError
            If this version does not know one of the terms.
        """
        names = list(zip(record["terms"], record["kinds"], strict=True))
        if unknown := set(names) - set(PARAMETERS):
            term, _ = min(unknown)
            raise ValueError(f"its systematics have a term that this version does not know, {term}")
        size = len(names)
        one, two = record["light"]
        level_one, level_two = record.get("level", USUAL_LEVEL)
        rows, columns = record.get("frame", (2, 2))
        return cls(
            terms=tuple(term for term, _ in names),
            parameters=tuple(PARAMETERS[name] for name in names),
            covariance=np.asarray(record["covariance"], float).reshape(size, size),
            cross=np.asarray(record["cross"], float).reshape(-1, size),
            light=(float(one), float(two)),
            level=(float(level_one), float(level_two)),
            passed=float(record["passed"]),
            start=float(record.get("start", 0.0)),
            frame=(int(rows), int(columns)),
            **{
                name: np.asarray(record[name], float)
                for name in ("fit_covariance", "value", "before", "scatter")
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

    def anywhere(self, covariance: Array) -> Array:
        """Covariance for films whose place in the picture is not known.

        Over the picture, changes with the place have a mean of 0 and are independent.
        """
        own = len(covariance) - len(self.parameters) + self.placed
        found, variance = covariance.copy(), np.diag(covariance)[own]
        found[own, :] = found[:, own] = 0.0
        found[own, own] = variance
        return found


# A calibration whose fixture has no error but those that its frames show.
NO_SYSTEMATICS = Systematics.of({}, parameters=0)
