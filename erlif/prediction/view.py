"""The gap of the joint where the camera sees it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.models.reynolds import Journal


@dataclass(frozen=True)
class ImageLine:
    """Places of the image along the sliding direction.

    Attributes
    ----------
    place : Array
        Distance of each pixel from the load line, along sliding. (pixel,) [m]
    region : slice
        Pixels of the region of interest.
    """

    place: Array
    region: slice


def gap_in_view(
    displacement_load: Array, displacement_side: Array, journal: Journal, place: Array
) -> Array:
    """Film thickness between round bodies with parallel axes.

    Parameters
    ----------
    displacement_load, displacement_side : array, (...)
        Displacement of the pin along the load line and sideways. [m]
    journal : Journal
        Radii of pin and bushing.
    place : array, (pixel,)
        Distance from the load line along sliding. [m]

    Returns
    -------
    array, (..., pixel)
        c - ex cos(phi) - ey sin(phi), with phi the distance over the radius of the film. [m]

    Examples
    --------
    A pin 5 um from the bushing: 10 mm from the load line the gap is wider by 10 um:

    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    >>> gap_in_view(np.array(225e-6), np.array(0.0), joint, np.array([0.0, 0.01])).round(6)
    array([5.0e-06, 1.5e-05])
    """
    phi = place / journal.radius
    load, side = np.asarray(displacement_load), np.asarray(displacement_side)
    along = load[..., np.newaxis] * np.cos(phi) + side[..., np.newaxis] * np.sin(phi)
    return np.asarray(journal.clearance - along)


def summarise_gap(
    displacement_load: Array, displacement_side: Array, journal: Journal, view: ImageLine
) -> tuple[Array, Array]:
    """Minimum and mean of the gap over the region of interest.

    Parameters
    ----------
    displacement_load, displacement_side, journal
        As for `gap_in_view`.
    view : ImageLine
        Where the image lies.

    Returns
    -------
    minimum, mean : array, (...)
        The minimum is that of the gap, not of its pixels. [m]

    Examples
    --------
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    >>> view = ImageLine(np.linspace(-0.01, 0.01, 501), slice(501))
    >>> minimum, mean = summarise_gap(np.array([225e-6]), np.array([0.0]), joint, view)
    >>> minimum.round(8), mean.round(8)
    (array([5.e-06]), array([8.34e-06]))
    """
    phi = view.place[view.region] / journal.radius
    load, side = np.asarray(displacement_load), np.asarray(displacement_side)
    thinnest = np.clip(np.arctan2(side, load), phi.min(), phi.max())
    minimum = journal.clearance - load * np.cos(thinnest) - side * np.sin(thinnest)
    mean = journal.clearance - load * np.cos(phi).mean() - side * np.sin(phi).mean()
    return np.asarray(minimum), np.asarray(mean)
