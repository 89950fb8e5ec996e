"""Runs whose camera 2 grows brighter and is bumped, or has another dark, from frames to film."""

from dataclasses import replace

import numpy as np
import pytest
from scenes.rig import small_rig

from conftest import processed, simulated

pytestmark = pytest.mark.usefixtures("without_theory")

RIG = small_rig(spacing=1.2, gain_step=(18, 1.05), bump=(25, 6.0, 0.0), blur_step=(30, 0.8))
"""Forty frames of one cycle."""

DARK = replace(
    RIG,
    spacing=2.4,
    gain_step=(0, 1.0),
    bump=(0, 0.0, 0.0),
    blur_step=(0, 0.0),
    dark_drift=(0.0, 40.0),
    iris=0.9,
)
"""A dark of camera 2 that is 40 DN above its dark frames, and corners without light."""


lab = simulated(RIG, seed=41)
# the settings state an exact ratio: nothing but the run shows the step
film = processed("lab", "exact", ("[systematics]", '[systematics]\nratio = "0 %"'))


def notes_on(film, subject):
    return [line for line in film.attrs["notes"].splitlines() if f"{subject}: from" in line]


def test_step_and_bump_are_named_with_their_frames(film):
    (step,) = notes_on(film, "course")
    assert any(f"from frame {frame} on" in step for frame in (17, 18, 19))
    (bump,) = notes_on(film, "registration")
    assert "from frame 25 on" in bump
    assert "along x" in bump
    (focus,) = [line for line in film.attrs["notes"].splitlines() if "sharpness" in line]
    assert "camera2: from frame" in focus
    assert any(f"frame {frame} on" in focus for frame in (29, 30, 31))


def test_error_of_the_mean_film_holds_the_step(lab, film):
    """Of the films after the step, which read a third too thick, most are within two std."""
    error = (film.thickness - lab.truth.film.values).where(film.thickness > 0)
    mean, std = error.mean(("y", "x")).values, film.film_mean_std.values
    after = np.arange(mean.size) >= 20
    known = after & np.isfinite(std) & np.isfinite(mean)

    pull = np.abs(mean)[known] / std[known]
    assert np.median(mean[known]) > 0.5  # um
    assert np.mean(pull < 2) > 0.9
    assert "scale of the ratio" in film.attrs["largest_error"]


dark_lab = simulated(DARK, seed=42)
dark_film = processed("dark_lab", "exact", ("[systematics]", '[systematics]\nbackground = "0 %"'))


def test_wrong_dark_is_named_before_everything_else_that_it_causes(dark_film):
    warnings = [line for line in dark_film.attrs["notes"].splitlines() if "warning" in line]
    assert "by the dark: pixels that no light reaches read +4" in warnings[0]
    level = float(warnings[0].split("read ")[1].split(" ±")[0])
    assert level == pytest.approx(40, abs=1)


def test_error_of_the_mean_film_holds_the_wrong_dark(dark_lab, dark_film):
    error = (dark_film.thickness - dark_lab.truth.film.values).where(dark_film.thickness > 0)
    mean, std = error.mean(("y", "x")).values, dark_film.film_mean_std.values
    known = np.isfinite(std) & np.isfinite(mean)
    assert np.median(mean[known]) > 0.3  # um
    assert np.mean(np.abs(mean[known]) < 2 * std[known]) > 0.9
    assert "light that is not film" in dark_film.attrs["largest_error"]
