"""Mechanism under which the film follows the speed: its kind, and the zero of its angle."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.core.notes import Note, warn
from erlif.io.settings import CrankRockerSettings, RunSettings, SinusoidalSettings
from erlif.kinematics.locate import joint_speed
from erlif.models.mechanism import SliderCrank
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

# Share of the variance of the film up to which the stated mechanism is not doubted.
_FOLLOWED = 0.05

# Gain in the logarithm of the likelihood of another kind over another zero of the stated one.
_GAIN_OVER_ZERO = 20.0


class Motion(NamedTuple):
    """Speed of a joint or slider as a function of an angle.

    Attributes
    ----------
    what : str
        What turns by the angle.
    speed : Callable[[Array], Array]
        Angle [rad] to the speed, in any unit.
    period : float
        Angle after which the size of the speed repeats: half a turn of a slider, whose strokes are
        alike. [degree]
    cure : str
        What to correct in run.toml where the angle is off.
    """

    what: str
    speed: Callable[[Array], Array]
    period: float = 360.0
    cure: str = "zero or direction in [encoder]"


class Fit(NamedTuple):
    """The zero of an angle at which the film follows the speed best.

    Attributes
    ----------
    off : float
        Error of the angle as it is. [degree]
    left : float
        Share of the variance of the film that the speed leaves there.
    plain : float
        The same by the angle as it is; 1 where the film falls as the speed rises.
    """

    off: float
    left: float
    plain: float


def note_mechanism(evidence: Evidence) -> Iterator[Note]:
    """Warn of a mechanism or an angle by which the film does not follow the speed.

    Parameters
    ----------
    evidence : Evidence

    Yields
    ------
    Note
        Of the angle only where the energies show that rows and pairs are in order.
    """
    settings = evidence.run.settings
    own, angle = describe_motion(settings), evidence.logged("crank_angle")
    levels, (order, odd) = evidence.levels[:MOST], evidence.order or (None, np.array([]))
    if own is None or angle is None or order is not None or odd.size:
        return
    load = evidence.logged("joint_load")
    weight = np.ones(angle.size) if load is None else np.median(load) / load
    radians, weight = np.radians(angle[:MOST]), weight[:MOST]

    found, alone = (fit_zero(radians, one, levels, own) for one in (weight, np.ones_like(weight)))
    if found is None or alone is None:
        return
    # not every film follows the load of its log
    found = found._replace(plain=min(found.plain, alone.plain))
    others = () if found.plain < _FOLLOWED else describe_others(settings)
    fits = [fit for one in others if (fit := fit_zero(radians, weight, levels, one))]
    best = min(fits, key=lambda fit: fit.left, default=found)
    if _is_of_other_kind(levels, found, best):
        yield warn(
            "mechanism",
            f"the film follows the speed of a {others[0].what} ({1 - best.left:.0%} of its "
            f"variance), not that of [mechanism] ({max(1 - found.plain, 0):.0%}): the speed is "
            "wrong. Correct kind in [mechanism]",
        )
        return
    if evidence.order and found.left < LEFT and is_better(levels, found.plain, found.left):
        yield warn(
            "encoder",
            f"the film follows the speed of a {own.what} angle {found.off:+.0f} deg off: speed and "
            f"position are wrong. Correct {own.cure}",
        )


def _is_of_other_kind(levels: Array, own: Fit, other: Fit) -> bool:
    """Whether the film follows the other kind, and no angle of the own kind as well."""
    better = is_better(levels, own.plain, other.left)
    alone = is_better(levels, own.left, other.left, gain=_GAIN_OVER_ZERO, factor=2.0)
    return other.left < LEFT and better and alone


def describe_motion(settings: RunSettings) -> Motion | None:
    """Motion by [mechanism]; None where the reach of the encoder shows a wrong zero, or none is."""
    match settings.mechanism:
        case SinusoidalSettings():
            mid = "zero in [encoder]: the reading at mid-stroke on the way out"
            return Motion("drive", np.cos, 180.0, mid)
        case CrankRockerSettings() if not _is_on_crank(settings):
            return None
    links = settings.linkage
    if links is None:
        return None
    return Motion("crank", partial(joint_speed, build_linkage(links), crank_speed=1.0))


def describe_others(settings: RunSettings) -> tuple[Motion, ...]:
    """Motions of the other kind of linkage, where the encoder is on the crank."""
    links = settings.linkage
    if links is None or not _is_on_crank(settings):
        return ()
    if isinstance(links, CrankRockerSettings):
        if links.crank >= links.coupler:
            return ()
        linkage = SliderCrank(links.crank, links.coupler)
        return (Motion("slider-crank", partial(joint_speed, linkage, crank_speed=1.0)),)

    def rocks(angle: Array, second: float, late: float) -> Array:
        return np.asarray(np.sin(angle) + second * np.sin(2 * angle + late))

    # two strokes a turn of unequal duration: about those of rockers of any lengths
    shapes = itertools.product((0.1, 0.2), (-math.pi / 6, 0.0, math.pi / 6))
    return tuple(
        Motion("crank-rocker", partial(rocks, second=second, late=late)) for second, late in shapes
    )


def _is_on_crank(settings: RunSettings) -> bool:
    return settings.encoder is not None and settings.encoder.mounted_on == "crank"


def fit_zero(angle: Array, weight: Array, levels: Array, motion: Motion) -> Fit | None:
    """Find the error of the angle of a motion by a film that follows its speed.

    Parameters
    ----------
    angle : array, (frame,)
        By the log. [rad]
    weight : array, (frame,)
        Of the speed: one over the load. [1]
    levels : array, (frame,)
        Logarithm of the ratio, which rises with the film; NaN where it is not known.
    motion : Motion

    Returns
    -------
    Fit or None
        Within half a period; a film that squeeze delays is one of the angle as it is. None where
        no film changes.

    Examples
    --------
    >>> angle = np.linspace(0, 4 * np.pi, 60)
    >>> film = np.sqrt(np.abs(np.cos(angle))) + 0.01 * np.random.default_rng(1).normal(size=60)
    >>> fit_zero(angle + 0.35, np.ones(60), film, Motion("drive", np.cos, 180.0)).off
    -20.0
    """
    known = np.isfinite(levels)
    if known.sum() < FEWEST or np.nanstd(levels) < FLAT:
        return None
    turns = np.arange(-90, 90) * (motion.period / 180)
    drives = np.abs(motion.speed(angle + np.radians(turns)[:, None])) * weight
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
    return Fit(float(turns[best]), left, plain)
