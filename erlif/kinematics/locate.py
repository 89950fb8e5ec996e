"""Position and speed of a linkage at every frame, from the encoder log."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.notes import Note, remark, warn
from erlif.core.products import EncoderLog, require
from erlif.core.variables import FILM
from erlif.kinematics.encoder import (
    Encoder,
    LinkAngle,
    Mechanism,
    choose_link,
    read_link_angle,
)
from erlif.kinematics.folding import FrameColumns, describe_frames, fold_frames
from erlif.models.mechanism import SliderCrank

# Cost per radian beyond half a turn between frames: a slow crank is not a fast one in reverse.
_BACKWARD_COST = 3.0

# Added to steps before their logarithm, so that frames at rest do not decide. [rad]
_EVEN_STEP = 1e-3


def locate_frames(
    log: EncoderLog,
    *,
    mechanism: Mechanism,
    crank_speed: float,
    pin_radius: float | None,
    encoder: Encoder | None = None,
) -> xr.Dataset:
    """Find the position of the mechanism in its cycle at each frame.

    Parameters
    ----------
    log : EncoderLog
        angle (frame) [degree] and number (frame); where logged, time (frame) [s] and angle_rate
        (frame), the rate of the angle [degree s-1].
    mechanism : CrankRocker or SliderCrank
    crank_speed : float
        [rad s-1]
    pin_radius : float or None
        None where it is not known; there is then no sliding speed. [m]
    encoder : Encoder, optional
        Default: on the rocker, its zero found from the dead points.

    Returns
    -------
    xarray.Dataset
        On dim frame: trigger and cycle, counted from 0; encoder_angle [degree]; stroke, +1 where
        the angle rises and -1 where it falls; crank_angle [degree, 0 to 360]; rocker_speed
        [rad s-1, signed]; sliding_speed [m s-1]. For a slider-crank the rocker is the connecting
        rod, and its speed that of the joint between crank and rod.

    Raises
    ------
    EncoderError
        If the linkage cannot reach a logged angle, the angle does not change, or the log does not
        fold into cycles.

    Examples
    --------
    A crank at constant speed, logged every 90 degrees:

    >>> from erlif.models.mechanism import CrankRocker
    >>> mechanism = CrankRocker(0.055, 0.44, 0.26, 0.51)
    >>> log = EncoderLog(xr.Dataset({"number": ("frame", np.arange(4)),
    ...                              "angle": ("frame", [0.0, 90.0, 180.0, 270.0])}))
    >>> cycle = locate_frames(log, mechanism=mechanism, crank_speed=12.0, pin_radius=0.033,
    ...                       encoder=Encoder("crank"))
    >>> cycle.crank_angle.values.round()
    array([  0.,  90., 180., 270.])
    """
    require(log, "angle", "number")

    # on the crank the reading is the crank angle; on the rocker two crank angles fit each reading
    encoder = encoder or Encoder()
    link = read_link_angle(log, mechanism, encoder, crank_speed=crank_speed)
    on_crank = encoder.mounted_on == "crank"
    crank = link.angle if on_crank else _crank_from_swing(link, log, mechanism, encoder)
    fold = fold_frames(crank, log.assign(angle=("frame", link.reading)), encoder, mechanism)

    # the stroke is that of the rod of a slider-crank, or of the rocker
    speed = joint_speed(mechanism, crank, crank_speed)
    angle_rate = choose_link(mechanism, "rocker").speed(crank, crank_speed=crank_speed)
    stroke = np.where(np.asarray(angle_rate) >= 0, 1, -1).astype(np.int8)

    swings = encoder.mounted_on == "rocker" and not link.falling
    columns: FrameColumns = {
        "stroke": (stroke, "" if swings else "stroke, +1 rocker angle rising"),
        "crank_angle": (np.degrees(crank), ""),
        "rocker_speed": (speed, ""),
    }
    if pin_radius is not None:
        columns["sliding_speed"] = (np.abs(speed) * pin_radius, "")
    located = describe_frames(fold, columns, cycle="turn of the crank")
    located["encoder_angle"] = ("frame", link.reading, _describe_encoder(link, encoder))
    if link.zero_std is not None:
        located.attrs["zero_effect"] = _describe_zero_effect(
            link, crank, mechanism, encoder, crank_speed=crank_speed
        )
    return located.assign_attrs(grouping=fold.remark)


def entrained_stroke(mechanism: Mechanism, *, pin_radius: float) -> float:
    """Travel of the entrained oil in half a cycle, pin radius times half the swing.

    Parameters
    ----------
    mechanism : CrankRocker or SliderCrank
    pin_radius : float
        [m]

    Returns
    -------
    float
        Infinite for a slider-crank, whose crank pin turns all the way. [m]

    Examples
    --------
    >>> entrained_stroke(SliderCrank(0.05, 0.2), pin_radius=0.01)
    inf
    """
    if isinstance(mechanism, SliderCrank):
        return math.inf
    low, high = mechanism.limits()
    return pin_radius * (high - low) / 2


def encoder_notes(located: xr.Dataset) -> list[Note]:
    """Make the notes on fitted or detected encoder parameters and on the grouping of frames.

    Parameters
    ----------
    located : xarray.Dataset
        From `locate_frames`.

    Returns
    -------
    list of Note

    Examples
    --------
    >>> angle = ("frame", [1.0], {"zero": 48.1, "zero_std": 0.25})
    >>> str(encoder_notes(xr.Dataset({"encoder_angle": angle}))[0])
    'encoder: zero fitted to the dead points of the linkage, 48.100 ± 0.250 deg'
    """
    attrs = located["encoder_angle"].attrs if "encoder_angle" in located else {}
    texts = []
    if "zero_std" in attrs:
        texts.append(
            f"zero fitted to the dead points of the linkage, {attrs['zero']:.3f} ± "
            f"{attrs['zero_std']:.3f} deg{located.attrs.get('zero_effect', '')}"
        )
    if attrs.get("direction_found"):
        texts.append("its reading falls while the angle of its link rises, as the log shows")
    if grouping := located.attrs.get("grouping"):
        texts.append(grouping)
    notes = [remark("encoder", text) for text in texts]
    if contradiction := located.attrs.get("contradiction"):
        notes.append(warn("[mechanism]", contradiction))
    return notes


def _describe_encoder(link: LinkAngle, encoder: Encoder) -> dict[str, str | float | int]:
    """Attributes of the encoder angle: how the reading becomes the angle of the link."""
    attrs: dict[str, str | float | int] = {
        **FILM["encoder_angle"].attrs,
        "mounted_on": encoder.mounted_on,
        "direction": "falling" if link.falling else "rising",
        # an encoder that starts again has its zero within half a turn
        "zero": (math.degrees(link.zero) + 180.0) % 360.0 - 180.0,
    }
    if link.zero_std is not None:
        attrs["zero_std"] = math.degrees(link.zero_std)
    if link.falling and encoder.direction is None:
        attrs["direction_found"] = 1
    return attrs


def joint_speed(mechanism: Mechanism, crank: Array, crank_speed: float) -> Array:
    """Angular speed in the joint of a linkage.

    Parameters
    ----------
    mechanism : CrankRocker or SliderCrank
    crank : array
        Crank angle. [rad]
    crank_speed : float
        [rad s-1]

    Returns
    -------
    array
        Like crank. [rad s-1]

    Examples
    --------
    At a dead point the crank pin of a slider-crank has the speed of crank and rod together:

    >>> joint_speed(SliderCrank(0.05, 0.2), np.array([0.0]), 10.0)
    array([12.5])
    """
    # the crank pin of a slider-crank turns against the rod, the rocker pin against the frame
    if isinstance(mechanism, SliderCrank):
        return np.asarray(mechanism.joint_speed(crank, crank_speed=crank_speed))
    return np.asarray(mechanism.rocker_speed(crank, crank_speed=crank_speed))


def _describe_zero_effect(
    link: LinkAngle, crank: Array, mechanism: Mechanism, encoder: Encoder, *, crank_speed: float
) -> str:
    """Describe the effect of the error of a fitted zero, which is common to all frames."""
    std = link.zero_std or 0.0
    carrier = choose_link(mechanism, encoder.mounted_on)
    rising = np.asarray(carrier.speed(crank, crank_speed=crank_speed)) > 0

    # a dead point ends the reach of the link, where the crank angle of a reading changes fastest
    after, before = (
        carrier.crank(np.clip(link.angle + sign * std, *carrier.limits), rising=rising)
        for sign in (1, -1)
    )
    turned = np.abs((after - before + math.pi) % (2 * math.pi) - math.pi) / 2
    changed = np.subtract(
        *(np.abs(joint_speed(mechanism, one, crank_speed)) for one in (after, before))
    )
    top = float(np.abs(joint_speed(mechanism, crank, crank_speed)).max())
    return (
        f"; the crank angle changes with it by {math.degrees(float(np.median(turned))):.2f} deg, "
        f"the speed by {float(np.median(np.abs(changed))) / 2 / top:.1%} of its highest value "
        "(medians over the frames)"
    )


def _crank_from_swing(
    link: LinkAngle, log: EncoderLog, mechanism: Mechanism, encoder: Encoder
) -> Array:
    """Crank angle from the angle of a link that swings. [rad]"""
    inverse = choose_link(mechanism, encoder.mounted_on).crank
    if "angle_rate" not in log:
        time = log["time"].values if "time" in log else None
        return _follow_crank(link.angle, inverse, time)

    # a log in time shows the direction of the motion at each frame
    rising = log["angle_rate"].values > 0
    return np.asarray(inverse(link.angle, rising=rising != link.falling))


def _follow_crank(angle: Array, inverse: Callable[..., Array], time: Array | None) -> Array:
    """Crank angle of each reading. [rad]

    Two crank angles fit a reading, one on either stroke. Of all sequences of these the one with the
    most even speed is taken (Viterbi's algorithm), or with the most even steps where no times are
    logged: near a dead point a single step does not determine whether the stroke has turned, its
    neighbours do.
    """
    options = np.stack([inverse(angle, rising=True), inverse(angle, rising=False)])
    if angle.size == 1:
        return np.asarray(options[0])

    turn = 2 * math.pi
    step = (options[None, :, 1:] - options[:, None, :-1]) % turn  # (from, to, frame)
    step[step > turn - 1e-7] = 0.0  # rounding at a standstill
    size = np.log(step + _EVEN_STEP)
    if time is not None and (np.diff(time) > 0).all():
        size = size - np.log(np.diff(time))
    backward = _BACKWARD_COST * np.maximum(step - math.pi, 0.0)

    # the cost of a pair of steps is the square of the change of their logarithm
    cost = backward[:, :, 0]
    came_from = np.empty((angle.size - 2, 2, 2), np.intp)
    for k in range(1, angle.size - 1):
        change = size[None, :, :, k] - size[:, :, None, k - 1]  # (before, from, to)
        total = cost[:, :, None] + change**2
        came_from[k - 1] = total.argmin(axis=0)
        cost = total.min(axis=0) + backward[:, :, k]

    # from the cheapest last pair back to the first frame
    side = np.empty(angle.size, np.intp)
    side[-2:] = np.unravel_index(cost.argmin(), cost.shape)
    for k in range(angle.size - 3, -1, -1):
        side[k] = came_from[k][side[k + 1], side[k + 2]]
    return np.asarray(options[side, np.arange(angle.size)])
