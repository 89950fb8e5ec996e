"""The image of a run in the plane of the joint: positions, region of interest, patch, and pin."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from erlif.core.arrays import Array, Image
from erlif.core.errors import ConfigError
from erlif.core.variables import FILM
from erlif.io.settings import RunSettings
from erlif.pipeline.physics.bore import axial_shape
from erlif.trend import AxialShape, GapShape, PinView, Region, find_region
from erlif.trend.blocks import pixels_between

# Rows and columns of a patch, at least. [px]
_SMALLEST = 8


@dataclass(frozen=True)
class ObjectPlane:
    """Object plane of camera 1: positions of its pixels on the joint.

    Attributes
    ----------
    settings : RunSettings
    shape : tuple[int, int]
        Rows and columns of a frame.
    """

    settings: RunSettings
    shape: tuple[int, int]

    @property
    def sliding_along_x(self) -> bool:
        """Whether image x is the sliding direction."""
        return self.settings.optics.x_axis == "sliding"

    @property
    def pitch(self) -> float:
        """Size of a pixel. [mm]"""
        return self.settings.optics.pixel_pitch * 1e3

    @property
    def x(self) -> Array:
        """Positions of the columns, (x,). [mm]"""
        return np.arange(self.shape[1], dtype=float) * self.pitch

    @property
    def y(self) -> Array:
        """Positions of the rows, (y,). [mm]"""
        return np.arange(self.shape[0], dtype=float) * self.pitch

    @property
    def along(self) -> Array:
        """Positions along sliding, (pixel,). [mm]"""
        return self.x if self.sliding_along_x else self.y

    @property
    def within(self) -> slice:
        """Slice of the positions along sliding that lie in the region of interest."""
        return self.region.columns if self.sliding_along_x else self.region.rows

    @property
    def bore_height(self) -> Array | float:
        """Height that the bore adds to the gap across the region; 0 if straight. [um]"""
        rows = self.region.rows if self.sliding_along_x else self.region.columns
        return 0.0 if self.bore is None else self.bore.at(self.across[rows])

    @property
    def contacts(self) -> tuple[GapShape, ...]:
        """Gaps that the surfaces may have: a pin in a bushing is straight or bent along the axis.

        Where the shape of the bore is stated, the rest of its gap is straight.
        """
        mechanism = self.settings.mechanism
        linked = mechanism is not None and mechanism.kind in ("crank-rocker", "slider-crank")
        if not linked and self.settings.joint is None:
            return tuple(shape for shape in GapShape if shape is not GapShape.JOURNAL)
        if self.bore is not None:
            return (GapShape.LINE,)
        return GapShape.LINE, GapShape.JOURNAL

    @property
    def across(self) -> Array:
        """Positions along the axis, (pixel,). [mm]"""
        return self.y if self.sliding_along_x else self.x

    @property
    def axial_origin(self) -> float:
        """Position along the axis of the middle of the joint, else of the image. [mm]"""
        stated = self.settings.optics.axial_centre
        return 0.5 * (self.across.size - 1) * self.pitch if stated is None else stated * 1e3

    @cached_property
    def bore(self) -> AxialShape | None:
        """Shape of the bore along the axis; None for a straight one."""
        joint = self.settings.joint
        if joint is None or (shape := axial_shape(joint)) is None:
            return None
        place = self.axial_origin + 1e3 * joint.length * np.linspace(-0.5, 0.5, shape.size)
        return AxialShape(place, 1e6 * shape, self.pitch)

    def spread(self, gap: Array) -> Image:
        """A film (pixel,) along sliding over the image, with the shape of the bore, (y, x)."""
        shape = np.zeros(self.across.size) if self.bore is None else self.bore.at(self.across)
        whole = gap[:, np.newaxis] + shape
        return np.ascontiguousarray(whole.T if self.sliding_along_x else whole, np.float32)

    def grid(self, triggers: int) -> xr.Dataset:
        """Coordinates of the maps of so many triggers: trigger, y and x."""
        grid = xr.Dataset(
            coords={
                "trigger": FILM["trigger"].fill(np.arange(triggers)),
                "y": FILM["y"].fill(self.y),
                "x": FILM["x"].fill(self.x),
            }
        )
        sliding = "x" if self.sliding_along_x else "y"
        grid[sliding].attrs["long_name"] = f"{sliding} (sliding)"
        return grid

    def check(self) -> None:
        """Raise ConfigError where the image does not hold region, patch or load line."""
        _ = self.region, self.patch, self.view

    @cached_property
    def region(self) -> Region:
        """The region of interest; raises ConfigError where the image does not hold it."""
        roi = self.settings.thickness.roi
        return find_region(self.x, self.y, roi=None if roi is None else (roi.x, roi.y))

    @cached_property
    def patch(self) -> Region | None:
        """The reference patch; None without one. Raises ConfigError for fewer than 8 x 8 pixels."""
        region = self.settings.reference.region
        if region is None:
            return None
        columns, rows = (
            pixels_between(np.arange(size, dtype=float) * self.pitch, bounds)
            for bounds, size in ((region.x, self.shape[1]), (region.y, self.shape[0]))
        )
        if min(columns.stop - columns.start, rows.stop - rows.start) < _SMALLEST:
            raise ConfigError(
                f"Expected a reference patch of at least {_SMALLEST} x {_SMALLEST} pixels within "
                f"the image, x 0 to {(self.shape[1] - 1) * self.pitch:.2f} mm and y 0 to "
                f"{(self.shape[0] - 1) * self.pitch:.2f} mm; region of [reference] is x = "
                f"{list(region.x)}, y = {list(region.y)}. Correct it in run.toml."
            )
        return Region(rows, columns)

    @cached_property
    def view(self) -> PinView | None:
        """The joint as its camera sees it.

        None without [joint], and where the image is wider than half a turn of the pin. Raises
        ConfigError where the load line of the settings is more than a quarter of a turn from the
        image.
        """
        joint, given = self.settings.joint, self.settings.prediction.load_line
        if joint is None:
            return None
        sliding = self.along.size
        view = PinView(
            joint.pin_radius,
            joint.bushing_radius,
            self.pitch,
            load_line=0.5 * (sliding - 1) * self.pitch if given is None else given * 1e3,
            axial_origin=self.axial_origin,
            sliding_along_x=self.sliding_along_x,
            bore=self.bore,
        )
        last = (sliding - 1) * self.pitch
        if view.sees(0.0, last):
            return view
        if given is None:
            return None
        quarter = 0.5 * np.pi * view.radius
        raise ConfigError(
            "Expected a load line no more than a quarter of a turn of the pin from any pixel, "
            f"{last - quarter:.1f} to {quarter:.1f} mm; [prediction] load_line is "
            f"{view.load_line:.1f} mm. Correct load_line, pixel_pitch in [optics], or the radii in "
            "[joint]."
        )
