"""A film or a calibration in a few lines that a person reads."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.flags import Flag


def summarise(film: xr.Dataset) -> str:
    """Say what a film shows: range, trend, theory, share of valid pixels, and what was flagged and why.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it.
    """
    name = str(film.attrs["title"]).removeprefix("oil-film thickness, ")
    frames = int(film.frames_used.sum())
    lines = [
        f"{name}: {film.sizes['trigger']} triggers from {frames} frame pairs of {film.sizes['x']} x {film.sizes['y']} pixels",
        _film_line(film, "film_min", "least film"),
        _film_line(film, "film_mean", "mean film"),
        *_flag_lines(film),
        *_trend_lines(film),
    ]
    notes = [note for note in str(film.attrs.get("notes", "")).split("\n") if note]
    lines += [f"  {'note' if n == 0 else '':14s}{note}" for n, note in enumerate(notes)]
    return "\n".join(lines)


def describe_calibration(calibration: Calibration) -> str:
    """Parameters of a calibration with their uncertainties, its range, and what it has to say of itself."""
    std = calibration.standard_deviations
    low, high = calibration.thickness_range
    names = (
        "K, ratio of a vanishing film",
        "p, attenuation camera 1 [1/um]",
        "q, attenuation camera 2 [1/um]",
    )
    lines = [
        f"{calibration.fixture}: ratio camera 2 / camera 1 against thickness, {calibration.curve.sizes['bin']} points"
    ]
    lines += [
        f"  {name:32s}{value:.5f} ± {error:.5f}"
        for name, value, error in zip(names, calibration.parameters, std, strict=True)
    ]
    lines.append(f"  {'answers from':32s}{low:.2f} to {high:.2f} um")
    middle = np.array([low + 0.1 * (high - low), (low + high) / 2])
    errors = calibration.thickness_std(middle)
    lines.append(
        f"  {'leaves in a thickness':32s}"
        + ", ".join(
            f"{100 * error / t:.2f} % at {t:.1f} um"
            for t, error in zip(middle, errors, strict=True)
        )
    )
    lines.append(f"  {'reduced chi-square':32s}{calibration.reduced_chi_square:.2f}")
    if calibration.departure is not None:
        film = np.linspace(low, high, 501)
        share = 100 * np.expm1(calibration.departure.predict(film))
        lines.append(
            f"  {'departs from the model by':32s}{share.min():+.2f} to {share.max():+.2f} % of the ratio, followed by a spline"
        )
    lines += [f"  note: {note}" for note in calibration.notes]
    return "\n".join(lines)


def _film_line(film: xr.Dataset, variable: str, label: str) -> str:
    values, std = film[variable].values, film[f"{variable}_std"].values
    if not np.isfinite(values).any():
        return f"  {label:14s}none: no trigger has enough valid pixels in the region of interest"
    thin, thick = int(np.nanargmin(values)), int(np.nanargmax(values))
    return (
        f"  {label:14s}{values[thin]:.2f} ± {std[thin]:.2f} um (trigger {thin}) to {values[thick]:.2f} ± {std[thick]:.2f} um "
        f"(trigger {thick})"
    )


def _flag_lines(film: xr.Dataset) -> list[str]:
    counts = dict.fromkeys(Flag, 0)
    answered = total = 0
    for trigger in range(film.sizes["trigger"]):
        flags = film.flags.isel(trigger=trigger).values
        answered += int((flags == 0).sum())
        total += flags.size
        for flag in Flag:
            counts[flag] += int(((flags & flag) > 0).sum())
    left_out = ", ".join(
        f"{str(flag.name).lower()} {count / total:.2%}" for flag, count in counts.items() if count
    )
    return [f"  {'pixels':14s}{answered / total:.1%} answered; flagged: {left_out or 'none'}"]


def _trend_lines(film: xr.Dataset) -> list[str]:
    lines = []
    exponent = film.speed_exponent
    if np.isfinite(float(exponent)):
        lines.append(
            f"  {'trend':14s}least film ~ (|speed|/load)^n, n = {float(exponent):.3f} ± {float(film.speed_exponent_std):.3f} "
            f"({exponent.attrs['triggers_used']} triggers above a tenth of the top speed); mean film: n = "
            f"{float(film.speed_exponent_mean):.3f} ± {float(film.speed_exponent_mean_std):.3f}"
        )
    else:
        lines.append(f"  {'trend':14s}not fitted: fewer than five triggers can be used")
    theory = film.film_theory
    top = int(np.argmax(np.abs(film.rocker_speed.values)))
    lines.append(
        f"  {'theory':14s}{theory.attrs['regime']}: {float(theory[top]):.3g} um at top speed ({float(film.sliding_speed[top]):.3f} m/s, "
        f"{float(film['load'][top]):.0f} N); the Dowson-Higginson line-contact formula (2.65) gives {float(film.film_hamrock_dowson[top]):.3g} um"
    )
    lines.append(f"  {'':14s}{theory.attrs['reason']}")
    return lines
