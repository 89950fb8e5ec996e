"""Files of the Visualization Toolkit (VTK) for ParaView: a structured grid for each trigger.

The format is the one that VTK documents as its XML file formats: text, with the arrays as
base64 of zlib blocks.

Its points are the pixels of the film: on the cylinder of the pin, or on a plane.
"""

from __future__ import annotations

import base64
import struct
import zlib
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import ConfigError
from erlif.core.progress import Progress
from erlif.core.version import __version__
from erlif.io.conversion.contents import maps_of, trigger_columns
from erlif.io.files import settings_of

_TYPES = {"float32": "Float32", "float64": "Float64", "uint16": "UInt16"}
_HEAD = (
    '<?xml version="1.0"?>\n<!-- erlif {version} -->\n<VTKFile type="{kind}" version="1.0" '
    'byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">\n'
)
_TAIL = "</VTKFile>\n"
_FULL_TURN = 360.0  # degree
_QUOTES = {'"': "&quot;"}  # a name stands between them


def write_series(
    film: xr.Dataset, folder: Path, *, name: str, triggers: list[int], progress: Progress
) -> None:
    """Write a folder with a grid for each trigger and a ``.pvd`` file that lists them.

    Parameters
    ----------
    film : xarray.Dataset
    folder : Path
        Folder to make.
    name : str
        Name of the ``.pvd`` file and beginning of the names of the grids.
    triggers : list of int
        Triggers to write. The time steps are seconds, or their numbers where no time is known.
    progress : Progress
        Called after each trigger.
    """
    folder.mkdir()
    points = _data("Points", find_surface(film).reshape(-1, 3).astype(np.float32))
    columns = trigger_columns(film)
    digits = max(3, len(str(triggers[-1])))
    steps, times = [], _time_steps(film)
    for k, trigger in enumerate(triggers):
        file = f"{name}_{trigger:0{digits}d}.vts"
        numbers = {
            column.heading: column.values[trigger : trigger + 1].astype(float)
            for column in columns
            if column.name != "trigger" and column.values.dtype.kind in "iufb"
        }
        text = _grid(film, trigger, points=points, numbers=numbers)
        (folder / file).write_text(text, encoding="ascii", errors="xmlcharrefreplace")
        steps.append(f'    <DataSet timestep="{times[trigger]:.9g}" file="{file}"/>\n')
        progress("maps", k + 1, len(triggers))

    head = _HEAD.format(kind="Collection", version=__version__)
    listed = f"{head}  <Collection>\n{''.join(steps)}  </Collection>\n{_TAIL}"
    (folder / f"{name}.pvd").write_text(listed, encoding="ascii")


def _time_steps(film: xr.Dataset) -> Array:
    """Time of each trigger [s]; of averaged cycles from the first trigger, at the given speed.

    The numbers of the triggers where neither is known.
    """
    if "time" in film:
        return np.asarray(film.time.values, float)
    motion = settings_of(film).mechanism if "settings" in film.attrs else None
    speed = getattr(motion, "crank_speed", None) or getattr(motion, "speed", None)
    speed = speed or 2 * np.pi * getattr(motion, "frequency", 0.0)
    if not speed or "crank_angle" not in film:
        return np.arange(film.sizes["trigger"], dtype=float)
    turned = (film.crank_angle.values - film.crank_angle.values[0]) % _FULL_TURN
    return np.asarray(np.radians(turned) / speed)


def _grid(film: xr.Dataset, trigger: int, *, points: str, numbers: dict[str, AnyArray]) -> str:
    """The grid of one trigger."""
    extent = f"0 {film.sizes['x'] - 1} 0 {film.sizes['y'] - 1} 0 0"
    maps = {
        f"{name} [{film[name].attrs['units']}]" if name != "flags" else name: values.ravel()
        for name, values in maps_of(film, trigger)
    }
    first = next(iter(maps))
    parts = [
        _HEAD.format(kind="StructuredGrid", version=__version__),
        f'  <StructuredGrid WholeExtent="{extent}">\n    <FieldData>\n',
        *(_data(label, value, field=True) for label, value in numbers.items()),
        f'    </FieldData>\n    <Piece Extent="{extent}">\n',
        f'      <PointData Scalars="{first}">\n',
        *(_data(label, values) for label, values in maps.items()),
        f"      </PointData>\n      <Points>\n{points}      </Points>\n",
        f"    </Piece>\n  </StructuredGrid>\n{_TAIL}",
    ]
    return "".join(parts)


def _data(name: str, values: AnyArray, *, field: bool = False) -> str:
    """One array as a single block: its number and sizes, then the compressed bytes."""
    content = values.astype(values.dtype.newbyteorder("<")).tobytes()
    packed = zlib.compress(content, 1)
    header = struct.pack("<QQQQ", 1, len(content), 0, len(packed))
    text = (base64.b64encode(header) + base64.b64encode(packed)).decode("ascii")
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    count = f' NumberOfTuples="{len(values)}"' if field else ""
    kind = _TYPES[str(values.dtype)]
    return (
        f'        <DataArray type="{kind}" Name="{escape(name, _QUOTES)}"{components}{count} '
        f'format="binary">{text}</DataArray>\n'
    )


# Kinds of motion whose surfaces are flat, whatever [joint] states.
_FLAT = ("sinusoidal",)


def find_surface(film: xr.Dataset) -> Array:
    """Place the pixels on the surface that they show.

    With [joint], positions along sliding are arcs on a cylinder of the radius of the pin, whose
    axis passes through the origin; the load line (that of the settings, else of the positions of
    the pin, else the middle of the image) is at the top, where Z is the radius. Without [joint] the
    surface is the plane Z = 0. Seen from above, the surface looks as in the camera: X to the right,
    Y up, so that Y is -y.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.open_film` returns it; the radius is that of its settings.

    Returns
    -------
    array, (y, x, 3)
        X, Y and Z of the pixel centres. [mm]

    Raises
    ------
    ConfigError
        If the image is longer than the circumference of the pin.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> points = find_surface(example_film())
    >>> float(np.hypot(points[..., 0], points[..., 2]).max().round(6))
    33.36
    """
    settings = settings_of(film)
    x, y = np.broadcast_arrays(film.x.values, -film.y.values[:, None])
    flat = settings.linkage is not None and settings.linkage.kind in _FLAT
    if settings.joint is None or flat:
        return np.stack([x, y, np.zeros_like(x)], axis=-1)

    # the direction along the axis keeps its place, the other is wound up
    radius = settings.joint.pin_radius * 1e3
    along_x = settings.optics.x_axis == "sliding"
    sliding = (x if along_x else -y).astype(float)
    length = float(sliding.max() - sliding.min())
    if length > 2 * np.pi * radius:
        raise ConfigError(
            "Expected an image no longer than the circumference of the pin, "
            f"{2 * np.pi * radius:.1f} mm; it is {length:.1f} mm along sliding. Correct "
            "pixel_pitch in [optics] or pin_radius in [joint], and process the run again."
        )
    # the load line is measured from the first pixel of the camera, also where the film is cropped
    line = 0.5 * float(sliding.max() + sliding.min())
    if settings.prediction.load_line is not None:
        line = settings.prediction.load_line * 1e3
    elif "pin_displacement" in film:
        line = film.pin_displacement.attrs.get("load_line", line)
    angle = (sliding - line) / radius
    wound, height = radius * np.sin(angle), radius * np.cos(angle)
    return np.stack([wound, y, height] if along_x else [x, -wound, height], axis=-1)
