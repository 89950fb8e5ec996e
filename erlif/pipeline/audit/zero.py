"""Zero of the angle of a slider or crank, at which the film follows the speed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from erlif.core.arrays import Array
from erlif.core.notes import Note, warn
from erlif.io.settings import SinusoidalSettings, SliderCrankSettings
from erlif.kinematics.locate import joint_speed
from erlif.pipeline.audit.energies import FEWEST
from erlif.pipeline.audit.evidence import MOST, Evidence
from erlif.pipeline.audit.film_order import (
    FLAT,
    LEFT,
    is_better,
    rest_share,
    share_as_it_is,
    speed_terms,
)
from erlif.pipeline.physics.joint import build_linkage


def note_zero(evidence: Evidence) -> Iterator[Note]:
    """Warn of an angle at which the film does not follow the speed of slider or crank pin.

    Parameters
    ----------
    evidence : Evidence

    Yields
    ------
    Note
        None where the energies do not show that rows and pairs are in order.
    """
    if evidence.order is None:
        return
    other, odd = evidence.order
    if other is not None or odd.size:
        return

    angle, load = evidence.logged("crank_angle"), evidence.logged("joint_load")
    if angle is None:
        return
    match evidence.run.settings.mechanism:
        case SinusoidalSettings():
            period, what = 180.0, "drive"
            cure = "zero in [encoder]: the reading at mid-stroke on the way out"

            def speed(angle: Array) -> Array:
                return np.abs(np.cos(angle))
        case SliderCrankSettings() as links:
            period, what = 360.0, "crank"
            cure = "zero or direction in [encoder]; the crank is at 0 at the outer dead centre"
            speed = partial(joint_speed, build_linkage(links), crank_speed=1.0)
        case _:
            return
    weight = np.ones_like(angle) if load is None else np.median(load) / load
    radians, levels = np.radians(angle[:MOST]), evidence.levels[:MOST]
    off = find_zero(radians, weight[:MOST], levels, speed=speed, period=period)
    if off is not None:
        yield warn(
            "encoder",
            f"the film follows the speed of a {what} angle {off:+.0f} deg off: speed and position "
            f"are wrong. Correct {cure}",
        )


def find_zero(
    angle: Array,
    weight: Array,
    levels: Array,
    *,
    speed: Callable[[Array], Array],
    period: float,
) -> float | None:
    """Find the error of the angle of slider or crank by a film that follows the speed.

    Parameters
    ----------
    angle : array, (frame,)
        By the log. [rad]
    weight : array, (frame,)
        Of the speed: one over the load. [1]
    levels : array, (frame,)
        Logarithm of the ratio, which rises with the film; NaN where it is not known.
    speed : callable
        Angle to the size of the speed.
    period : float
        Angle after which it repeats: half a turn of a slider, whose strokes are alike. [degree]

    Returns
    -------
    float or None
        Within half a period; None where the film follows the speed of the angle as it is, a film
        that squeeze delays included, or no speed. [degree]

    Examples
    --------
    >>> def speed(angle): return np.abs(np.cos(angle))
    >>> angle = np.linspace(0, 4 * np.pi, 60)
    >>> film = np.sqrt(np.abs(np.cos(angle))) + 0.01 * np.random.default_rng(1).normal(size=60)
    >>> find_zero(angle + 0.35, np.ones(60), film, speed=speed, period=180.0)
    -20.0
    """
    known = np.isfinite(levels)
    if known.sum() < FEWEST or np.nanstd(levels) < FLAT:
        return None
    turns = np.arange(-90, 90) * (period / 180)
    drives = speed(angle + np.radians(turns)[:, None]) * weight
    drives /= drives.max(axis=1, keepdims=True)

    # no film falls as the speed rises
    slopes = np.cov(levels[known], drives[:, known])[0, 1:]
    shares = np.array([rest_share(speed_terms(one), levels) for one in drives])
    shares[slopes < 0] = 1.0
    best = int(np.argmin(shares))
    left = float(shares[best])

    plain = float(shares[turns == 0][0])
    if plain < 1:
        plain = share_as_it_is(drives[turns == 0][0], levels, left)
    return float(turns[best]) if left < LEFT and is_better(levels, plain, left) else None
