"""The linkage of the thesis, solved by the two circles on which its rocker pin lies."""

import math

import numpy as np
import xarray as xr
from scipy.optimize import brentq

from erlif.kinematics import Encoder, locate_frames
from erlif.models.mechanism import CrankRocker

CRANK, COUPLER, ROCKER, GROUND = 5.5, 44.0, 26.0, 51.0  # cm, Farzaneh (2002)
OMEGA = 114 * 2 * math.pi / 60
LINKAGE = CrankRocker(0.055, 0.44, 0.26, 0.51)
PIN = 33.36e-3  # m


def link_angles(crank):
    """Angles of rocker and coupler at a crank angle. [rad]"""
    x, y = CRANK * math.cos(crank), CRANK * math.sin(crank)

    def gap(psi):
        return math.hypot(GROUND - ROCKER * math.cos(psi) - x, ROCKER * math.sin(psi) - y) - COUPLER

    psi = brentq(gap, math.radians(30), math.radians(90), xtol=1e-14)
    return psi, math.atan2(ROCKER * math.sin(psi) - y, GROUND - ROCKER * math.cos(psi) - x)


def make_log(angle, **columns):
    """A log with these angles [degree] and further columns."""
    data = {"number": np.arange(len(angle)), "angle": np.asarray(angle, float), **columns}
    return xr.Dataset({name: ("frame", np.asarray(values)) for name, values in data.items()})


def locate(log, *, mechanism=LINKAGE, **encoder):
    """Position of the linkage at each frame of a log."""
    options = {"crank_speed": OMEGA, "pin_radius": PIN, "encoder": Encoder(**encoder)}
    return locate_frames(log, mechanism=mechanism, **options)


def apart(a, b):
    """Distance of angles, whole turns apart. [degree]"""
    return np.abs((np.asarray(a) - np.asarray(b) + 180) % 360 - 180)
