"""Which contact the surfaces of a run have: the simplest gap that its curvatures allow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from erlif.core.arrays import Array
from erlif.trend.gap import MISFIT, GapMinimum, GapShape

# Curvature from which a gap is curved. [std]
_CURVED = 3.0


def choose_contact(triggers: Sequence[Mapping[GapShape, GapMinimum]]) -> GapShape:
    """The simplest gap that the curvatures of all triggers of a run allow.

    Noise is new at every trigger, marks of the surfaces are taken as common to all.

    Parameters
    ----------
    triggers : sequence of mapping of GapShape to GapMinimum
        With the gap of a point contact, or of a journal.

    Returns
    -------
    GapShape
        A plateau where the maps of most triggers have one and depart from a point contact. A point
        contact where the mean curvature across sliding is above three standard deviations, a line
        contact where only that along sliding is, else a plane. A journal where it is bent along its
        axis by so much, else a line contact, as where no trigger has a gap.

    Examples
    --------
    >>> from erlif.trend import FilmNumber
    >>> small, none = np.full(2, 1e-4), np.zeros(2)
    >>> film = FilmNumber(1.0, 0.1, 0.1, none)
    >>> bent = GapMinimum(*(film,) * 4, none, 0.0, np.array([3.0, 2.0]), small, small)
    >>> str(choose_contact([{GapShape.POINT: bent}]))
    'point'
    >>> bent = bent._replace(bend=np.array([3.0, 0.01]))
    >>> str(choose_contact([{GapShape.POINT: bent}]))
    'line'
    """
    choice = ContactChoice()
    for one in triggers:
        choice.add(*bent_gap(one), level=has_plateau(one))
    return choice.contact


def bent_gap(minima: Mapping[GapShape, GapMinimum]) -> tuple[GapShape, GapMinimum]:
    """The gap by whose bend the contact is chosen: that of a point contact, else of a journal.

    Parameters
    ----------
    minima : mapping of GapShape to GapMinimum
        With one of both.

    Returns
    -------
    contact : GapShape
    gap : GapMinimum

    Examples
    --------
    >>> bent_gap({GapShape.LINE: None, GapShape.JOURNAL: None})
    (<GapShape.JOURNAL: 'journal'>, None)
    """
    contact = GapShape.POINT if GapShape.POINT in minima else GapShape.JOURNAL
    return contact, minima[contact]


def has_plateau(minima: Mapping[GapShape, GapMinimum]) -> bool:
    """Whether a map departs from a point contact, and has a plateau.

    Parameters
    ----------
    minima : mapping of GapShape to GapMinimum

    Returns
    -------
    bool

    Examples
    --------
    >>> has_plateau({})
    False
    """
    flat = minima.get(GapShape.PLATEAU)
    return flat is not None and flat.misfit < MISFIT < minima[GapShape.POINT].misfit


@dataclass
class ContactChoice:
    """Sums over the triggers of a run, from which `choose_contact` takes its choice.

    Attributes
    ----------
    bent : GapShape
        The gap of the triggers: of a journal or of a point contact.
    weight : Array
        Sum of the weights of its bends, (2,). [1/um2]
    value : Array
        Of the weighted bends. [1/um]
    random_var : Array
        Of their variances by noise, with the square of the weight. [1/um2]
    surface_std : Array
        Of their standard deviations by the surfaces, which all triggers share. [1/um]
    triggers : int
        With a gap.
    level : int
        Those with a plateau.
    """

    bent: GapShape = GapShape.POINT
    weight: Array = field(default_factory=lambda: np.zeros(2))
    value: Array = field(default_factory=lambda: np.zeros(2))
    random_var: Array = field(default_factory=lambda: np.zeros(2))
    surface_std: Array = field(default_factory=lambda: np.zeros(2))
    triggers: int = 0
    level: int = 0

    def add(self, contact: GapShape, gap: GapMinimum, *, level: bool = False) -> None:
        """Add the gap of `bent_gap` at one more trigger, and whether it has a plateau."""
        self.bent = contact
        if np.isfinite(gap.bend).all():
            self.triggers += 1
            self.level += level
            weight = 1 / (gap.bend_random_var + gap.bend_surface_var)
            self.weight += weight
            self.value += weight * gap.bend
            self.random_var += weight**2 * gap.bend_random_var
            self.surface_std += weight * np.sqrt(gap.bend_surface_var)

    @property
    def contact(self) -> GapShape:
        """The contact that the triggers so far allow."""
        if not self.weight.any():
            return GapShape.LINE
        if 2 * self.level > self.triggers:
            return GapShape.PLATEAU
        variance = self.random_var + self.surface_std**2
        bent = np.abs(self.value) > _CURVED * np.sqrt(variance)
        if self.bent is GapShape.JOURNAL:
            return GapShape.JOURNAL if bent.any() else GapShape.LINE
        along, across = bent
        return GapShape.POINT if across else GapShape.LINE if along else GapShape.PLANE
