"""Bore, liner and roughness of a joint from its settings, as the solver of its film takes them."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array
from erlif.io.settings import JointSettings, RunSettings
from erlif.models.contact import winkler_modulus

# Points of the shape of a bore to either side of its middle: lines between them depart by 2 nm from
# a lobe of 200 mm in a joint of 237 mm.
_HALF_POINTS = 2000


def axial_shape(joint: JointSettings) -> Array | None:
    """Height that the bore adds to its gap along the axis.

    Parameters
    ----------
    joint : JointSettings

    Returns
    -------
    array, (place,), or None
        At equal distances from end to end, as `erlif.models.reynolds.Journal` takes it [m]; None
        for a straight bore.
    """
    if joint.bore is None:
        return None
    steps = np.arange(-_HALF_POINTS, _HALF_POINTS + 1.0)
    return joint.bore.shape(steps * (joint.length / (2 * _HALF_POINTS)), joint.length)


def foundation_of(joint: JointSettings) -> float | None:
    """Pressure over deflection of the liner, as a thin layer that cannot spread. [Pa/m]"""
    if (liner := joint.liner) is None:
        return None
    modulus = winkler_modulus(liner.youngs_modulus, poisson=liner.poissons_ratio)
    return float(modulus) / liner.thickness


def departure(settings: RunSettings) -> str:
    """Keys by which the joint is not straight, rigid and smooth; empty where it is."""
    joint, rough = settings.joint, settings.prediction.rough
    bore, liner = (None, None) if joint is None else (joint.bore, joint.liner)
    names = ("bore in [joint]", "liner in [joint]", "rough in [prediction]")
    return " and ".join(
        name for name, stated in zip(names, (bore, liner, rough), strict=True) if stated
    )
