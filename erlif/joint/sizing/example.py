"""The joint of the examples: a boom of a wheel loader, invented."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from erlif.joint.sizing.joint import Joint
from erlif.joint.sizing.quantities import read_table


@cache
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
    from erlif.io.settings import DesignSettings  # not needed by the equations, and slow to load
    from erlif.joint.sizing.design import joint_of

    return joint_of(DesignSettings.model_validate(read_table("example")["joint"]), Path())
