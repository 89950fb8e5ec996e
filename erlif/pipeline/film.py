"""The film as it is stored: what log, kinematics, statistics and theory say of each trigger, and the record of its making."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from scipy.linalg import block_diag

from erlif.calibration import Calibration
from erlif.calibration.storage import record_calibration
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.core.flags import FLAG_ATTRS
from erlif.core.products import References
from erlif.core.version import __version__
from erlif.files import MapVariable, PartialFilm, describe_hashes
from erlif.ingest import Recording, skipped_notes
from erlif.pipeline.chain import FrameRecord
from erlif.ratio import BlurDifference
from erlif.registration import CameraMap
from erlif.registration.camera_map import describe_map
from erlif.settings import RunSettings, to_toml
from erlif.trend import fit_exponent, predict_film, region_mask

_BY_FRAME = ("pulse_energy", "drift", "peaks")  # what is kept of a trigger for each of its frames


MAPS = [
    MapVariable(
        "thickness",
        "float32",
        {
            "units": "um",
            "long_name": "oil-film thickness",
            "ancillary_variables": "thickness_std thickness_std_shared flags",
        },
        bits=11,
    ),
    MapVariable(
        "thickness_std",
        "float32",
        {"units": "um", "long_name": "standard deviation of thickness, random part of each pixel"},
        bits=6,
    ),
    MapVariable(
        "thickness_std_shared",
        "float32",
        {"units": "um", "long_name": "standard deviation of thickness, what all pixels share"},
        bits=6,
    ),
    MapVariable("flags", "uint8", FLAG_ATTRS),
]


def group_frames(located: xr.Dataset, recording: Recording) -> list[list[int]]:
    """Numbers of the usable frames of each trigger; `located` as `locate_frames` gives it."""
    triggers = int(located.trigger.max()) + 1
    frames: list[list[int]] = [[] for _ in range(triggers)]
    for k in recording.frames:
        frames[int(located.trigger[k])].append(k)
    return frames


def pixel_positions(recording: Recording) -> tuple[Array, Array]:
    """Columns and rows of the image in the object plane. [mm]"""
    pitch = recording.settings.optics.pixel_pitch * 1e3
    height, width = recording.shape
    return np.arange(width, dtype=float) * pitch, np.arange(height, dtype=float) * pitch


def assemble_film(
    recording: Recording,
    triggers: xr.Dataset,
    partial: PartialFilm,
    calibration: Calibration,
    settings: RunSettings,
    hashes: dict[str, str],
    notes: list[str],
) -> xr.Dataset:
    """Everything of the film but its maps."""
    numbers = [partial.numbers(trigger) for trigger in range(triggers.sizes["trigger"])]
    stacked = {
        name: np.stack([record[name] for record in numbers])
        for name in numbers[0]
        if name not in _BY_FRAME
    }
    film = triggers.copy()
    film["frames_used"] = (
        "trigger",
        stacked["frames_used"],
        {"units": "1", "long_name": "frames of this trigger"},
    )
    for name, meaning in (
        ("mean", "mean film over the region of interest"),
        ("min", "least film of a smooth gap"),
    ):
        source = {"mean": "mean", "min": "minimum"}[name]
        attrs = {"units": "um", "long_name": meaning, "ancillary_variables": f"film_{name}_std"}
        film[f"film_{name}"] = ("trigger", stacked[source], attrs)
        film[f"film_{name}_std"] = (
            "trigger",
            stacked[f"{source}_std"],
            {"units": "um", "long_name": "its standard deviation, random and shared"},
        )
    film.film_mean.attrs["share_beyond_range"] = stacked["censored"]
    film.film_mean.attrs["comment"] = (
        "over the pixels that were answered; share_beyond_range tells by trigger how much of the region was too thin or too thick"
    )
    film = film.merge(predict_film(film, settings), combine_attrs="drop_conflicts")
    stacked["mean_surface_std"] = np.zeros(
        film.sizes["trigger"]
    )  # the mean is that of the film as it is, marks included
    shared = block_diag(calibration.full_covariance, np.eye(1))
    for suffix, source in (("", "minimum"), ("_mean", "mean")):
        exponent = fit_exponent(
            stacked[source],
            stacked[f"{source}_random_std"],
            speed=film.rocker_speed.values,
            load=film["load"].values,
            gradient=np.column_stack(
                [stacked[f"{source}_gradient"], stacked[f"{source}_surface_std"]]
            ),
            covariance=shared,
        )
        what = "film_min" if suffix == "" else "film_mean"
        film[f"speed_exponent{suffix}"] = (
            (),
            exponent.value,
            {
                "units": "1",
                "long_name": f"power of |rocker_speed|/load that {what} follows",
                "log_scale": exponent.log_scale,
                "triggers_used": exponent.triggers,
            },
        )
        film[f"speed_exponent{suffix}_std"] = (
            (),
            exponent.std,
            {"units": "1", "long_name": "its standard deviation"},
        )
    x, y = pixel_positions(recording)
    film = film.assign_coords(
        x=("x", x, {"units": "mm", "long_name": f"position along x, {settings.optics.x_axis}"}),
        y=("y", y, {"units": "mm", "long_name": "position along y, downwards"}),
    )
    return film.assign_attrs(
        Conventions="CF-1.11",
        title=f"oil-film thickness, {settings.name}",
        history=f"erlif {__version__}: process {settings.name}",
        erlif_version=__version__,
        settings=to_toml(settings),
        input_hashes=describe_hashes(hashes),
        calibration=record_calibration(calibration),
        **_describe_smoothing(settings.thickness.smoothing),
        notes="\n".join(
            [
                *notes,
                *_censoring_notes(stacked["censored"]),
                *(f"calibration: {note}" for note in calibration.notes),
                *skipped_notes(recording),
            ]
        ),
    )


def _censoring_notes(censored: Array) -> list[str]:
    worst = int(np.argmax(censored))
    if censored[worst] < 0.01:
        return []
    return [
        f"up to {censored[worst]:.0%} of the region of interest (trigger {worst}) is too thin or too thick to be measured pixel by pixel in "
        "this light: film_mean is that of the rest; film_min, a fit to the ratio, is not touched"
    ]


def describe_triggers(
    recording: Recording, located: xr.Dataset, frames_of: list[list[int]]
) -> xr.Dataset:
    """Means of what log and kinematics say of the frames of each trigger, checked to be enough for a film.

    Raises
    ------
    ConfigError
        If neither the log nor the settings tell the load, Vogel's law has no temperature, or the region of interest lies outside
        the image.
    """
    settings, log = recording.settings, recording.log
    assert isinstance(settings, RunSettings)
    assert log is not None
    columns = {name: located[name] for name in ("encoder_angle", "rocker_speed", "sliding_speed")}
    columns |= {str(name): log[name] for name in log if name not in ("number", "angle", "time")}
    if "load" not in columns:
        if settings.joint.load is None:
            raise ConfigError(
                'Expected the load: the encoder log has no load_N and [joint] no load. Add load = "50 lbf" to [joint] in run.toml.'
            )
        columns["load"] = xr.full_like(located.encoder_angle, settings.joint.load).assign_attrs(
            units="N", long_name="load on the joint"
        )
    film = xr.Dataset(coords={"trigger": np.arange(len(frames_of))})
    every = [frames or _all_frames(located, trigger) for trigger, frames in enumerate(frames_of)]
    for name, column in columns.items():
        if column.dtype.kind in "fiu":
            means = [float(column.values[frames].mean()) for frames in every]
            film[name] = ("trigger", np.array(means), column.attrs)
        else:
            film[name] = (
                "trigger",
                np.array([str(column.values[frames[0]]) for frames in every]),
                column.attrs,
            )
    film["stroke"] = (
        "trigger",
        np.array([located.stroke.values[f[0]] for f in every]),
        located.stroke.attrs,
    )
    angles = [np.exp(1j * np.radians(located.crank_angle.values[f])).mean() for f in every]
    film["crank_angle"] = ("trigger", np.degrees(np.angle(angles)) % 360, located.crank_angle.attrs)
    predict_film(film, settings)
    region_mask(settings, *pixel_positions(recording))
    return film


def _all_frames(located: xr.Dataset, trigger: int) -> list[int]:
    return [int(k) for k in np.nonzero(located.trigger.values == trigger)[0]]


def describe_frames(
    recording: Recording,
    located: xr.Dataset,
    record: FrameRecord,
    partial: PartialFilm,
    frames_of: list[list[int]],
) -> xr.Dataset:
    """The frames group of the film: what belongs to single frames."""
    count = located.sizes["frame"]
    drift = np.full((count, 2), np.nan)
    energy = np.full(count, np.nan)
    mean = record.mean_drift()
    for trigger, frames in enumerate(frames_of):
        values = partial.numbers(trigger)["pulse_energy"]
        for k, value in zip(frames, values, strict=True):
            drift[k] = record.drift[k] - mean
            energy[k] = value
    log = recording.log
    assert log is not None
    names = [[page.name for page in pages] for pages in recording.pages]
    group = xr.Dataset(
        {
            "trigger": located.trigger,
            "cycle": located.cycle,
            "drift_x": (
                "frame",
                drift[:, 0],
                {"units": "px", "long_name": "drift of camera 2 along x"},
            ),
            "drift_y": (
                "frame",
                drift[:, 1],
                {"units": "px", "long_name": "drift of camera 2 along y"},
            ),
            "pulse_energy": (
                "frame",
                energy / np.nanmean(energy) if np.isfinite(energy).any() else energy,
                {"units": "1", "long_name": "pulse energy relative to the mean"},
            ),
            "file_camera1": ("frame", np.array(names[0])),
            "file_camera2": ("frame", np.array(names[1])),
        }
    )
    time = log["time"] if "time" in log else xr.full_like(located.encoder_angle, np.nan)
    group["time"] = ("frame", time.values, {"units": "s", "long_name": "time of the trigger"})
    if recording.skipped:
        group.attrs["skipped_frames"] = "\n".join(skipped_notes(recording))
    return group.reset_coords(drop=True)


def describe_registration(camera_map: CameraMap, blur: BlurDifference) -> xr.Dataset:
    """The registration group of the film."""
    return describe_map(camera_map).assign_attrs(
        blur_difference=[blur.x, blur.y],
        blur_difference_std=[blur.std_x, blur.std_y],
        blur_difference_comment="half the blur variance of camera 2 less that of camera 1, along x and y [px2]",
    )


def _describe_smoothing(resolution: int | None) -> dict[str, Any]:
    if resolution is None:
        return {}
    comment = (
        "full width at half maximum of the window [px] in which the ratio behind the maps was smoothed, steps kept; the noise of "
        "pixels closer than that goes together; film_min, film_mean and their trend come from the ratio as it was measured"
    )
    return {"smoothing": resolution, "smoothing_comment": comment}


def reference_notes(references: References) -> list[str]:
    """What was measured of the cameras, and what disagrees with the settings."""
    return [note for note in str(references.attrs.get("notes", "")).split("\n") if note]
