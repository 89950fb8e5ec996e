"""Checks of the calibration of a run: existence, match with the run, and age."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from erlif.calibration import Calibration, check_bands, note_pitch, open_calibration
from erlif.core.arrays import Array
from erlif.core.errors import ErlifError
from erlif.core.notes import Note, remark, warn
from erlif.io.ingest import Run, hash_inputs, open_fixture
from erlif.pipeline.fixture import before_wall_of
from erlif.pipeline.recording.sample import divide_sample
from erlif.pipeline.recording.swap import judge_ratios
from erlif.registration import MapNodes
from erlif.review.check.cameras import RatioSurvey

_LARGEST = 2**31  # size of a fixture up to which its files are hashed [byte]

# Share of the ratios within the calibrated range below which the calibration does not fit.
_COVERED = 0.5

_MARGIN = 0.1  # widening of the range on both sides for noise, of the range of the logarithm


def note_calibration(run: Run, cameras: RatioSurvey, *, allow_outside: bool) -> Iterator[Note]:
    """Check the calibration against the bands, the ratios and the fixture.

    Raises
    ------
    CalibrationError
        If the calibration cannot be used, or the cameras are exchanged against it.
    """
    if not run.settings.calibrations:
        yield warn("calibration", "run.toml names none; process will need --calibration")
    for name in run.settings.calibrations:
        yield from _note_one(run, cameras, name, allow_outside=allow_outside)


def _note_one(run: Run, cameras: RatioSurvey, name: str, *, allow_outside: bool) -> Iterator[Note]:
    """Check one calibration that the settings name."""
    settings, path = run.settings, run.directory / name
    has_fixture = (path.parent / "fixture.toml").is_file()
    if not path.exists():
        yield (
            remark("calibration", f"{name} is not made yet; process will make it from the fixture")
            if has_fixture
            else warn("calibration", f"{name} does not exist; process will need --calibration")
        )
        return

    calibration = before_wall_of(run, open_calibration(path))
    check_bands(calibration, (settings.camera1.band, settings.camera2.band))
    yield from note_pitch(calibration.pixel_pitch, 1e3 * settings.optics.pixel_pitch)
    own_map = calibration.camera_map
    stored = None if own_map is None else MapNodes.of(own_map)
    ratios = divide_sample(cameras.chain, cameras.sample)
    yield from judge_ratios(cameras.chain, calibration, ratios, stored=stored).notes
    low, high = calibration.thickness_range
    yield remark(
        "calibration", f"{calibration.fixture!r}, calibrated range {low:.2f} to {high:.2f} um"
    )
    yield from note_range(calibration, cameras.log_ratios)
    if has_fixture:
        yield from note_age(calibration, path, allow_outside=allow_outside)


def note_range(calibration: Calibration, log_ratios: Array) -> Iterator[Note]:
    """Ratios of the run against those of the calibrated range."""
    if not log_ratios.size:
        yield warn("ratio", "no pixel has a ratio. Check exposure and registration of the cameras")
        return
    low, high = (float(one) for one in calibration.predict_log(calibration.thickness_range))
    first, last = np.exp(np.quantile(log_ratios, [0.05, 0.95]))

    # noise alone takes half of the pixels at a limit beyond it, so that the range is widened
    margin = _MARGIN * (high - low)
    cure = (
        "The films are thinner or thicker than the fixture's, or dyes, filters or light have "
        "changed since the calibration. Calibrate again with a fixture of these films"
    )
    covered = (log_ratios > low - margin) & (log_ratios < high + margin)
    yield remark(
        "ratio",
        f"{first:.3f} to {last:.3f} in 90 % of the pixels, calibrated from {np.exp(low):.3f} to "
        f"{np.exp(high):.3f}; {(log_ratios < low).mean():.0%} lie below and "
        f"{(log_ratios > high).mean():.0%} above, where a map has flags in place of films",
        cure if covered.mean() < _COVERED else "",
    )


def note_age(calibration: Calibration, path: Path, *, allow_outside: bool) -> Iterator[Note]:
    """Files of the fixture that have changed since the calibration was made."""
    recorded = calibration.input_hashes
    if not recorded:
        return
    try:
        fixture = open_fixture(path.parent, skip_bad_frames=True, allow_outside=allow_outside)
    except ErlifError as error:
        yield warn("calibration", f"the fixture beside it cannot be read: {error}")
        return

    files = {page.path for pages in fixture.pairs.pages for page in pages}
    if sum(file.stat().st_size for file in files if file.exists()) > _LARGEST:
        yield remark(
            "calibration", "the files of the fixture are not compared with it, they exceed 2 GB"
        )
        return
    now = hash_inputs(fixture)
    changed = sorted(name for name in recorded if now.get(name) != recorded[name])
    if changed:
        yield warn(
            "calibration",
            f"it was made from other files than the fixture has now: {', '.join(changed)} "
            f"changed. Calibrate again with: erlif calibrate {path.parent} --overwrite",
        )
