"""Where the fixture lies in the image: offset, scale and turn, and which of them the data can tell."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import BSpline

from erlif.core.arrays import Array, Mask

if TYPE_CHECKING:
    from erlif.calibration.points import Points


NAMES = ("along", "across", "scale", "turn")
"""Changes of a pose, in the order of their arrays: along and across the profile [mm], scale [1], turn [rad]."""

_SIGNIFICANT = 3.0  # standard deviations by which the image must gainsay the turn of a line


@dataclass(frozen=True)
class Pose:
    """How pixels of camera 1 are laid on the profile.

    Attributes
    ----------
    origin : (float, float)
        Pixel (x, y) at profile x = 0 (y = 0).
    direction : float
        Turn from image x to profile x. [rad]
    pixel_pitch : float
        [mm]
    """

    origin: tuple[float, float]
    direction: float
    pixel_pitch: float

    def place(self, column: Array, row: Array) -> tuple[Array, Array]:
        """Place of pixels along and across the profile. [mm]"""
        dx, dy = (
            (column - self.origin[0]) * self.pixel_pitch,
            (row - self.origin[1]) * self.pixel_pitch,
        )
        cos, sin = math.cos(self.direction), math.sin(self.direction)
        return cos * dx + sin * dy, -sin * dx + cos * dy

    def changed(self, change: Array, middle: Array) -> Pose:
        """The pose that lays what lay at X on X + change: an offset, and scale and turn about `middle` [mm]."""
        along, across, scale, turn = (float(value) for value in change)
        direction = self.direction + turn
        cos, sin = math.cos(turn), math.sin(turn)
        turned = np.array([[cos, sin], [-sin, cos]]) @ middle
        offset = middle - (1 + scale) * turned + (along, across)
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
    change : array, (4,)
        From the given pose: along and across the profile [mm], scale [1], turn [rad]; about the middle of the profile.
    covariance : array, (4, 4)
        Of the change; 0 in directions left as given.
    determined : array of bool, (4,)
        Which of the four the data tell, at least for the most part.
    """

    pose: Pose
    change: Array
    covariance: Array
    determined: Mask

    @property
    def standard_deviations(self) -> Array:
        """Of the change."""
        return np.sqrt(np.diag(self.covariance))

    def describe(self, points: Points) -> list[str]:
        """What was found and what was left as given."""
        line = points.position.shape[1] == 1
        meanings = (
            (
                f"{1e3 * self.change[0]:+.1f} ± {1e3 * self.standard_deviations[0]:.1f} um along the profile",
                "origin along the profile",
            ),
            (
                f"{1e3 * self.change[1]:+.1f} ± {1e3 * self.standard_deviations[1]:.1f} um across the profile",
                "origin across the profile",
            ),
            (f"scaled by {1 + self.change[2]:.5f} ± {self.standard_deviations[2]:.5f}", "scale"),
            (
                f"turned by {math.degrees(self.change[3]):+.3f} ± {math.degrees(self.standard_deviations[3]):.3f} degrees",
                "direction",
            ),
        )
        notes = []
        found = [text for (text, _), known in zip(meanings, self.determined, strict=True) if known]
        if found:
            notes.append(
                f"the image was laid on the profile anew: {', '.join(found)}, about the middle of the profile"
            )
        left = [
            name
            for n, ((_, name), known) in enumerate(zip(meanings, self.determined, strict=True))
            if not known and not (line and n == 1)
        ]
        if left:
            notes.append(
                f"left as given: {', '.join(left)}. The profile has too little form to tell to a pixel (a straight wedge looks the same "
                "wherever it begins), or agrees with what was given"
            )
        return notes

    def to_record(self) -> dict[str, Any]:
        """As it is kept in a file."""
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
        """Undo `to_record`."""
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
    """The changes of a pose that the film can tell, as combinations of offset, scale and turn.

    Attributes
    ----------
    displacement : array, (point, combination)
        Change of the film under each point by a unit of each combination. [um/mm]
    combinations : array, (4, combination)
        Change of the pose by a unit of each combination. [mm, mm, 1, rad; per mm]
    middle : array, (2,)
        Point that scale and turn leave in place. [mm]
    shares : array, (4,)
        Of offset along and across, scale and turn, what lies in the combinations: 1 is told, 0 is left as given.
    """

    displacement: Array
    combinations: Array
    middle: Array
    shares: Array

    @classmethod
    def none(cls, points: Points) -> Freedom:
        """A pose that is left as given."""
        return cls(np.empty((points.thickness.size, 0)), np.empty((4, 0)), np.zeros(2), np.zeros(4))

    @property
    def size(self) -> int:
        """Number of combinations."""
        return int(self.combinations.shape[1])


def find_freedom(
    points: Points,
    kept: Mask,
    *,
    true_thickness: Array,
    slope: Array,
    thickness_std: Array,
    pixel_pitch: float,
) -> Freedom:
    """Find the changes of the pose that show in the ratio as no change of the calibration curve could.

    The effect of each change on the ratio is freed of all that any smooth function of thickness can imitate: what is left is the
    profile's form. Combinations of offset, scale and turn whose standard deviation is below a pixel at the edge of the profile
    are determined. A straight wedge determines none: an offset looks like another K, a scale like other p and q.

    Parameters
    ----------
    points : Points
    kept : array of bool, (point,)
    true_thickness : array, (point,)
        Film that CMM and ratio agree on. [um]
    slope : array, (point,)
        Of the logarithm of the ratio. [1/um]
    thickness_std : array, (point,)
        [um]
    pixel_pitch : float
        [mm]
    """
    surface = points.position.shape[1] == 2
    middle = np.zeros(2)
    middle[: points.position.shape[1]] = points.position[kept].mean(axis=0)
    x, y = (
        (points.position - middle[: points.position.shape[1]]).T
        if surface
        else (points.position[:, 0] - middle[0], 0.0)
    )
    reach = float(np.ptp(points.position[kept], axis=0).max()) / 2
    along = points.gradient[:, 0]
    if surface:
        across = points.gradient[:, 1]
        effect = np.column_stack(
            [along, across, (along * x + across * y) / reach, (along * y - across * x) / reach]
        )
        names = [0, 1, 2, 3]
    else:
        # a line says nothing across; its turn is told by the image alone, see `find_turn`
        effect = np.column_stack([along, along * x / reach])
        names = [0, 2]
    std = np.hypot(points.log_ratio_std, thickness_std * slope)[kept]
    shown = effect[kept] * (slope[kept] / std)[:, None]
    imitated = _smooth_functions(true_thickness[kept]) / std[:, None]
    if kept.sum() < 2 * (imitated.shape[1] + shown.shape[1]):
        return Freedom.none(points)
    own = shown - imitated @ np.linalg.lstsq(imitated, shown, rcond=None)[0]
    information, vectors = np.linalg.eigh(own.T @ own)
    determined = vectors[:, information * pixel_pitch**2 >= 1]
    units, shares = np.diag([1.0, 1.0, 1 / reach, 1 / reach])[:, names], np.zeros(4)
    shares[names] = (determined**2).sum(axis=1)
    return Freedom(effect @ determined, units @ determined, middle, shares)


def _smooth_functions(thickness: Array) -> Array:
    """Cubic B-splines over thickness, (point, function)."""
    inner = min(5, thickness.size // 15)
    low, high = float(thickness.min()), float(thickness.max())
    inside = np.quantile(thickness, np.linspace(0, 1, inner + 2)[1:-1])
    knots = np.concatenate([[low] * 4, inside, [high] * 4])
    return np.asarray(BSpline.design_matrix(thickness, knots, 3).toarray())


def find_turn(points: Points, *, pixel_pitch: float) -> tuple[float, float]:
    """Find the turn of a line profile by the image alone: across the profile the ratio must not change.

    Returns
    -------
    turn, std : float
        Change of direction [rad]; 0 and NaN where the image does not tell it to a pixel at the edge or does not gainsay what was given.
    """
    if points.position.shape[1] == 2:
        return 0.0, math.nan
    along, across, std = points.ratio_gradient[:, 0], points.across_slope, points.across_slope_std
    good = np.isfinite(across) & (std > 0)
    if good.sum() < 8:
        return 0.0, math.nan
    along, across, std = along[good], across[good], std[good]
    for _ in range(3):  # without cells that hold dust
        turn, turn_std, spread = _line_through_zero(along, across, std)
        near = np.abs(across - turn * along) <= 4.5 * max(1.0, spread) * std
        along, across, std = along[near], across[near], std[near]
    reach = float(np.ptp(points.position)) / 2
    if turn_std * reach > pixel_pitch or abs(turn) < _SIGNIFICANT * turn_std:
        return 0.0, math.nan
    return turn, turn_std


def _line_through_zero(x: Array, y: Array, std: Array) -> tuple[float, float, float]:
    """Slope of y over x, its standard deviation, and the scatter in units of `std`."""
    information = float(((x / std) ** 2).sum())
    slope = float((x * y / std**2).sum()) / information
    spread = math.sqrt(float((((y - slope * x) / std) ** 2).sum()) / max(x.size - 1, 1))
    return slope, max(spread, 1.0) / math.sqrt(information), spread
