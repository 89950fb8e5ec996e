"""Discs, sliders and static films in place of the linkage: where each picture is taken."""

import numpy as np

from erlif.rig.film import Triggers, follow_film_law, list_triggers
from erlif.rig.settings import RigSettings

_FIRST = 0.37  # of the spacing of the pictures, by which the first one is off the zero
_LASER = 10.0  # pulses in a second over a static film [Hz]


def list_pictures(rig: RigSettings) -> Triggers:
    """List the pictures of one cycle, with motion and film of each.

    The speed of a disc and of a slider is that of the surface [m/s]: 2 pi n R of the disc, and
    2 pi f s/2 cos of the slider, whose position is s/2 sin.
    """
    if rig.mechanism == "crank-rocker":
        return list_triggers(rig)

    number = np.arange(rig.pictures)
    share = (number + _FIRST) / rig.pictures  # of a cycle
    angle = 2 * np.pi * share
    if rig.mechanism == "rotation":
        turns = rig.disc_speed / 60
        speed = np.full(number.size, 2 * np.pi * turns * rig.track_radius / 1e3)
        time = share / turns
    elif rig.mechanism == "sinusoidal":
        speed = np.pi * rig.frequency * rig.stroke / 1e3 * np.cos(angle)
        time = share / rig.frequency
    else:
        angle, speed = np.zeros(number.size), np.zeros(number.size)
        time = number / _LASER

    load = rig.load * (1 + rig.load_swing * np.sin(angle))
    top = np.abs(speed).max()
    relative = np.abs(speed) / top if top > 0 else np.ones(number.size)
    return Triggers(
        reading=np.degrees(angle),
        zero=0.0,
        crank_angle=np.degrees(angle),
        speed=speed,
        time=time,
        load=load,
        film_min=follow_film_law(rig, relative, load),
    )


def cycle_time(rig: RigSettings) -> float:
    """Time of one cycle of the motion. [s]"""
    return {
        "crank-rocker": 60 / rig.crank_speed,
        "rotation": 60 / rig.disc_speed,
        "sinusoidal": 1 / rig.frequency,
        "static": rig.pictures / _LASER,
    }[rig.mechanism]
