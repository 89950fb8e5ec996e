"""Friction of the true film of the virtual rig, by sums over its gap."""

import numpy as np
import xarray as xr

from erlif.rig import RigSettings

ANGLES = np.linspace(-np.pi, np.pi, 7201)


def true_friction(truth: xr.Dataset, rig: RigSettings) -> tuple[np.ndarray, ...]:
    """Torque of the whole joint [N m], shear force on the region [N] and its mean film [um].

    Trapezoidal sums of eta U / h over the true gap all round and over the whole length, tilt
    included, and half of the moment of the load about the bore; NaN where the gap closes. The force
    on the region is the sum over the true map, marks included. Arrays are (trigger,).
    """
    radius = 1e-3 * np.sqrt(rig.pin_radius * rig.bushing_radius)
    clearance = 1e-3 * (rig.bushing_radius - rig.pin_radius)
    speed, weight = truth.rocker_speed.values, truth["joint_load"].values
    shear = rig.viscosity * 1e-3 * rig.pin_radius * np.abs(speed)
    if "pin_displacement_load" in truth:
        load, side = (1e-6 * truth[f"pin_displacement_{name}"].values for name in ("load", "side"))
        per_length = 0.0
    else:
        # the tilt moves the pin about the edge of the region at which the film is thinnest
        per_mm = rig.tilt / (rig.height * rig.pitch)
        middle = 0.5 * (rig.height - 1) * rig.pitch - rig.region[1][0 if rig.tilt >= 0 else 1]
        load = clearance - 1e-6 * (truth.film_min.values + per_mm * middle)
        side, per_length = 0 * load, -1e-3 * per_mm

    axial = np.linspace(-0.5e-3, 0.5e-3, 101 if per_length else 2) * rig.length
    torque = np.full(speed.size, np.nan)
    for k in range(speed.size):
        place = load[k] + per_length * axial[:, None]
        gap = clearance - place * np.cos(ANGLES) - side[k] * np.sin(ANGLES)
        if gap.min() > 0:
            whole = np.trapezoid(np.trapezoid(1 / gap, ANGLES, axis=1), axial)
            moment = np.sign(speed[k]) * side[k] * weight[k]
            torque[k] = shear[k] * radius**2 * whole + moment / 2

    (left, right), (top, bottom) = rig.region
    little = 1e-6  # both ends count, whatever their last digit
    x, y = slice(left - little, right + little), slice(top - little, bottom + little)
    region = truth.film.sel(x=x, y=y)
    area = region.sizes["x"] * region.sizes["y"] * (1e-3 * rig.pitch) ** 2
    thin, mean = ((1e6 / region).mean(["x", "y"]).values, region.mean(["x", "y"]).values)
    return torque, shear * area * thin, mean
