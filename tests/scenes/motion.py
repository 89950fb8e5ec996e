"""The example film as another tribometer would have made it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from erlif.io.files import settings_of
from erlif.io.settings import RunSettings, to_toml
from erlif.show.plots import example_film

DISC = {"kind": "rotation", "radius": "20 mm", "speed": "60 rpm"}
SLIDER = {"kind": "sinusoidal", "stroke": "10 mm", "frequency": "5 Hz"}

ANGLE = np.radians([20.0, 80.0, 140.0, 200.0, 260.0, 320.0])
"""Angle of the drive at the six triggers. [rad]"""

PREDICTED = ("film_predicted_min", "film_predicted_mean", "eccentricity", "attitude")
THEORY = ("film_theory", "film_hamrock_dowson", "film_parameter", *PREDICTED)
LINKAGE = ("encoder_angle", "stroke", "crank_angle", "rocker_speed", "sliding_speed")
TREND = [f"speed_exponent{part}" for part in ("", "_std", "_mean", "_mean_std")]


def film_of(
    mechanism: Mapping[str, str] | None,
    *,
    without: Sequence[str] = (),
    leave_out: Sequence[str] = (),
    **columns: Any,
) -> xr.Dataset:
    """The example film with another mechanism, without some variables and tables."""
    film = example_film()
    raw = settings_of(film).model_dump(exclude_none=True) | {"mechanism": mechanism}
    raw = {key: raw[key] for key in raw if key not in leave_out and raw[key] is not None}
    film = film.assign_attrs(settings=to_toml(RunSettings.model_validate(_as_text(raw))))
    film = film.drop_vars(without)
    return film.assign({name: ("trigger", values) for name, values in columns.items()})


def slider_film() -> xr.Dataset:
    """A slider of 10 mm at 5 Hz, without a joint."""
    return film_of(
        SLIDER,
        without=("rocker_speed", *THEORY),
        leave_out=("joint", "oil"),
        crank_angle=np.degrees(ANGLE),
        position=5 * np.sin(ANGLE),
        stroke=np.where(np.cos(ANGLE) >= 0, 1, -1),
        sliding_speed=np.pi * 5 * 0.01 * np.abs(np.cos(ANGLE)),
    )


def static_film() -> xr.Dataset:
    """A film at rest, without a log."""
    tables = ("encoder", "joint", "oil")
    return film_of(None, without=(*LINKAGE, *THEORY, *TREND, "joint_load"), leave_out=tables)


def _as_text(table: Mapping[str, Any]) -> dict[str, Any]:
    """Quantities as the user wrote them."""
    return {
        key: _as_text(value) if isinstance(value, dict) else getattr(value, "text", value)
        for key, value in table.items()
    }
