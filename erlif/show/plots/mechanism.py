"""The mechanism in its true position at each trigger."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.quiver import Quiver

from erlif.core.arrays import Array
from erlif.io.files import settings_of
from erlif.io.settings import RotationSettings, SinusoidalSettings
from erlif.models.mechanism import CrankRocker
from erlif.pipeline.physics.joint import build_linkage
from erlif.show.plots.style import MINIMUM, MUTED, OUTWARD, RETURN, given_or_new, pt, styled

_TURN = np.linspace(0.0, 2 * np.pi, 181)  # rad
_STEP = 1e-3  # rad of the drive, for the direction of motion
_ARROW = 0.28  # length of the longest arrow over the size of the mechanism
_MARGIN = 0.12  # beside the mechanism, of its size


@dataclass(frozen=True)
class Joints:
    """Places of the joints of a mechanism over the angle of the drive.

    Attributes
    ----------
    places : array, (angle, joint, 2)
        x and y of the joints that links connect, in their order. [m]
    fixed : array, (n, 2)
        Pivots. [m]
    moving : int
        Joint whose motion is shown.
    """

    places: Array
    fixed: Array
    moving: int


def pin_places(linkage: CrankRocker, crank_angle: Array) -> Array:
    """Joint centres of a crank-rocker from crank pivot to rocker pivot.

    Parameters
    ----------
    linkage : CrankRocker
        The four lengths. [m]
    crank_angle : array, (n,)
        Crank angles. [rad]

    Returns
    -------
    array, (n, 4, 2)
        x along the ground link and y of crank pivot, crank pin, rocker pin and rocker pivot. [m]

    Examples
    --------
    >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    >>> crank, coupler, rocker = np.diff(pin_places(rig, np.array([1.0]))[0], axis=0)
    >>> print(f"{np.hypot(*coupler):.2f} {np.hypot(*rocker):.2f}")
    0.44 0.26
    """
    psi = np.asarray(linkage.rocker_angle(crank_angle))
    places = np.zeros((len(psi), 4, 2))
    places[:, 1] = linkage.crank * np.stack([np.cos(crank_angle), np.sin(crank_angle)], axis=1)
    places[:, 2] = linkage.rocker * np.stack([-np.cos(psi), np.sin(psi)], axis=1)
    places[:, 2:, 0] += linkage.ground
    return places


def place_joints(film: xr.Dataset, angle: Array) -> Joints | None:
    """Find the joints of the mechanism of a film.

    Parameters
    ----------
    angle : array, (angle,)
        Angle of the drive. [rad]

    Returns
    -------
    Joints or None
        None without a mechanism.

    Examples
    --------
    The links keep their lengths, here the rocker of 26 cm:

    >>> from erlif.show.plots import example_film
    >>> joints = place_joints(example_film(), np.linspace(0, 6, 50))
    >>> rocker = joints.places[:, 2] - joints.places[:, 3]
    >>> bool(np.allclose(np.hypot(*rocker.T), 0.26))
    True
    """
    settings = settings_of(film)
    zero = np.zeros_like(angle)
    origin = np.stack([zero, zero], axis=1)
    if isinstance(settings.mechanism, RotationSettings):
        contact = settings.mechanism.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return Joints(np.stack([origin, contact], axis=1), np.zeros((1, 2)), 1)
    if isinstance(settings.mechanism, SinusoidalSettings):
        place = np.stack([settings.mechanism.stroke / 2 * np.sin(angle), zero], axis=1)
        return Joints(place[:, None], np.zeros((0, 2)), 0)
    if settings.linkage is None:
        return None

    links = build_linkage(settings.linkage)
    if isinstance(links, CrankRocker):
        return Joints(pin_places(links, angle), np.array([[0.0, 0.0], [links.ground, 0.0]]), 2)
    crank_pin = links.crank * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    slider = np.stack([np.asarray(links.slider_position(angle)), zero], axis=1)
    return Joints(np.stack([origin, crank_pin, slider], axis=1), np.zeros((1, 2)), 2)


@dataclass(frozen=True)
class MechanismView:
    """The mechanism on its axes, which `show` moves.

    Attributes
    ----------
    film : Dataset
        The film whose triggers are shown.
    links : Line2D
        Lines between the joints, which are markers.
    arrow : Quiver
        Direction of motion of the moving joint.
    top : float
        Greatest speed of the moving joint. [m/rad]
    size : float
        Size of the mechanism. [m]
    """

    film: xr.Dataset
    links: Line2D
    arrow: Quiver
    top: float
    size: float

    def show(self, trigger: int) -> None:
        """Move the mechanism to a trigger.

        Parameters
        ----------
        trigger : int
            Number of the trigger, counted from 0.
        """
        angle = np.radians(float(self.film.crank_angle[trigger]))
        joints = place_joints(self.film, np.array([angle - _STEP, angle, angle + _STEP]))
        assert joints is not None  # draw_mechanism has found them
        before, now, after = joints.places
        self.links.set_data(now[:, 0], now[:, 1])

        # crank and triggers turn the same way: the angle of the drive always rises
        motion = (after - before)[joints.moving] / (2 * _STEP)
        length = _ARROW * self.size * motion / self.top
        self.arrow.set_offsets(now[joints.moving][None])
        self.arrow.set_UVC([length[0]], [length[1]])
        rising = "stroke" not in self.film or float(self.film.stroke[trigger]) > 0
        self.arrow.set_color(OUTWARD if rising else RETURN)


@styled
def draw_mechanism(
    film: xr.Dataset, *, trigger: int, ax: Axes | None = None
) -> MechanismView | None:
    """Draw the mechanism at one trigger, with the path and the direction of its moving joint.

    Arguments as in `erlif.plots`.

    Returns
    -------
    MechanismView or None
        None, and no figure, without a mechanism or without an angle of the drive.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> view = draw_mechanism(example_film(), trigger=0)
    >>> view.links.get_xdata().size
    4
    """
    path = place_joints(film, _TURN)
    if path is None or "crank_angle" not in film:
        return None
    ax = given_or_new(ax, film)
    low, high = path.places.min(axis=(0, 1)), path.places.max(axis=(0, 1))
    size = float((high - low).max())
    moving = path.places[:, path.moving]
    top = float(np.hypot(*np.gradient(moving, _TURN, axis=0).T).max())

    ax.plot(*moving.T, color=MUTED, linewidth=pt(0.6), linestyle=":", zorder=1)
    ax.plot(*path.fixed.T, "^", color=MUTED, markersize=pt(8), zorder=2)
    (links,) = ax.plot([], [], "o-", color=MINIMUM, linewidth=pt(1.6), zorder=3)
    in_data: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1}
    arrow = ax.quiver([0.0], [0.0], [0.0], [0.0], width=0.012, zorder=4, **in_data)
    middle, room = (low[0] + high[0]) / 2, (0.5 + _MARGIN) * size
    ax.set(xlim=(middle - room, middle + room), aspect="equal")
    ax.set(ylim=(low[1] - _MARGIN * size, high[1] + _MARGIN * size))
    ax.set_axis_off()
    view = MechanismView(film, links, arrow, top, size)
    view.show(trigger)
    return view
