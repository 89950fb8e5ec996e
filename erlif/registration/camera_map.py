"""The map from camera 1 to camera 2: estimated once, used for all frames of a run, stored in files.

One map serves a whole run because the cameras are fixed to each other; the small translation of a
single frame is a `erlif.registration.Drift` on top of it.
"""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass, field, replace
from enum import Enum
from typing import Any, Final

import numpy as np
import xarray as xr

from erlif.core.arrays import Array, Image, Mask
from erlif.core.errors import RegistrationError
from erlif.core.html import Range, captioned, card, colour_picture, picture_tag, rows_table
from erlif.core.variables import REGISTRATION
from erlif.registration.settings import RegistrationSettings


class MapKind(Enum):
    """Form of the displacement in a camera map. The values are the words of the files."""

    SURFACE = "surface"  #: a polynomial or spline surface over the whole frame
    LOCAL = "local windows"  #: one displacement for each window, interpolated between the windows


@dataclass(frozen=True, repr=False)
class CameraMap:
    """Displacement of camera 2: camera-2 pixel minus camera-1 pixel of the same object point.

    Pixel centres lie at integers, x to the right and y down. If the settings name an orientation,
    the camera-2 pixels are those of the image after `orient`.

    Attributes
    ----------
    displacement_x : Image
        (y, x); NaN more than a few pixels beyond the frame of camera 2. [px]
    displacement_y : Image
        (y, x), as displacement_x. [px]
    displacement_std : Image
        (y, x): standard deviation of one component, the rms of the two. [px]
    overlap : Mask
        (y, x): True where camera 2 sees the point, at zero drift.
    poor : Mask
        (y, x): True where the registration is not accurate enough here.
    quality : float
        Correlation coefficient of the two textures after alignment. [1]
    kind : MapKind
        Surface or local windows.
    resolution : str
        How fine the surface or the windows are, for the reader of a report.
    settings : RegistrationSettings
        Settings with which the map was found.
    stored : bool
        True if the map comes from a calibration, False if it was found on the frames at hand.
    drift_taken_up : tuple[float, float] | None
        Mean drift (x, y) of the run, already added to a stored map; None without one. [px]
    """

    displacement_x: Image
    displacement_y: Image
    displacement_std: Image
    overlap: Mask
    poor: Mask
    quality: float
    kind: MapKind
    resolution: str = ""
    settings: RegistrationSettings = field(default_factory=RegistrationSettings)
    stored: bool = False
    drift_taken_up: tuple[float, float] | None = None

    def __repr__(self) -> str:
        rows, columns = self.shape
        lines = [f"camera map of {columns} x {rows} pixels"]
        return "\n".join([*lines, *(f"  {name:<30}{value}" for name, value in _map_rows(self))])

    def _repr_html_(self) -> str:
        rows, columns = self.shape
        return card(
            "camera map",
            f"{columns} x {rows} pixels",
            rows_table(_map_rows(self)),
            _draw_displacement(self),
        )

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of camera 1."""
        return self.displacement_x.shape[0], self.displacement_x.shape[1]

    @property
    def model(self) -> str:
        """Description of the map for reports and files; `from_dataset` reads it back."""
        # files of all versions have these words, so they stay as they are
        text = f"{self.kind.value}, {self.resolution}" if self.resolution else self.kind.value
        if self.stored:
            text += ", stored with the calibration"
        if self.drift_taken_up is not None:
            x, y = self.drift_taken_up
            text += f"; the mean drift taken up is ({x:.3f}, {y:.3f}) px"
        return text

    def to_dataset(self) -> xr.Dataset:
        """Return the map as a dataset (y, x) for a file; `from_dataset` reads it back."""
        # netCDF has no boolean attribute; the key "model" is taken by the description of the map
        settings = {
            _setting_attribute(name): int(value) if isinstance(value, bool) else value
            for name, value in asdict(self.settings).items()
        }
        dataset = xr.Dataset(
            {
                name: variable.fill(getattr(self, name).astype(variable.dtype, copy=False))
                for name, variable in REGISTRATION.items()
            },
            attrs={
                "registration_quality": self.quality,
                "registration_model": self.model,
                **settings,
            },
        )
        # the lowest level: the last bits of a displacement are noise, which no level compresses
        for name in dataset:
            dataset[name].encoding.update(zlib=True, complevel=1, shuffle=True)
        return dataset

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> CameraMap:
        """Read back the dataset of `to_dataset`.

        Raises
        ------
        RegistrationError
            If a variable or an attribute is missing, or the description of the map is not known.
        """
        defaults = asdict(RegistrationSettings())
        attributes = {name: _setting_attribute(name) for name in defaults}
        named = ("registration_quality", "registration_model", *attributes.values())
        # all that is missing is named at once
        missing = [name for name in REGISTRATION if name not in dataset]
        missing += [name for name in named if name not in dataset.attrs]
        if missing:
            raise RegistrationError(
                f"A stored camera map needs {', '.join(missing)}, which this dataset lacks; "
                "register the cameras again and store the map with to_dataset."
            )

        # a file returns numpy scalars, and integers for booleans
        attrs = dataset.attrs
        chosen: dict[str, Any] = {
            name: type(default)(attrs[attributes[name]]) for name, default in defaults.items()
        }
        kinds = {"float32": np.float32, "uint8": bool}
        images: dict[str, Any] = {
            name: np.asarray(dataset[name].values, kinds[variable.dtype])
            for name, variable in REGISTRATION.items()
        }
        return cls(
            **images,
            quality=float(attrs["registration_quality"]),
            settings=RegistrationSettings(**chosen),
            **_read_model(str(attrs["registration_model"])),
        )


# The description that `CameraMap.model` writes, in its parts.
_MODEL: Final = re.compile(
    r"(?P<kind>[^,;]+)(, (?P<resolution>.+?))??(?P<stored>, stored with the calibration)?"
    r"(; the mean drift taken up is \((?P<x>[-+.\d]+), (?P<y>[-+.\d]+)\) px)?"
)


def _read_model(text: str) -> dict[str, Any]:
    """Fields of a camera map from its description in a file."""
    parts = _MODEL.fullmatch(text)
    if parts is None or parts["kind"] not in {kind.value for kind in MapKind}:
        raise RegistrationError(
            f"The stored camera map is described as {text[:80]!r}, which is not a kind of map that "
            f"this version knows ({', '.join(kind.value for kind in MapKind)}); register the "
            "cameras again."
        )
    return {
        "kind": MapKind(parts["kind"]),
        "resolution": parts["resolution"] or "",
        "stored": parts["stored"] is not None,
        "drift_taken_up": None if parts["x"] is None else (float(parts["x"]), float(parts["y"])),
    }


def _setting_attribute(name: str) -> str:
    """Name of the attribute that holds a setting in a file."""
    return "registration_model_asked" if name == "model" else f"registration_{name}"


def move_map(camera_map: CameraMap, by: Array) -> CameraMap:
    """Add a translation to a map, so that the mean drift of its frames becomes zero.

    Parameters
    ----------
    camera_map : CameraMap
        The map. A stored one keeps a record of the translation in ``drift_taken_up``.
    by : array, (2,)
        Translation (x, y), positive towards larger column and row. [px]

    Returns
    -------
    CameraMap
        The moved map.

    Examples
    --------
    >>> flat = np.zeros((2, 3), np.float32)
    >>> found = CameraMap(flat + 4, flat - 3, flat, flat == 0, flat > 0, 0.9, MapKind.SURFACE)
    >>> moved = move_map(found, np.array([0.5, -0.25]))
    >>> float(moved.displacement_x[0, 0]), float(moved.displacement_y[0, 0])
    (4.5, -3.25)
    """
    # the map of a run's own frames has its mean drift by definition; nothing is to be recorded
    taken_up = None
    if camera_map.stored:
        before = camera_map.drift_taken_up or (0.0, 0.0)
        taken_up = (before[0] + float(by[0]), before[1] + float(by[1]))
    return replace(
        camera_map,
        displacement_x=(camera_map.displacement_x + by[0]).astype(np.float32),
        displacement_y=(camera_map.displacement_y + by[1]).astype(np.float32),
        drift_taken_up=taken_up,
    )


def _map_rows(camera_map: CameraMap) -> list[tuple[str, str]]:
    """Displacement and its error by name and value."""
    ranges = []
    for axis in ("x", "y"):
        image = getattr(camera_map, f"displacement_{axis}")
        low, high = _limits(image, camera_map.overlap)
        ranges.append((f"displacement along {axis}", f"{low:.2f} to {high:.2f} px"))

    std = camera_map.displacement_std[camera_map.overlap]
    known = std[np.isfinite(std)]
    median = f"{float(np.median(known)):.3f} px (median)" if known.size else "not known"
    return [
        ("model", camera_map.model),
        *ranges,
        ("standard deviation", median),
        ("correlation after alignment", f"{camera_map.quality:.3f}"),
        ("seen by both cameras", f"{float(camera_map.overlap.mean()):.1%}"),
        ("poor registration", f"{float(camera_map.poor.mean()):.1%}"),
    ]


def _limits(image: Image, where: Mask) -> Range:
    """Smallest and largest value that is known; zeros without any."""
    known = image[where & np.isfinite(image)]
    return (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)


def _draw_displacement(camera_map: CameraMap) -> str:
    """Both components of the displacement as small pictures."""
    pictures = []
    for name, image in (("x", camera_map.displacement_x), ("y", camera_map.displacement_y)):
        shown = np.where(camera_map.overlap, image, np.nan)
        limits = _limits(image, camera_map.overlap)
        caption = f"displacement along {name}, {limits[0]:.2f} to {limits[1]:.2f} px"
        pictures.append((picture_tag(colour_picture(shown, limits), alt=caption), caption))
    return captioned(pictures)
