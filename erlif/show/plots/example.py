"""A small film that follows from formulas, for the examples of the documentation.

The gap is that of two rigid cylinders; its minimum follows a power of the speed. Kinematics and
theory are those of `erlif.models`, so that every figure of a film can be drawn from it.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration import Calibration, calibration_of, record_calibration
from erlif.core.arrays import Array
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.io.files import set_coordinates, write_dataset
from erlif.io.settings import RunSettings, to_toml
from erlif.models.contact import conformal_radius
from erlif.models.mechanism import CrankRocker
from erlif.pipeline.film import predict_theory
from erlif.pipeline.physics.joint import build_linkage
from erlif.pipeline.physics.position import choose_view, describe_positions
from erlif.pipeline.physics.prediction import choose_theory
from erlif.trend import PinPosition

_ROWS, _COLUMNS = 24, 64
_PITCH = 0.25  # mm
_CRANK = np.array([250.0, 290.0, 330.0, 70.0, 110.0, 150.0])  # degree, three on either stroke
_POWER = 0.6  # of the speed, which the minimum film thickness follows
_FILM = 2.0  # um, minimum film thickness at 1 rad/s
_NOISE = 0.05  # um, standard deviation of one pixel
_START = 3.2  # um, predicted minimum film at the first trigger

_CAMERA = {"gain": "4.4 electron/DN", "read_noise": "9 electron", "offset": "64 DN"}
_POLYMER = {"youngs_modulus": "2.7 GPa", "poissons_ratio": 0.37, "roughness": "0.2 um"}
_SETTINGS = {
    "run": {"name": "example"},
    "camera1": {"files": "camera1/*.tif", "band": "580 nm", **_CAMERA},
    "camera2": {"files": "camera2/*.tif", "band": "610 nm", **_CAMERA},
    "optics": {"pixel_pitch": "250 um"},
    "encoder": {"file": "encoder.csv", "zero": "47.4095 deg"},
    "mechanism": {
        "kind": "crank-rocker",
        "crank": "5.5 cm",
        "coupler": "44 cm",
        "rocker": "26 cm",
        "ground": "51 cm",
        "crank_speed": "114 rpm",
    },
    "joint": {
        "pin_radius": "33.36 mm",
        "bushing_radius": "33.59 mm",
        "length": "237 mm",
        "load": "50 lbf",
        "pin": _POLYMER,
        "bushing": _POLYMER,
    },
    "oil": {"viscosity": "0.12 Pa s", "pressure_viscosity": "20 1/GPa"},
    "thickness": {"roi": {"x": [2, 14], "y": [1, 5]}},
}


def example_calibration() -> Calibration:
    """Make a calibration whose points lie on the reabsorption model.

    Returns
    -------
    Calibration
        Of a wedge from 0.3 um to 16 um, with 20 points.

    Examples
    --------
    The ratio of a vanishing film is K:

    >>> calibration = example_calibration()
    >>> float(calibration.predict(1e-9).round(4))
    0.66
    """
    settings = RunSettings.model_validate(_SETTINGS)
    empty = Calibration(
        ratio_at_zero=0.66,
        attenuation_camera1=0.39,
        attenuation_camera2=0.245,
        covariance=np.diag([1e-3, 2e-3, 1e-3]) ** 2,
        thickness_range=(0.3, 16.0),
        bands=(settings.camera1.band, settings.camera2.band),
        curve=xr.Dataset(),
        reduced_chi_square=1.0,
        fixture="example wedge",
    )
    thickness = np.linspace(0.3, 16.0, 20)
    curve = xr.Dataset(
        {
            "curve_thickness": ("bin", thickness, {"units": "um"}),
            "curve_ratio": ("bin", empty.predict(thickness), {"units": "1"}),
            "curve_ratio_std": ("bin", np.full(20, 2e-3), {"units": "1"}),
            "curve_residual": ("bin", np.zeros(20), {"units": "1"}),
        }
    )
    return replace(empty, curve=curve)


def example_film() -> xr.Dataset:
    """Make a film of six triggers, with noise, a bubble and an edge that camera 2 does not see.

    Returns
    -------
    xarray.Dataset
        As `erlif.process` returns it, thickness (trigger, y, x) [um] among its variables.

    Examples
    --------
    The minimum film thickness is 2 um at 1 rad/s and grows with the speed to the power of 0.6:

    >>> film = example_film()
    >>> speed = abs(film.rocker_speed)
    >>> bool(abs(film.film_min / (2 * speed**0.6) - 1).max() < 1e-12)
    True
    """
    settings = RunSettings.model_validate(_SETTINGS)
    film = _example_triggers(settings)
    film = film.merge(_example_maps(film.film_min.values, settings))
    film = film.assign(_example_positions(film.film_min.values, settings))

    # film = c (speed / load)^n, so that c is 2 um times the load to the power of n
    scale = math.log(_FILM * float(film["load"][0]) ** _POWER)
    attrs = {"log_scale": scale, "triggers_used": _CRANK.size}
    for suffix in ("", "_mean"):
        film[f"speed_exponent{suffix}"] = ((), _POWER, attrs)
        film[f"speed_exponent{suffix}_std"] = ((), 0.01)
    return set_coordinates(film).assign_attrs(
        title="oil-film thickness, example",
        history="made by formula",
        settings=to_toml(settings),
        calibration=record_calibration(example_calibration()),
        input_hashes=json.dumps({}),
        notes="",
    )


def _example_triggers(settings: RunSettings) -> xr.Dataset:
    """Kinematics, statistics and theory of the triggers."""
    links, encoder, joint = settings.linkage, settings.encoder, settings.joint
    assert links is not None  # these tables stand in _SETTINGS
    assert encoder is not None
    assert joint is not None
    mechanism = build_linkage(links)
    assert isinstance(mechanism, CrankRocker)
    crank = np.radians(_CRANK)
    speed = np.asarray(mechanism.rocker_speed(crank, crank_speed=links.crank_speed))
    angle = np.degrees(mechanism.rocker_angle(crank) - (encoder.zero or 0.0))

    minimum = _FILM * np.abs(speed) ** _POWER
    every = np.ones(_CRANK.size)
    columns = {
        "encoder_angle": (np.asarray(angle), "degree"),
        "crank_angle": (_CRANK, "degree"),
        "rocker_speed": (speed, "rad s-1"),
        "sliding_speed": (np.abs(speed) * joint.pin_radius, "m s-1"),
        "load": (every * (joint.load or 0.0), "N"),
        "stroke": (np.sign(speed), "1"),
        "frames_used": (every.astype(int), "1"),
        "film_min": (minimum, "um"),
        "film_min_std": (0.03 * every, "um"),
        "film_mean": (1.3 * minimum, "um"),
        "film_mean_std": (0.02 * every, "um"),
    }
    film = xr.Dataset(
        {name: ("trigger", values, {"units": unit}) for name, (values, unit) in columns.items()},
        {"trigger": np.arange(_CRANK.size)},
    )
    theory = choose_theory(settings, predict_theory(settings, film), _example_prediction(settings))
    return film.merge(theory, combine_attrs="drop_conflicts")


def _example_maps(minimum: Array, settings: RunSettings) -> xr.Dataset:
    """Maps of the rigid gap with noise."""
    x, y = _PITCH * np.arange(_COLUMNS), _PITCH * np.arange(_ROWS)
    joint = settings.joint
    assert joint is not None  # in _SETTINGS
    radius = conformal_radius(joint.pin_radius, bushing_radius=joint.bushing_radius)

    # x^2/2R of x in mm and R in m is in um
    clearance = 1e6 * (joint.bushing_radius - joint.pin_radius)
    bend = (1 - minimum / clearance) / radius
    gap = bend[:, None, None] * (x - x.mean()) ** 2 / 2
    truth = minimum[:, None, None] + np.broadcast_to(gap, (minimum.size, _ROWS, _COLUMNS))
    noise = _NOISE * np.random.default_rng(1).standard_normal(truth.shape)

    flags = np.zeros(truth.shape, np.uint8)
    flags[:, :, :2] = Flag.OUTSIDE_OVERLAP
    flags[:, 2:6, 10:14] = Flag.NO_FILM
    dims, valid = ("trigger", "y", "x"), flags == 0
    maps = {
        "thickness": truth + noise,
        "thickness_std": np.full(truth.shape, _NOISE),
        "thickness_std_shared": np.full(truth.shape, 0.02),
    }
    film = xr.Dataset(
        {
            name: (dims, np.where(valid, values, np.nan).astype(np.float32), {"units": "um"})
            for name, values in maps.items()
        },
        {"x": ("x", x, {"units": "mm"}), "y": ("y", y, {"units": "mm"})},
    )
    return film.assign(flags=(dims, flags, FLAG_ATTRS))


def _example_positions(minimum: Array, settings: RunSettings) -> dict[str, Any]:
    """Positions of a pin whose film is thinnest at the load line, and the form of circles."""
    view = choose_view(settings, (_ROWS, _COLUMNS))
    assert view is not None  # _SETTINGS have a joint
    random, surface = np.diag([3e-3, 4e-2, 1e-3, 1e-2]) ** 2, np.diag([4e-3, 3e-2, 2e-3, 1e-2]) ** 2
    gradient = np.array([[-0.02, 0.0, 0.01], [0.0, 0.05, -0.02], [0.0] * 3, [0.0] * 3])
    form = 1e-3**2 * np.eye(2)
    positions = [
        PinPosition(
            value=np.array([view.clearance - film_min, 0.0, 0.0, 0.0]),
            random_cov=random,
            surface_cov=surface,
            gradient=gradient,
            form=np.zeros(2),
            form_random_cov=form,
            form_surface_cov=form,
            form_gradient=np.zeros((2, 3)),
        )
        for film_min in minimum
    ]
    return describe_positions(positions, example_calibration(), view)


def _example_prediction(settings: RunSettings) -> xr.Dataset:
    """A film that sinks from trigger to trigger, of a pin that swings a little."""
    joint = settings.joint
    assert joint is not None  # in _SETTINGS
    clearance = 1e6 * (joint.bushing_radius - joint.pin_radius)
    minimum = _START / (1 + 0.02 * np.arange(_CRANK.size)) ** 2
    columns = {
        "film_predicted_min": (minimum, "um"),
        "film_predicted_mean": (minimum + 2.4, "um"),
        "eccentricity": (1 - minimum / clearance, "1"),
        "attitude": (3 * np.cos(np.radians(_CRANK)), "degree"),
    }
    predicted = xr.Dataset(
        {name: ("trigger", values, {"units": unit}) for name, (values, unit) in columns.items()}
    )
    predicted["attitude"].attrs["load_line"] = 0.5 * (_COLUMNS - 1) * _PITCH
    predicted["film_predicted_min"].attrs.update(start_film=_START, start_film_fitted=1)
    return predicted


def example_images(film: xr.Dataset, *, trigger: int) -> xr.Dataset:
    """Make the images behind a map, in even light of 1000 DN on camera 1.

    Parameters
    ----------
    film : xarray.Dataset
        From `example_film`.
    trigger : int
        Number of the trigger, counted from 0.

    Returns
    -------
    xarray.Dataset
        As `erlif.pipeline.restore_images` returns it: light (camera, y, x) [DN], log_ratio (y, x)
        [1], flags (y, x).

    Examples
    --------
    >>> images = example_images(example_film(), trigger=2)
    >>> images.light.dims, images.light.attrs["units"]
    (('camera', 'y', 'x'), 'DN')
    """
    one = film.isel(trigger=trigger)
    log_ratio = calibration_of(film).predict_log(one.thickness.values.astype(float))
    light = 1000.0 * np.stack([np.ones_like(log_ratio), np.exp(log_ratio)])
    return xr.Dataset(
        {
            "light": (("camera", "y", "x"), light, {"units": "DN"}),
            "log_ratio": (("y", "x"), log_ratio, {"units": "1"}),
            "flags": (("y", "x"), one.flags.values, FLAG_ATTRS),
        },
        {"camera": [1, 2], "x": film.x, "y": film.y},
        {"trigger": trigger, "frames": [trigger]},
    )


def example_registration() -> xr.Dataset:
    """Make a displacement map of two cameras that are turned by 5 mrad against each other.

    Returns
    -------
    xarray.Dataset
        Group ``registration`` of a film: displacement_x and displacement_y (y, x) [px].

    Examples
    --------
    >>> registration = example_registration()
    >>> float(registration.displacement_x.mean().round(3))
    3.0
    """
    row, column = (
        np.indices((_ROWS, _COLUMNS)) - np.array([_ROWS, _COLUMNS])[:, None, None] / 2 + 0.5
    )
    angle = 5e-3
    shape, dims = (_ROWS, _COLUMNS), ("y", "x")
    overlap = np.ones(shape, np.uint8)
    overlap[:, :2] = 0
    return xr.Dataset(
        {
            "displacement_x": (dims, 3.0 - angle * row, {"units": "px"}),
            "displacement_y": (dims, -2.0 + angle * column, {"units": "px"}),
            "displacement_std": (dims, np.full(shape, 0.01), {"units": "px"}),
            "overlap": (dims, overlap, {"units": "1"}),
            "poor": (dims, np.zeros(shape, np.uint8), {"units": "1"}),
        },
        attrs={"registration_quality": 0.97, "registration_model": "similarity"},
    )


def example_frames() -> xr.Dataset:
    """Make the drift and the predicted film of the frames, one frame a trigger.

    Returns
    -------
    xarray.Dataset
        Group ``frames`` of a film: drift_x and drift_y (frame) [px], film_predicted_min [um] and
        elapsed_cycles.

    Examples
    --------
    >>> frames = example_frames()
    >>> frames.drift_x.values.tolist()
    [0.1, -0.1, 0.1, -0.1, 0.1, -0.1]
    """
    number = np.arange(_CRANK.size)
    predicted = _example_prediction(RunSettings.model_validate(_SETTINGS)).film_predicted_min
    drift = np.where(number % 2 == 0, 0.1, -0.1)
    return xr.Dataset(
        {
            "trigger": ("frame", number),
            "drift_x": ("frame", drift, {"units": "px"}),
            "drift_y": ("frame", -drift, {"units": "px"}),
            "pulse_energy": ("frame", np.ones(number.size), {"units": "1"}),
            "film_predicted_min": ("frame", predicted.values, {"units": "um"}),
            "elapsed_cycles": ("frame", (_CRANK - _CRANK[0]) % 360 / 360, {"units": "1"}),
        },
        {"frame": number},
    )


def write_example(path: str | Path) -> Path:
    """Write the film of `example_film` with its groups.

    Parameters
    ----------
    path : path
        The file, with the suffix ``.nc``.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    OutputError
        If it cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.io.files import open_film, settings_of
    >>> with TemporaryDirectory() as directory:
    ...     with open_film(write_example(f"{directory}/film.nc")) as film:
    ...         settings_of(film).name
    'example'
    """
    path = Path(path)
    groups = {"registration": example_registration(), "frames": example_frames()}
    write_dataset(example_film(), path, groups=groups)
    return path


def example_pressure() -> xr.Dataset:
    """Make a pressure of three triggers by the formula of a squeezed long film.

    Returns
    -------
    xarray.Dataset
        The variables of `erlif.pressure_from_film` that figures draw.

    Examples
    --------
    A film of 6 um under 50 lbf:

    >>> print(f"{example_pressure().peak_pressure.values[1]:.0f} kPa")
    78 kPa
    """
    settings = RunSettings.model_validate(_SETTINGS)
    film = example_film().isel(trigger=slice(3))
    joint = settings.joint
    assert joint is not None  # _SETTINGS have one
    load = film["load"].values
    radius = float(conformal_radius(joint.pin_radius, bushing_radius=joint.bushing_radius))
    reach = math.sqrt(2 * 6e-6 * radius)  # m

    # p = p0 (1 + x^2/2Rh)^-2, whose integral is pi/2 times reach and peak
    peak = 1e-3 * load / (joint.length * 0.5 * math.pi * reach)
    x, y = np.linspace(0.125, 15.875, 48), np.linspace(0.125, 5.875, 12)
    profile = peak[:, None] / (1 + ((x - 8.0) * 1e-3 / reach) ** 2) ** 2
    columns = {
        "pressure": (("trigger", "y", "x"), np.repeat(profile[:, None], y.size, axis=1)),
        "pressure_profile": (("trigger", "place"), profile),
        "pressure_profile_std": (("trigger", "place"), 0.05 * profile),
        "peak_pressure": ("trigger", peak),
        "peak_pressure_std": ("trigger", np.array([0.05, 0.04, 0.05]) * peak),
        "peak_place": ("trigger", np.full(3, 8.0)),
        "peak_place_std": ("trigger", np.full(3, 0.2)),
        "load_from_pressure": ("trigger", np.array([0.97, 1.01, 1.04]) * load),
        "load_from_pressure_std": ("trigger", 0.05 * load),
    }
    kept = film[["crank_angle", "encoder_angle", "stroke", "load"]].drop_vars(
        ["x", "y"], errors="ignore"
    )
    return (
        kept.assign(columns)
        .assign_coords(x=x, y=y, place=x)
        .assign_attrs(settings=film.attrs["settings"], statement="made by formula")
    )
