"""The bore of a joint along its axis, where it is not straight, and the file of its profile."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.io.settings.values import FileName, Length, Places, Points, Settings

# Depth below which a profile changes no film. [um]
_LEAST_DEPTH = 0.1

# Points of a profile that is read: more are finer than any film is solved.
_MOST_POINTS = 4000


class BoreSettings(Settings):
    """The bore along its axis, where it is not straight: lobes, edges or a measured profile."""

    lobes: Places = ()
    """Places along the axis of lobes that reach into the bore, from the middle of the joint. Beside
    them the bore has bushing_radius."""
    lobe_radius: Length | None = Field(None, examples=["200 mm"])
    """Radius of the lobes along the axis."""
    lobe_height: Length | None = Field(None, examples=["20 um"])
    """Height of the lobes above the bore."""
    edge_length: Length | None = Field(None, examples=["5 mm"])
    """Length over which the bore is relieved at either end, as a parabola that begins level: an
    edge of the radius edge_length^2 / (2 edge_depth)."""
    edge_depth: Length | None = Field(None, examples=["20 um"])
    """Depth of the relief at the ends."""
    profile: FileName | None = Field(None, examples=["bore.csv"])
    """Measured profile from end to end, in place of lobes and edges: text file beside this one, of
    any form that a log may have, with the columns axial_mm, from the middle of the joint, and
    depth_um or height_um, by which the bore is wider or narrower than bushing_radius."""
    points: Points = ()
    """Points of the profile, [place in mm, depth in um], as results keep them. Default: those of
    the file profile."""

    def faults(self) -> Iterator[str]:
        if bool(self.lobes) != bool(self.lobe_radius) or bool(self.lobes) != bool(self.lobe_height):
            yield "give lobes, lobe_radius and lobe_height together, or none of them"
        if bool(self.edge_length) != bool(self.edge_depth):
            yield "give edge_length and edge_depth together, or neither"
        if self.profile and not self.points:
            yield "expected the points of the profile beside its name, as results have them"
        if self.points and (self.lobes or self.edge_length):
            yield "give either a profile, or lobes and edges: the profile has them already"
        if any(after[0] <= before[0] for before, after in pairwise(self.points)):
            yield "expected points of the profile at rising places. Sort them, and remove repeats"

    def faults_in(self, length: float, clearance: float) -> Iterator[str]:
        """Yield why the bore has no place in a joint of a length and a radial clearance [m]."""
        half, reach = length / 2, self.lobe_reach
        height, edge = self.lobe_height or 0.0, self.edge_length or 0.0
        feet = [-half, *(at + side for at in sorted(self.lobes) for side in (-reach, reach)), half]
        if any(after < before for before, after in pairwise(feet)):
            yield (
                f"lobes of bore must neither overlap nor end beyond {half * 1e3:g} mm from the "
                f"middle of the joint; each reaches {reach * 1e3:.3g} mm to either side, by its "
                "radius and height. Correct lobes, lobe_height or length"
            )
        if height >= clearance:
            yield (
                f"lobe_height of bore must be below the radial clearance, {clearance * 1e6:g} um, "
                f"for the pin to fit; got {height * 1e6:g} um"
            )
        if edge > half:
            yield (
                f"edge_length of bore must be at most half of the length, {half * 1e3:g} mm; got "
                f"{edge * 1e3:g} mm"
            )
        if not self.points:
            return
        (first, *_), (last, *_) = self.points[0], self.points[-1]
        ends, least = half * 1e3 * (1 - 1e-9), min(depth for _, depth in self.points)
        if first > -ends or last < ends:
            yield (
                f"the profile of bore must reach from end to end, {-half * 1e3:g} to "
                f"{half * 1e3:g} mm from the middle of the joint; its places are {first:g} to "
                f"{last:g} mm. Correct its zero or its unit, or add the ends"
            )
        if 0 < (most := max(abs(depth) for _, depth in self.points)) < _LEAST_DEPTH:
            yield (
                f"the profile of bore departs from bushing_radius by {most:.3g} um at most, as "
                "numbers in mm would. Write it in um, or leave it out"
            )
        if -least >= clearance * 1e6:
            yield (
                f"the profile of bore must stay below the radial clearance, {clearance * 1e6:g} "
                f"um, for the pin to fit; it reaches {-least:g} um into the bore. Correct its unit "
                "or its zero, the bore of bushing_radius"
            )

    @property
    def lobe_reach(self) -> float:
        """Distance from the crest of a lobe to its foot. [m]"""
        return math.sqrt(2 * (self.lobe_radius or 0.0) * (self.lobe_height or 0.0))

    def shape(self, axial: Array, length: float) -> Array:
        """Height that the bore adds to its gap.

        Parameters
        ----------
        axial : array
            Distance from the middle of the joint. [m]
        length : float
            Of the joint. [m]

        Returns
        -------
        array
            Like axial. [m]
        """
        from erlif.models.reynolds import lobe_shape, relief_shape  # settings alone load no models

        shape = np.zeros_like(axial)
        if self.points:
            place, depth = np.array(self.points).T
            shape += 1e-6 * np.interp(1e3 * axial, place, depth)
        if (radius := self.lobe_radius) and (height := self.lobe_height):
            shape += lobe_shape(axial, centres=self.lobes, radius=radius, height=height)
        if (edge := self.edge_length) and (depth := self.edge_depth):
            shape += relief_shape(axial, length=length, edge=edge, depth=depth)
        return shape


def read_bore(table: dict[str, Any], folder: Path, *, allow_outside: bool = False) -> None:
    """Put the points of the profile that [joint.bore] names beside its name.

    Parameters
    ----------
    table : dict
        A settings file from TOML, changed in place; nothing is done where it names no profile.
    folder : Path
        Directory of the settings file.
    allow_outside : bool
        Read a profile also where it lies outside of the directory.

    Raises
    ------
    ConfigError, FrameError
        If the profile cannot be read, or lies outside of the directory.

    Examples
    --------
    >>> read_bore({"joint": {"bore": {"profile": "none.csv"}}}, Path())
    Traceback (most recent call last):
        ...
    erlif.core.errors.ConfigError: Expected the table none.csv; it cannot be read: No such file \
or directory. Save it there, or correct profile in [joint.bore].
    """
    joint = table.get("joint")
    bore = joint.get("bore") if isinstance(joint, dict) else None
    name = bore.get("profile") if isinstance(bore, dict) else None
    if isinstance(bore, dict) and isinstance(name, str) and name and not name.startswith("??"):
        if not allow_outside:
            from erlif.io.ingest.containment import refuse_outside  # it needs the settings

            refuse_outside(folder, [name])
        bore["points"] = _read_points(folder / name)


def _read_points(path: Path) -> list[list[float]]:
    """Places [mm] and depths [um] of a profile, in the order of the places."""
    # settings alone load no reader of tables
    from erlif.io.ingest.logs.profiles import find_columns, read_columns
    from erlif.io.ingest.logs.table import LogUse
    from erlif.io.ingest.logs.text import read_log_table

    use = LogUse(
        ConfigError,
        column="call it {quantity}, or by a usual name with its unit, as Depth [um]",
        unit="write it behind the name, as axial_mm, depth_um or Depth [um]",
        bad_rows="Correct the cell, or leave the row out.",
        name="profile in [joint.bore]",
    )
    table = read_log_table(path, ("axial_mm", "depth_um"), use)
    found = find_columns(table, "bore")
    name, sign = ("height_um", -1.0) if found["height_um"] else ("depth_um", 1.0)
    columns, _ = read_columns(table, found, ("axial_mm", name))
    if "depth_um" in columns and "height_um" in columns:
        raise ConfigError(
            f"Expected either the depth or the height of the bore in {path.name}; it has both. "
            "Leave one of them out."
        )

    points = sorted(zip(columns["axial_mm"].tolist(), (sign * columns[name]).tolist(), strict=True))
    if len(points) > _MOST_POINTS:
        raise ConfigError(
            f"Expected up to {_MOST_POINTS} points of the bore in {path.name}; got {len(points)}. "
            "Average neighbours."
        )
    return [list(one) for one in points]
