"""A joint for examples: the boom of a wheel loader, invented."""

from __future__ import annotations

import math
from dataclasses import replace

from erlif.joint.sizing.joint import Joint, Lock
from erlif.joint.sizing.materials import read_materials


def example_joint() -> Joint:
    """Return a joint with all dimensions.

    Returns
    -------
    Joint

    Examples
    --------
    >>> example_joint().pin_diameter
    0.08
    """
    materials = read_materials()
    steel = materials["S355"]
    bronze = replace(materials["CuAl10Ni5Fe4"], wear=5e-17)  # invented
    return Joint(
        force=100e3,
        safety=2.0,
        pin=materials["42CrMo4 hardened"],
        bushing=bronze,
        seat=steel,
        housing=steel,
        mean_force=60e3,
        half_swing=math.radians(30.0),
        period=6.0,
        life=5000 * 3600.0,
        largest_wear=1e-3,
        pin_roughness=0.4e-6,
        bushing_roughness=0.8e-6,
        pin_diameter=0.08,
        bushing_width=0.1,
        wall=0.01,
        seat_width=0.04,
        housing_diameter=0.2,
        play=160e-6,
        interference=60e-6,
        lateral_play=1e-3,
        lock=Lock(
            "open",
            steel,
            lever=0.08,
            length=0.03,
            thickness=0.012,
            height=0.075,
            throat=4e-3,
            weld="external",
            weld_diameter=0.08,
        ),
    )
