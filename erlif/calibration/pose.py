"""Pose of the fixture in the image: offset, scale and turn, and which the data determine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from erlif.calibration.points import Points
from erlif.core.arrays import Array, Mask
from erlif.core.notes import Note, remark

# Elements of a change of pose: along and across the profile [mm], scale [1], turn [rad].
ALONG, ACROSS, SCALE, TURN = range(4)
_GIVEN = ("origin along the profile", "origin across the profile", "scale", "direction")

_SIGNIFICANT = 3.0  # standard deviations from which on a turn found in the image replaces the given
_OUTLIER = 4.5  # standard deviations beyond which a cell holds dust
_OUTLIER_PASSES = 3
_MINIMUM_CELLS = 8  # for a line through slopes across the profile


@dataclass(frozen=True)
class Pose:
    """Position of the pixels of camera 1 on the profile.

    Attributes
    ----------
    origin : tuple[float, float]
        Pixel (x, y) at profile x = 0 (y = 0). [px]
    direction : float
        Turn from image x to profile x, positive towards image y (down). [rad]
    pixel_pitch : float
        Distance of neighbouring pixels on the profile. [mm]
    """

    origin: tuple[float, float]
    direction: float
    pixel_pitch: float

    def place(self, column: Array, row: Array) -> tuple[Array, Array]:
        """Positions of pixels along and across the profile. [mm]"""
        dx = (column - self.origin[0]) * self.pixel_pitch
        dy = (row - self.origin[1]) * self.pixel_pitch
        cos, sin = math.cos(self.direction), math.sin(self.direction)
        return cos * dx + sin * dy, -sin * dx + cos * dy

    def changed(self, change: Array, middle: Array) -> Pose:
        """Pose after a change: an offset, and scale and turn about a fixed point.

        Parameters
        ----------
        change : array, (4,)
            Along and across the profile [mm], scale [1], turn [rad].
        middle : array, (2,)
            Position on the profile that scale and turn leave in place. [mm]

        Returns
        -------
        Pose
        """
        along, across, scale, turn = (float(value) for value in change)
        direction = self.direction + turn
        cos, sin = math.cos(turn), math.sin(turn)
        turned = np.array([[cos, sin], [-sin, cos]]) @ middle
        offset = middle - (1 + scale) * turned + (along, across)

        # the offset on the profile becomes an offset of the origin in pixels
        cos, sin = math.cos(direction), math.sin(direction)
        pitch = self.pixel_pitch * (1 + scale)
        back = (
            np.array([cos * offset[0] - sin * offset[1], sin * offset[0] + cos * offset[1]]) / pitch
        )
        return Pose(
            (self.origin[0] - float(back[0]), self.origin[1] - float(back[1])), direction, pitch
        )


@dataclass(frozen=True)
class FoundPose:
    """A pose refined against the image.

    Attributes
    ----------
    pose : Pose
        The refined pose.
    change : Array
        Change from the given pose, (4,), about the middle of the profile. [mm, mm, 1, rad]
    covariance : Array
        Covariance of the change, (4, 4); 0 in directions left as given.
    determined : Mask
        Which of the four the data determine, at least for the most part, (4,).
    """

    pose: Pose
    change: Array
    covariance: Array
    determined: Mask

    @property
    def standard_deviations(self) -> Array:
        """Standard deviations of the change, (4,). [mm, mm, 1, rad]"""
        return np.sqrt(np.diag(self.covariance))

    def describe(self, points: Points) -> list[Note]:
        """Notes on what was refined and what was left as given."""
        change, std = self.change, self.standard_deviations
        degrees, degrees_std = math.degrees(change[TURN]), math.degrees(std[TURN])
        refined = (
            f"{1e3 * change[ALONG]:+.1f} ± {1e3 * std[ALONG]:.1f} um along the profile",
            f"{1e3 * change[ACROSS]:+.1f} ± {1e3 * std[ACROSS]:.1f} um across the profile",
            f"scaled by {1 + change[SCALE]:.5f} ± {std[SCALE]:.5f}",
            f"turned by {degrees:+.3f} ± {degrees_std:.3f} degrees",
        )
        # a line has no position across
        elements = range(4) if points.on_surface else (ALONG, SCALE, TURN)
        changes = [refined[n] for n in elements if self.determined[n]]
        left = [_GIVEN[n] for n in elements if not self.determined[n]]
        notes = []
        if changes:
            found = f"{', '.join(changes)}, about the middle of the profile"
            notes.append(
                remark("", f"the pose of the profile was refined against the image: {found}")
            )
        if left:
            why = (
                "The profile has too little form to determine them to a pixel (a straight wedge "
                "looks the same wherever it begins), or agrees with the given values"
            )
            notes.append(remark("", f"left as given: {', '.join(left)}. {why}"))
        return notes

    def to_record(self) -> dict[str, Any]:
        """The pose as plain numbers, as calibration.nc stores it."""
        return {
            "origin": list(self.pose.origin),
            "direction_rad": self.pose.direction,
            "pixel_pitch_mm": self.pose.pixel_pitch,
            "change": self.change.tolist(),
            "covariance": self.covariance.tolist(),
            "determined": self.determined.tolist(),
        }

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> FoundPose:
        """The pose from its plain numbers, the inverse of `to_record`."""
        x, y = record["origin"]
        return cls(
            Pose(
                (float(x), float(y)),
                float(record["direction_rad"]),
                float(record["pixel_pitch_mm"]),
            ),
            np.array(record["change"], float),
            np.array(record["covariance"], float),
            np.array(record["determined"], bool),
        )


@dataclass(frozen=True)
class Freedom:
    """Changes of a pose that the film determines, as combinations of offset, scale and turn.

    Attributes
    ----------
    displacement : Array
        Change of the film under each point by a unit of each combination, (point, combination).
        [um/mm]
    combinations : Array
        Change of the pose by a unit of each combination, (4, combination). [mm, mm, 1, rad; per
        mm]
    middle : Array
        Position that scale and turn leave in place, (2,). [mm]
    shares : Array
        Share of offset along and across, scale and turn that lies in the combinations, (4,): 1
        is determined by the data, 0 is left as given.
    """

    displacement: Array
    combinations: Array
    middle: Array
    shares: Array

    @classmethod
    def none(cls, points: Points) -> Freedom:
        """Make a freedom without parameters, for a pose that is used as given."""
        return cls(np.empty((points.thickness.size, 0)), np.empty((4, 0)), np.zeros(2), np.zeros(4))

    @property
    def size(self) -> int:
        """Number of combinations."""
        return int(self.combinations.shape[1])


class Turn(NamedTuple):
    """Turn of a line profile found in the image.

    Attributes
    ----------
    angle : float
        Change of direction; 0 where the given one stays. [rad]
    std : float
        Standard deviation of the change; NaN where the given direction stays. [rad]
    """

    angle: float
    std: float


# The given direction stays.
AS_GIVEN = Turn(0.0, math.nan)


def find_turn(points: Points, *, pixel_pitch: float) -> Turn:
    """Find the turn of a line profile from the image alone: the ratio is constant across the line.

    Parameters
    ----------
    points : Points
        CMM points and the ratio there.
    pixel_pitch : float
        Distance of pixels on the profile. [mm]

    Returns
    -------
    Turn
        `AS_GIVEN` for a surface, where the image does not determine the turn to one pixel at the
        edge, and where the turn is not significant.
    """
    if points.on_surface:
        return AS_GIVEN
    along, across, std = points.ratio_gradient[:, 0], points.across_slope, points.across_slope_std
    good = np.isfinite(across) & (std > 0)
    if good.sum() < _MINIMUM_CELLS:
        return AS_GIVEN

    # a turned line shows a slope across it that is proportional to the slope along it
    along, across, std = along[good], across[good], std[good]
    for _ in range(_OUTLIER_PASSES):
        slope, slope_std, spread = _line_through_zero(along, across, std)
        near = np.abs(across - slope * along) <= _OUTLIER * max(1.0, spread) * std
        along, across, std = along[near], across[near], std[near]

    reach = float(np.ptp(points.position)) / 2
    if slope_std * reach > pixel_pitch or abs(slope) < _SIGNIFICANT * slope_std:
        return AS_GIVEN
    return Turn(slope, slope_std)


def _line_through_zero(x: Array, y: Array, std: Array) -> tuple[float, float, float]:
    """Slope of a weighted line of y over x, its standard deviation, and the scatter about it.

    Scatter above the stated one, of which it is given in units, widens the error of the slope.
    """
    information = float(((x / std) ** 2).sum())
    slope = float((x * y / std**2).sum()) / information
    spread = math.sqrt(float((((y - slope * x) / std) ** 2).sum()) / max(x.size - 1, 1))
    return slope, max(spread, 1.0) / math.sqrt(information), spread
