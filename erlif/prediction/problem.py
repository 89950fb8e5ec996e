"""Frames, unknowns and start of a fit: from orbits of the pin to what was measured of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array
from erlif.models.reynolds.full_film import FullFilm
from erlif.models.reynolds.journal import turn_vectors
from erlif.prediction.least_squares import CONVERGED, LeastSquares, Observations, Unknowns
from erlif.prediction.measured import MeasuredMotion
from erlif.prediction.orbits import (
    ATMOSPHERE,
    HELD_ERROR,
    HELD_SCATTER,
    HeldOrbits,
    Orbits,
    film_change,
)

# Step of each unknown for derivatives, and its lower and upper bound.
_KINDS = {
    "fluidity": (1e-3, 0.0, 1e3),
    "start_film": (1e-3, -23.0, np.inf),
    "start_attitude": (1e-4, -1.5, 1.5),
    "rest": (1e-3, -0.9, 0.9),
    "stiffness": (2e-2, 2.0, 12.0),
    "cavitation_pressure": (1e-2, 0.0, 100.0),
    "load_line": (1e-4, -1.0, 1.0),
    "drift": (1e-2, -2.0, 2.0),
}

# Standard deviation of the direction of a pin on a spring at the start of its lead. [rad]
_ATTITUDE_STD = 0.3


@dataclass(frozen=True)
class FrameSteps:
    """Step of the motion and trigger of each frame.

    Attributes
    ----------
    steps : numpy.ndarray
        Step of the motion, (frame,).
    trigger : numpy.ndarray
        Trigger, negative for a frame that was not measured, (frame,).
    measured : numpy.ndarray
        Triggers with a measured value.
    count : int
        Number of triggers.
    """

    steps: npt.NDArray[np.integer[Any]]
    trigger: npt.NDArray[np.integer[Any]]
    measured: npt.NDArray[np.integer[Any]]
    count: int

    @classmethod
    def of(
        cls,
        measured: MeasuredMotion,
        steps: npt.NDArray[np.integer[Any]],
        trigger: npt.NDArray[np.integer[Any]] | None,
    ) -> FrameSteps:
        """Frames of measured positions; each frame is a trigger by default."""
        which = np.arange(len(steps)) if trigger is None else np.asarray(trigger)
        count = len(measured.value)
        seen = np.bincount(which[which >= 0], minlength=count)[:count] > 0
        return cls(np.asarray(steps), which, np.flatnonzero(measured.known & seen), count)

    def average(self, values: Array) -> Array:
        """Mean over the frames of each trigger, (case, frame, ...) to (case, trigger, ...)."""
        used = self.trigger >= 0
        order = np.argsort(self.trigger[used], kind="stable")
        ranked = self.trigger[used][order]
        first = np.flatnonzero(np.diff(ranked, prepend=-1))
        total = np.add.reduceat(values[:, used][:, order], first, axis=1)
        frames = np.diff(np.append(first, ranked.size))
        mean = np.full((len(values), self.count, *values.shape[2:]), np.nan)
        mean[:, ranked[first]] = total / frames.reshape(1, -1, *(1,) * (values.ndim - 2))
        return mean


@dataclass(frozen=True)
class Problem:
    """Model of the orbit of a pin, and the frames in which it was measured.

    Attributes
    ----------
    orbits : Orbits
        The model.
    frames : FrameSteps
        Frames and triggers.
    measured : MeasuredMotion
        Measured positions or minima.
    sideways : str
        "free", "guided" or "spring".
    """

    orbits: Orbits
    frames: FrameSteps
    measured: MeasuredMotion
    sideways: str

    def observations(self) -> Observations:
        """The measured triggers, with the error of the model of a held pin."""
        measured, good = self.measured, self.frames.measured
        value, shared = measured.value[good], measured.shared[good]
        random = measured.random_cov[good]
        if isinstance(self.orbits, HeldOrbits):
            clearance = self.orbits.journal.least_clearance
            doubts = film_change(value, clearance, HELD_ERROR)[..., np.newaxis]
            if self.orbits.doubts is not None:
                # a pin of which only minima are known stays on the load line
                axes = self.orbits.doubts[self.frames.steps, : value.shape[1]]
                doubts = self.frames.average(axes[np.newaxis])[0, good]
            shared = np.concatenate([shared, doubts], axis=2)
            film = clearance - np.sqrt(np.sum(value**2, axis=1))
            scatter = (HELD_SCATTER * film) ** 2
            random = random + scatter[:, np.newaxis, np.newaxis] * np.eye(value.shape[1])
        return Observations(value, random, shared)

    def unknowns(self, fitted: Sequence[str], known: Mapping[str, float]) -> Unknowns:
        """Unknowns of the search with their start, and the fixed values.

        `known` are standard deviations of what is known beforehand: load_line, drift and, of a held
        pin, cavitation_pressure. What is known exactly is not searched.
        """
        start = self._start()
        names = ["fluidity"] if "viscosity" in fitted else []
        names += ["start_film"]
        if self.measured.is_position:
            names += {"free": ["start_attitude"], "guided": ["rest"]}.get(
                self.sideways, ["start_attitude", "rest", "stiffness"]
            )
            names += ["load_line"] if known.get("load_line", 0.0) > 0 else []
        suction = "cavitation_pressure" in fitted or known.get("cavitation_pressure", 0.0) > 0
        names += ["cavitation_pressure"] if suction and self.sideways != "free" else []
        names += ["drift"] if known.get("drift", 0.0) > 0 else []
        step, low, high = np.array([_KINDS[name] for name in names]).T
        high[names.index("start_film")] = np.log(0.9999 * self.orbits.journal.least_clearance)
        units = {"load_line": self.orbits.journal.radius, "cavitation_pressure": ATMOSPHERE}
        widths = {name: std / units.get(name, 1.0) or np.inf for name, std in known.items()}
        if isinstance(self.orbits, HeldOrbits) and self.orbits.lead is not None:
            widths["start_attitude"] = _ATTITUDE_STD  # the lead may leave nothing of it
        fixed = {"fluidity": 1.0, "load_line": 0.0}
        if self.sideways != "guided":
            fixed["start_attitude"] = start["start_attitude"]
        if self.sideways != "free":
            fixed["rest"] = 0.0
        return Unknowns(
            names=tuple(names),
            start=np.array([start[name] for name in names]),
            step=step,
            low=low,
            high=high,
            expected=np.array([start[n] if n == "cavitation_pressure" else 0.0 for n in names]),
            expected_std=np.array([widths.get(name, np.inf) for name in names]),
            fixed={name: value for name, value in fixed.items() if name not in names},
        )

    def impulse(self) -> Array:
        """Integral of the load since the first step, (frame,). [N s]"""
        motion = self.orbits.motion
        parts = 0.5 * np.diff(motion.time) * (motion.load[1:] + motion.load[:-1])
        return np.asarray(np.append(0.0, np.cumsum(parts))[self.frames.steps])

    def _start(self) -> dict[str, float]:
        """Initial values of the search: pure squeeze through the measured films."""
        journal, motion = self.orbits.journal, self.orbits.motion
        good = self.frames.measured
        place = self.measured.value[good]
        distance = np.clip(
            np.hypot(*place.T) if self.measured.is_position else place[:, 0], 0, None
        )
        clearance = journal.least_clearance
        film = np.clip(1 - distance / clearance, 1e-5, 0.9999)
        impulse = self.frames.average(self.impulse()[np.newaxis])[0, good]

        # eps / sqrt(1 - eps^2) rises with the impulse over K; the ends let oil out besides
        eccentricity = 1 - film
        ratio = eccentricity / np.sqrt(1 - eccentricity**2)
        weight = film**1.5
        slope, first = (
            np.polyfit(impulse, ratio, 1, w=weight) if np.ptp(impulse) > 0 else (0, ratio[0])
        )
        full = FullFilm.of(replace(journal, foundation=None))
        middle = full.damping(np.array([np.median(film)]))[0, 0] * clearance
        long = journal.squeeze_constant * (1 - (1 - np.median(film)) ** 2) ** -1.5
        fluidity = float(np.clip(slope * journal.squeeze_constant * middle / long, 0.02, 50.0))
        begin = max(float(first), 1e-3)
        start_film = clearance * (1 - begin / np.hypot(1, begin))

        # the direction at the start, from the trigger that was seen first
        attitude = 0.5 * float(motion.angle[0])
        rest = 0.0
        if self.measured.is_position:
            early = int(np.argmin(impulse))
            attitude = float(np.arctan2(place[early, 1], place[early, 0]))
            rest = float(np.mean(place[:, 1])) / journal.clearance
        if self.sideways != "free":
            start_film = clearance * float(film[int(np.argmin(impulse))])
            fluidity = 1.0
        return {
            "fluidity": fluidity,
            "start_film": float(np.log(start_film)),
            "start_attitude": attitude,
            "rest": rest,
            "stiffness": 7.0,
            "cavitation_pressure": -journal.cavitation_pressure / ATMOSPHERE,
            "load_line": 0.0,
            "drift": 0.0,
        }

    def frame_positions(self, sets: Array, unknowns: Unknowns) -> Array:
        """Displacements at every frame in the coordinates of the image, (case, frame, axis). [m]"""
        columns = unknowns.by_name(sets)
        line = columns.pop("load_line")
        orbit = self.orbits.follow(columns)[:, self.frames.steps]

        # the true load line lies at the angle `line` from the assumed one
        return turn_vectors(orbit, line[:, np.newaxis])

    def pose(self, unknowns: Unknowns, tolerance: float = CONVERGED) -> LeastSquares:
        """Set up the search of some unknowns, with a tolerance of chi-square."""
        model = partial(self.predict, unknowns=unknowns)
        return LeastSquares(self.observations(), unknowns, model, tolerance)

    def predict(self, sets: Array, unknowns: Unknowns) -> Array:
        """Predicted values of each measured trigger, (case, trigger, axis). [m]"""
        place = self.frame_positions(sets, unknowns)
        if not self.measured.is_position:
            place = np.hypot(place[..., 0], place[..., 1])[..., np.newaxis]
        return self.frames.average(place)[:, self.frames.measured]
