"""A small run of known film thickness, ratio and speed, for figures and report."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tifffile
import xarray as xr

from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.io.files import open_film
from erlif.io.settings import RunSettings, read_run_settings, to_toml
from erlif.registration import CameraMap, MapKind
from scenes.four_bar import Solver

ROWS, COLUMNS, TRIGGERS = 64, 80, 6
PITCH = 0.2  # mm
CLEARANCE = 230.0  # um, R1 - R2
RADIUS = 4.872010  # m, R1 R2/(R1 - R2) of 33.59 and 33.36 mm (thesis, 2.8)
K, P, Q = 0.66, 0.39, 0.245
PLACE, TILT = 8.1, 0.3  # mm, um across the image
NOISE = 0.01  # of the logarithm of the ratio
POWER = 0.6
INNER_ANGLE = 47.4095  # degree, rocker at its inner dead point (thesis, Appendix A)

RUN_TOML = """
[run]
name = "a film <known> & small"
[camera1]
files = "camera1/*.tif"
band = "580 nm"
offset = "64 DN"
gain = "4.4 electron/DN"
read_noise = "9 electron"
[camera2]
files = "camera2/*.tif"
band = "610 nm"
offset = "64 DN"
gain = "4.4 electron/DN"
read_noise = "9 electron"
[optics]
pixel_pitch = "200 um"
[encoder]
file = "encoder.csv"
zero = "47.4095 deg"
[mechanism]
kind = "crank-rocker"
crank = "5.5 cm"
coupler = "44 cm"
rocker = "26 cm"
ground = "51 cm"
crank_speed = "114 rpm"
[joint]
pin_radius = "33.36 mm"
bushing_radius = "33.59 mm"
length = "237 mm"
load = "50 lbf"
pin = { youngs_modulus = "2.7 GPa", poissons_ratio = 0.37, roughness = "0.2 um" }
bushing = { youngs_modulus = "2.7 GPa", poissons_ratio = 0.37, roughness = "0.2 um" }
[oil]
viscosity = "0.12 Pa s"
pressure_viscosity = "20 1/GPa"
[thickness]
roi = { x = [3, 13], y = [1, 11] }
"""

LOAD = 222.411  # N
CRANK = np.array([250.0, 290.0, 330.0, 70.0, 110.0, 150.0])  # degree


def true_ratio(thickness: np.ndarray) -> np.ndarray:
    """Ratio camera 2 / camera 1 of a film in um, written out."""
    return K * (P / Q) * (1 - np.exp(-Q * thickness)) / (1 - np.exp(-P * thickness))


LINKAGE = Solver((0.055, 0.44, 0.26, 0.51))


def rocker_angle(crank: np.ndarray) -> np.ndarray:
    """Interior rocker angle. [degree]"""
    return np.degrees(LINKAGE.rocker_angle(np.radians(crank)))


def rocker_speed(crank: np.ndarray) -> np.ndarray:
    """Rocker speed at 114 rpm. [rad/s]"""
    return LINKAGE.speed(np.radians(crank)) * 114 * math.pi / 30


def true_film() -> np.ndarray:
    """Gap of rigid bodies with a tilt along y. (trigger, y, x) [um]

    Its minimum is proportional to |speed|^POWER.
    """
    x, y = PITCH * np.arange(COLUMNS), np.linspace(-0.5, 0.5, ROWS)
    minimum = minimum_film()[:, None, None]
    bend = (1 - minimum / CLEARANCE) / RADIUS  # distance of the middles over R1 R2
    return minimum + bend * (x - PLACE) ** 2 / 2 + TILT * y[None, :, None]


def minimum_film() -> np.ndarray:
    """Minimum film thickness of each trigger, at half height of the image. [um]"""
    return 2.0 * np.abs(rocker_speed(CRANK)) ** POWER


def sunken_film() -> np.ndarray:
    """A predicted film that sinks from trigger to trigger. [um]"""
    return 4.0 - 0.1 * np.arange(TRIGGERS)


def frame_names() -> list[str]:
    """Names of the files of a camera."""
    return [f"frame_{k:02d}.tif" for k in range(TRIGGERS)]


def run_settings(text: str = "", **tables: dict | None) -> RunSettings:
    """Settings of the run with more text and tables.

    A table completes that of the run, one of another kind replaces it, and None leaves it out.
    """
    raw = tomllib.loads(RUN_TOML + text)
    for name, table in tables.items():
        whole = table is None or "kind" in table
        raw[name] = table if whole else raw.get(name, {}) | table
    return RunSettings.model_validate({name: one for name, one in raw.items() if one is not None})


def with_settings(film: xr.Dataset, *changes: tuple[str, str]) -> xr.Dataset:
    """A film with other text in its settings."""
    text = film.attrs["settings"]
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return film.assign_attrs(settings=text)


def make_run(directory: Path) -> RunSettings:
    """Write a run directory: two bands of even light whose ratio is that of the film."""
    (directory / "camera1").mkdir(parents=True)
    (directory / "camera2").mkdir()
    (directory / "run.toml").write_text(RUN_TOML, encoding="utf-8")
    for k, film in enumerate(true_film()):
        one = np.full(film.shape, 1000.0)
        for camera, light in ((1, one), (2, one * true_ratio(film))):
            tifffile.imwrite(
                directory / f"camera{camera}" / frame_names()[k],
                np.rint(light + 64).astype(np.uint16),
            )
    angle = rocker_angle(CRANK) - INNER_ANGLE
    rows = "".join(f"{k},{0.05 * k:.3f},{value:.6f}\n" for k, value in enumerate(angle))
    (directory / "encoder.csv").write_text(f"frame,time_s,angle_deg\n{rows}")
    return read_run_settings(directory)


def without_valid_pixels(film: xr.Dataset) -> xr.Dataset:
    """The same film with all pixels above the calibrated range."""
    empty = film.load().copy(deep=True)
    empty.flags.values[:] = Flag.ABOVE_RANGE
    for name, variable in empty.data_vars.items():
        if str(name).startswith(
            ("thickness", "film_m", "film_pa", "film_c", "pin", "speed_exponent")
        ):
            empty[name] = variable * np.nan
    return empty


def make_film(directory: Path) -> Path:
    """Write a run directory and its film with noise of a fixed seed; returns the path."""
    settings = make_run(directory)
    film = xr.Dataset(
        {
            name: ("trigger", values, {"units": unit})
            for name, (values, unit) in trigger_columns().items()
        },
        {
            "trigger": np.arange(TRIGGERS),
            "x": ("x", PITCH * np.arange(COLUMNS), {"units": "mm"}),
            "y": ("y", PITCH * np.arange(ROWS), {"units": "mm"}),
        },
    )
    film = film.assign(noisy_maps()).assign(pin_columns())

    for suffix, power in (("", POWER), ("_mean", 0.4)):
        attrs = {"log_scale": math.log(2.0 * LOAD**POWER), "triggers_used": TRIGGERS}
        film[f"speed_exponent{suffix}"] = ((), power, attrs)
        film[f"speed_exponent{suffix}_std"] = ((), 0.01)
    film.film_theory.attrs.update(
        regime="isoviscous-rigid", reason="the largest governs", long_name="steady film", notes=""
    )
    film.film_predicted_min.attrs.update(
        regime="transient Reynolds, pin free sideways",
        reason="the joint swings",
        long_name="transient film",
        notes="",
    )
    film.attitude.attrs["load_line"] = PLACE

    film.attrs.update(
        title=f"oil-film thickness, {settings.name}",
        settings=to_toml(settings),
        calibration=known_calibration(np.diag([1e-3, 2e-3, 1e-3]) ** 2),
        erlif_version="0.1.0",
        history="made by formula",
        notes="gain < measured",
        input_hashes=json.dumps({"run.toml": "ab" * 32}),
    )

    path = directory / "film.nc"
    film.to_netcdf(path, engine="h5netcdf")
    for name, group in {"frames": frames_group(), "registration": registration_group()}.items():
        group.to_netcdf(path, engine="h5netcdf", mode="a", group=name)
    return path


def known_calibration(covariance: np.ndarray) -> str:
    """Record of the calibration whose ratio is `true_ratio`."""
    return json.dumps(
        {
            "fixture": "known wedge",
            "ratio_at_zero": K,
            "attenuation_camera1": P,
            "attenuation_camera2": Q,
            "covariance": covariance.tolist(),
            "thickness_range": [0.2, 16.0],
            "covered_range": [0.2, 16.0],
            "input_hashes": {},
            "date": "",
        }
    )


def trigger_columns() -> dict[str, tuple[np.ndarray, str]]:
    """Values of the triggers with their units."""
    speed, minimum = rocker_speed(CRANK), minimum_film()
    hersey = 0.12 * np.abs(speed) * 0.03336 * 0.237 / LOAD
    friction = hersey * 2 * np.pi * 33.47 / np.sqrt(2 * 0.23 * 1e-3 * minimum)  # of thin films
    return {
        "encoder_angle": (rocker_angle(CRANK) - INNER_ANGLE, "degree"),
        "crank_angle": (CRANK, "degree"),
        "rocker_speed": (speed, "rad s-1"),
        "sliding_speed": (np.abs(speed) * 0.03336, "m s-1"),
        "joint_load": (np.full(TRIGGERS, LOAD), "N"),
        "stroke": (np.where(speed > 0, 1, -1), "1"),
        "frames_used": (np.ones(TRIGGERS, int), "1"),
        "film_mean": (true_film().mean(axis=(1, 2)), "um"),
        "film_mean_std": (np.full(TRIGGERS, 0.02), "um"),
        "film_min": (minimum, "um"),
        "film_min_std": (np.full(TRIGGERS, 0.03), "um"),
        "film_hamrock_dowson": (0.3 * minimum, "um"),
        "film_theory": (20.0 * minimum, "um"),
        "film_predicted_min": (sunken_film(), "um"),
        "film_predicted_mean": (sunken_film() + 2.0, "um"),
        "eccentricity": (1 - sunken_film() / 230, "1"),
        "attitude": (np.zeros(TRIGGERS), "degree"),
        "film_parameter": (minimum / (math.sqrt(2) * 0.2), "1"),
        "hersey_number": (hersey, "1"),
        "friction_coefficient": (friction, "1"),
        "friction_coefficient_std": (0.02 * friction, "1"),
        "friction_torque": (friction * LOAD * 0.03347, "N m"),
        "friction_torque_std": (0.02 * friction * LOAD * 0.03347, "N m"),
    }


MEAN_RADIUS = math.sqrt(33.36 * 33.59)  # mm
RANDOM_STD = np.array([0.003, 0.04, 0.001, 0.012])  # um and um/mm, of the numbers of a position
SHARED_STD = np.array([0.015, 0.03, 0.001, 0.001])


def pin_columns() -> dict[str, tuple]:
    """Position of the pin whose gap is `true_film`, its covariance and the form of circles.

    The film is thinnest 0.2 mm beside the middle of the image, which is the load line.
    """
    eccentricity = CLEARANCE - minimum_film()
    side = (PLACE - PITCH * (COLUMNS - 1) / 2) / MEAN_RADIUS * eccentricity
    tilt = -TILT / (PITCH * (ROWS - 1))
    both, numbers = ("trigger", "axis"), ("trigger", "parameter", "parameter_other")
    random = np.tile(np.diag(RANDOM_STD**2), (TRIGGERS, 1, 1))
    shared = np.tile(np.diag(SHARED_STD**2), (TRIGGERS, 1, 1))
    circles = eccentricity / MEAN_RADIUS**2
    place = {"clearance": CLEARANCE, "load_line": PITCH * (COLUMNS - 1) / 2}
    std = {"units": "um mm-2"}
    return {
        "axis": ("axis", np.array(["load", "side"])),
        "parameter": ("parameter", np.array(["load", "side", "tilt_load", "tilt_side"])),
        "pin_displacement": (both, np.column_stack([eccentricity, side]), {"units": "um"} | place),
        "pin_tilt": (both, np.tile([tilt, 0.0], (TRIGGERS, 1)), {"units": "um mm-1"} | place),
        "pin_position_cov": (numbers, random + shared),
        "pin_position_cov_random": (numbers, random),
        "pin_position_gradient": (
            ("trigger", "parameter", "calibration_parameter"),
            np.zeros((TRIGGERS, 4, 3)),
        ),
        "film_curvature": ("trigger", circles + 0.002, std),
        "film_curvature_expected": ("trigger", circles, std),
        "film_curvature_std": ("trigger", np.full(TRIGGERS, 0.001), std),
        "film_curvature_axial": ("trigger", np.zeros(TRIGGERS), std),
        "film_curvature_axial_std": ("trigger", np.full(TRIGGERS, 0.002), std),
    }


def noisy_maps() -> dict[str, tuple]:
    """Maps with noise, error bars and flags."""
    rng = np.random.default_rng(7)
    truth = true_film()
    grid = np.linspace(0.1, 20, 4000)
    noisy = np.log(true_ratio(truth)) + NOISE * rng.standard_normal(truth.shape)
    thickness = np.interp(noisy, np.log(true_ratio(grid)), grid)

    # as in a measurement, the error bar is that of the noisy value
    std = NOISE * np.interp(thickness, grid, np.gradient(grid, np.log(true_ratio(grid))))

    flags = np.zeros(truth.shape, np.uint16)
    flags[:, :, :3] = Flag.OUTSIDE_OVERLAP
    flags[1, 20:24, 30:34] = Flag.NO_FILM
    flags[2, 5, 40] = Flag.BAD_PIXEL | Flag.DIM
    flags[thickness > 16] = Flag.ABOVE_RANGE

    dims = ("trigger", "y", "x")
    images = {
        "thickness": thickness,
        "thickness_std": std,
        "thickness_std_shared": np.full(truth.shape, 0.02),
    }
    maps: dict[str, tuple] = {
        name: (dims, np.where(flags == 0, values, np.nan).astype(np.float32), {"units": "um"})
        for name, values in images.items()
    }
    return maps | {"flags": (dims, flags, FLAG_ATTRS)}


def frames_group() -> xr.Dataset:
    """One frame a trigger, without drift."""
    return xr.Dataset(
        {
            "trigger": ("frame", np.arange(TRIGGERS)),
            "drift_x": ("frame", np.zeros(TRIGGERS)),
            "drift_y": ("frame", np.zeros(TRIGGERS)),
            "pulse_energy": ("frame", np.ones(TRIGGERS)),
            "elapsed_cycles": ("frame", (CRANK - CRANK[0]) % 360 / 360),
            "film_predicted_min": ("frame", sunken_film()),
            **{f"file_camera{n}": ("frame", frame_names()) for n in (1, 2)},
        },
        {"frame": np.arange(TRIGGERS)},
    )


def registration_group() -> xr.Dataset:
    """Cameras without displacement, of equal sharpness; camera 2 does not see three columns."""
    zero = np.zeros((ROWS, COLUMNS), np.float32)
    nowhere = np.zeros((ROWS, COLUMNS), bool)
    overlap = ~nowhere
    overlap[:, :3] = False
    camera_map = CameraMap(zero, zero, zero + 0.01, overlap, nowhere, 0.97, MapKind.SURFACE)
    return camera_map.to_dataset().assign_attrs(
        blur_difference=[0.0, 0.0],
        blur_difference_std=[0.0, 0.0],
        camera_gain=[4.4, 4.4],
        camera_read_noise=[9.0, 9.0],
        camera_response_spread=[0.01, 0.01],
    )


@pytest.fixture(scope="package")
def film_path(tmp_path_factory):
    """The film in its run directory."""
    return make_film(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="package")
def film(film_path):
    """The film of `film_path`; never to be changed."""
    with open_film(film_path) as film:
        yield film


@pytest.fixture
def changed(film):
    """A copy of the film that a test may change."""
    return film.load().copy(deep=True)
