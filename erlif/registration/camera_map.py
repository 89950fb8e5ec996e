"""The map from camera 1 to camera 2: a product that is estimated once and used for a whole run."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import RegistrationError
from erlif.registration.settings import RegistrationSettings


@dataclass(frozen=True)
class CameraMap:
    """Displacement of camera 2 against camera 1: camera-2 pixel minus camera-1 pixel of the same object point.

    Pixel centres lie at integers, x to the right and y down. If the settings name an orientation, the camera-2 pixels
    are those of the image after `orient`.
    """

    displacement_x: AnyArray
    """(y, x), float32; NaN more than a few pixels beyond the frame of camera 2. [px]"""
    displacement_y: AnyArray
    """(y, x), float32, as displacement_x. [px]"""
    displacement_std: AnyArray
    """(y, x), float32: standard deviation of one component, the rms of the two. [px]"""
    overlap: AnyArray
    """(y, x), bool: camera 2 sees the point, at zero drift."""
    poor: AnyArray
    """(y, x), bool: the cameras are not laid over each other well enough here."""
    quality: float
    """Correlation coefficient of the two textures after alignment. [1]"""
    model: str
    """What the map is made of, in words."""
    settings: RegistrationSettings = field(default_factory=RegistrationSettings)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of camera 1."""
        return self.displacement_x.shape[0], self.displacement_x.shape[1]

    def to_dataset(self) -> xr.Dataset:
        """The map as a dataset (y, x) that can be written to a file and read back by `from_dataset`."""
        what = "camera-2 pixel minus camera-1 pixel of the same object point"
        return xr.Dataset(
            {
                "displacement_x": (
                    ("y", "x"),
                    self.displacement_x,
                    {"units": "px", "long_name": f"{what}, along x"},
                ),
                "displacement_y": (
                    ("y", "x"),
                    self.displacement_y,
                    {"units": "px", "long_name": f"{what}, along y"},
                ),
                "displacement_std": (
                    ("y", "x"),
                    self.displacement_std,
                    {
                        "units": "px",
                        "long_name": "standard deviation of one component of the displacement",
                    },
                ),
                "overlap": (
                    ("y", "x"),
                    self.overlap.astype(np.uint8),
                    {"units": "1", "long_name": "1 where camera 2 sees the point"},
                ),
                "poor": (
                    ("y", "x"),
                    self.poor.astype(np.uint8),
                    {"units": "1", "long_name": "1 where the registration is not good enough"},
                ),
            },
            attrs={
                "registration_quality": self.quality,
                "registration_model": self.model,
                **{
                    f"registration_{name}": int(value) if isinstance(value, bool) else value
                    for name, value in asdict(self.settings).items()
                    if name != "model"
                },
                "registration_model_asked": self.settings.model,
            },
        )

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> CameraMap:
        """Read back what `to_dataset` made.

        Raises
        ------
        RegistrationError
            If a variable or an attribute is missing.
        """
        try:
            attrs = dataset.attrs
            kinds = {name: type(value) for name, value in asdict(RegistrationSettings()).items()}
            chosen: dict[str, Any] = {
                name: kind(
                    attrs["registration_model_asked" if name == "model" else f"registration_{name}"]
                )
                for name, kind in kinds.items()
            }
            return cls(
                displacement_x=np.asarray(dataset["displacement_x"].values, np.float32),
                displacement_y=np.asarray(dataset["displacement_y"].values, np.float32),
                displacement_std=np.asarray(dataset["displacement_std"].values, np.float32),
                overlap=np.asarray(dataset["overlap"].values, bool),
                poor=np.asarray(dataset["poor"].values, bool),
                quality=float(attrs["registration_quality"]),
                model=str(attrs["registration_model"]),
                settings=RegistrationSettings(**chosen),
            )
        except KeyError as missing:
            raise RegistrationError(
                f"A stored camera map needs {missing.args[0]!r}, which this dataset lacks; "
                "register the cameras again and store the map with to_dataset."
            ) from missing


def describe_map(camera_map: CameraMap) -> xr.Dataset:
    """A camera map as a group of a file."""
    compress = {"zlib": True, "complevel": 1, "shuffle": True}
    dataset = camera_map.to_dataset()
    for name in dataset:
        dataset[name].encoding.update(compress)
    return dataset


def move_map(camera_map: CameraMap, by: Array) -> CameraMap:
    """The same map with a translation taken up, so that the mean drift of its frames is zero. [px]"""
    said = (
        f"; the mean drift taken up is ({by[0]:.3f}, {by[1]:.3f}) px"
        if "stored" in camera_map.model
        else ""
    )
    return replace(
        camera_map,
        displacement_x=(camera_map.displacement_x + by[0]).astype(np.float32),
        displacement_y=(camera_map.displacement_y + by[1]).astype(np.float32),
        model=camera_map.model + said,
    )
