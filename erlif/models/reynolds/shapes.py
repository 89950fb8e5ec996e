"""Gaps of rigid bodies: rollers, the pin of a pin on disc, lobes and edges of a bushing.

`solve_film` takes them as films or, with a load, as shapes; `Journal` takes lobes and edges as its
axial shape.
"""

from collections.abc import Sequence

import numpy as np

from erlif.models.arguments import Values, formula


@formula(radius="number")
def roller_shape(x: Values, *, radius: Values) -> Values:
    """Height of the gap between a cylinder and a flat above its minimum: x^2 / (2 R).

    Parameters
    ----------
    x, radius : float or array
        Distance from the line of contact [m], radius R of the cylinder, or the reduced radius of
        two [m].

    Returns
    -------
    float or array
        Height. [m]

    Examples
    --------
    >>> print(f"{roller_shape(1e-3, radius=0.05) * 1e6:.1f} um")
    10.0 um
    """
    return x**2 / (2 * radius)


@formula(radius="number")
def pin_shape(x: Values, z: Values, *, radius: Values, cross_radius: Values) -> Values:
    """Height of the gap between a crowned pin and a flat above its minimum.

    x^2 / (2 R_x) + z^2 / (2 R_z).

    Parameters
    ----------
    x, z, radius, cross_radius : float or array
        Distances from the point of contact along sliding and across [m], radii of the pin along
        sliding and across [m].

    Returns
    -------
    float or array
        Height above the point of contact. [m]

    Raises
    ------
    ModelError
        As for `roller_shape`.

    Examples
    --------
    >>> print(f"{pin_shape(1e-3, 2e-3, radius=0.05, cross_radius=0.1) * 1e6:.1f} um")
    30.0 um
    """
    return x**2 / (2 * radius) + z**2 / (2 * cross_radius)


@formula(radius="number")
def lobe_shape(axial: Values, *, centres: Sequence[float], radius: float, height: float) -> Values:
    """Height that crowned lobes inside a bushing add to its gap: zero beside them, else negative.

    Farzaneh (2002), chapter 3: two lobes of 200 mm radius along the axis reduce the clearance of
    the bore. -(height - (z - z_k)^2 / (2 R)) where that is negative.

    Parameters
    ----------
    axial : float or array
        Distance z from the middle of the bushing. [m]
    centres : sequence of float
        Places z_k of the lobes. [m]
    radius : float
        Radius R of a lobe along the axis. [m]
    height : float
        Height of a lobe above the bore. [m]

    Returns
    -------
    float or array
        Height added to the gap, at most zero. [m]

    Examples
    --------
    >>> lobe_shape([0.0, 0.05], centres=[-0.05, 0.05], radius=0.2, height=2e-4)
    array([-0.    , -0.0002])
    """
    off = np.min([(axial - centre) ** 2 for centre in centres], axis=0)
    return -np.maximum(height - off / (2 * radius), 0.0)


@formula(length="length", edge="length", depth="number")
def relief_shape(axial: Values, *, length: float, edge: float, depth: float) -> Values:
    """Height that relieved ends of a bushing add to its gap: depth ((|z| - L/2 + l) / l)^2 at them.

    A parabola that begins level at the distance l from either end; its radius there is
    l^2 / (2 depth).

    Parameters
    ----------
    axial : float or array
        Distance z from the middle of the bushing. [m]
    length : float
        Length L of the bushing. [m]
    edge : float
        Length l of the relief at either end. [m]
    depth : float
        Depth of the relief at the ends. [m]

    Returns
    -------
    float or array
        Height added to the gap. [m]

    Examples
    --------
    >>> relief_shape(np.array([0.0, 0.045, 0.05]), length=0.1, edge=0.01, depth=2e-5)
    array([0.e+00, 5.e-06, 2.e-05])
    """
    return depth * np.maximum((np.abs(axial) - length / 2 + edge) / edge, 0.0) ** 2
