"""Sound rigs of all kinds, drawn at random: nothing of them is a mistake."""

from pathlib import Path
from typing import Any

import numpy as np

from damages.mistakes import SMALL, Table
from erlif.rig import RigSettings

MOTIONS: list[dict[str, Any]] = [
    {},
    {"encoder": "crank"},
    {"encoder": "coupler"},
    {"write_zero": False},
    {"reading": "wrapped"},
    {"reading": "ticks"},
    {"cycles": 2, "spacing": 1.92},
    {"cycles": 3, "spacing": 4.0},
    {"spacing": 2.5},
    {"log": "continuous"},
    {"pulses_per_cycle": 17.3, "cycles": 3},
    {"crank_speed": 20.0},
    {"crank_speed": 400.0},
    {"crank": 8.0},
    {"mechanism": "rotation", "pictures": 40},
    {"mechanism": "sinusoidal", "pictures": 40},
    {"mechanism": "static", "pictures": 20},
    {"mechanism": "slider-crank", "crank": 16.0, "pictures": 40},
    {"mechanism": "slider-crank", "crank": 16.0, "pictures": 40, "encoder": "crank"},
]
"""Mechanisms, encoders and logs."""

FILMS: list[dict[str, Any]] = [
    {},
    {"exponent": 0.4},
    {"film_reference": 4.0, "film_floor": 1.0},
    {"film_reference": 9.0},
    {"thin_line": -2.0, "tilt": 1.5},
    {"load_swing": 0.4},
    {"film": "reynolds", "tilt": 0.0},
    {"film": "reynolds", "tilt": 0.0, "sideways": "guided"},
    {"film": "reynolds", "tilt": 0.0, "elapsed": 4.0},
]
"""Films by formulas and by the motion."""

LIGHTS: list[dict[str, Any]] = [
    {},
    {"bubbles": 20},
    {"light": 0.2},
    {"background": 0.02},
    {"bleaching": (5e-4, 1e-3)},
    {"warming": 8.0},
    {"bump": (20.0, 3.0, -1.0)},
    {"gain_step": (22.0, 1.03)},
    {"blur_step": (25.0, 0.4)},
    {"lag": (0.0, 0.02)},
    {"dark_drift": (5.0, 0.0)},
    {"vibration": 1.0},
    {"pulse_jitter": 0.15},
    {"pulse_jitter": 0.0},
    {"speckle_new": 0.02},
    {"speckle_fixed": 0.0, "speckle_new": 0.15},
    {"speckle_fixed": 0.02, "speckle_new": 0.02, "bubbles": 6},
    {"wall": (0.1, 0.1)},
    {"wall": (0.3, 0.3), "wall_texture": (0.1, 1.0)},
    {"marks": 0.15},
    {"reference": 5.0},
    {"iris": 0.9},
]
"""Light and cameras, with what changes during a run of a real rig."""


def steps(values):
    """Load in three steps, as a test program has them."""
    return values * np.repeat([1.0, 2.0, 0.7], -(-values.size // 3))[: values.size]


def ramp(values):
    return values * np.linspace(0.4, 1.8, values.size)


def noisy(share):
    def change(values):
        return values * (1 + share * np.random.default_rng(5).normal(size=values.size))

    return change


LOGS: list[dict[str, Any]] = [
    {},
    {"time_s": lambda v: np.round(v, 3)},
    {"angle_deg": lambda v: v + 0.02 * np.random.default_rng(6).normal(size=v.size)},
    {"load_N": steps},
    {"load_N": ramp},
    {"load_N": noisy(0.03)},
    {"load_N": np.round},
    {"temperature_C": lambda v: v + np.linspace(0, 25, v.size)},
    {"laser_mJ": None},
    {"laser_mJ": noisy(0.02)},
    {"time_s": None},
    {"time_s": None, "laser_mJ": None, "temperature_C": None},
]
"""Columns of the log: changed as an instrument does, or absent (None)."""


def draw_sound(seed: int) -> tuple[RigSettings, dict[str, Any]]:
    """A sound rig, and what its instruments do to the log."""
    rng = np.random.default_rng([91, seed])
    motion = MOTIONS[seed % len(MOTIONS)]
    film = FILMS[int(rng.integers(len(FILMS)))]
    if (motion.get("mechanism") and "load_swing" in film) or (
        "film" in film and motion.get("mechanism")
    ):
        film = {}
    light = LIGHTS[int(rng.integers(len(LIGHTS)))]
    instruments = LOGS[int(rng.integers(len(LOGS)))]
    return RigSettings(**{**SMALL, **motion, **film, **light}), instruments


def use_instruments(run: Path, instruments: dict[str, Any]) -> None:
    """Write the log as these instruments give it; a log in time stays as it is."""
    path = run / "encoder.csv"
    if not path.exists() or not path.read_text(encoding="utf-8").startswith("frame,"):
        return
    table = Table(path)
    for name, change in instruments.items():
        if name not in table.columns:
            continue
        if change is None:
            del table.columns[name]
        elif not (name == "angle_deg" and float(table.numbers(name).max()) > 300):
            table.put(
                name, np.maximum(change(table.numbers(name)), 0 if name == "time_s" else -1e9)
            )
    table.write()
