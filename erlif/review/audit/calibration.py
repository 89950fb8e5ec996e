"""Whether the calibration of a run exists, fits the run, and is as new as its fixture."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from erlif.calibration import Calibration, check_bands, open_calibration
from erlif.core.arrays import Array
from erlif.core.errors import ErlifError
from erlif.core.notes import Level, Note, remark
from erlif.io.ingest import Run, hash_inputs, open_fixture
from erlif.pipeline.recording.swap import refuse_swapped_cameras
from erlif.registration import MapNodes
from erlif.review.audit.cameras import CameraSurvey

_LARGEST = 2**31
"""Size of a fixture up to which its files are hashed. [byte]"""

_COVERED = 0.5
"""Share of the ratios within the calibrated range below which the calibration does not fit."""

_MARGIN = 0.1
"""Widening of the range on both sides for noise, of the range of the logarithm."""


def note_calibration(run: Run, cameras: CameraSurvey, *, allow_outside: bool) -> Iterator[Note]:
    """Whether the calibration fits the bands, the ratios and the fixture.

    Raises
    ------
    CalibrationError
        If the calibration cannot be used, or the cameras are exchanged against it.
    """
    settings = run.settings
    if settings.calibration is None:
        text = "run.toml names none; process will need --calibration"
        yield Note(Level.WARNING, "calibration", text)
        return

    path = run.directory / settings.calibration
    has_fixture = (path.parent / "fixture.toml").is_file()
    if not path.exists():
        level, text = (
            (Level.NOTE, "is not made yet; process will make it from the fixture")
            if has_fixture
            else (Level.WARNING, "does not exist; process will need --calibration")
        )
        yield Note(level, "calibration", f"{settings.calibration} {text}")
        return

    calibration = open_calibration(path)
    check_bands(calibration, (settings.camera1.band, settings.camera2.band))
    own_map = calibration.camera_map
    refuse_swapped_cameras(
        cameras.chain,
        calibration,
        cameras.sample,
        stored=None if own_map is None else MapNodes.of(own_map),
    )
    low, high = calibration.thickness_range
    text = f"{calibration.fixture!r}, calibrated range {low:.2f} to {high:.2f} um"
    yield remark("calibration", text)
    yield from note_range(calibration, cameras.log_ratios)
    if has_fixture:
        yield from note_age(calibration, path, allow_outside=allow_outside)


def note_range(calibration: Calibration, log_ratios: Array) -> Iterator[Note]:
    """Ratios of the run against those of the calibrated range."""
    if not log_ratios.size:
        cure = "Check exposure and registration of the cameras"
        yield remark("ratio", "no pixel has a ratio", cure)
        return
    low, high = (float(one) for one in calibration.predict_log(calibration.thickness_range))
    first, last = np.exp(np.quantile(log_ratios, [0.05, 0.95]))
    text = (
        f"{first:.3f} to {last:.3f} in 90 % of the pixels, calibrated from {np.exp(low):.3f} to "
        f"{np.exp(high):.3f}; {(log_ratios < low).mean():.0%} lie below and "
        f"{(log_ratios > high).mean():.0%} above, where a map has flags in place of films"
    )

    # noise alone takes half of the pixels at a limit beyond it, so that the range is widened
    margin = _MARGIN * (high - low)
    covered = (log_ratios > low - margin) & (log_ratios < high + margin)
    cure = (
        "The films are thinner or thicker than the fixture's, or dyes, filters or light have "
        "changed since the calibration. Calibrate again with a fixture of these films"
    )
    yield remark("ratio", text, cure if covered.mean() < _COVERED else "")


def note_age(calibration: Calibration, path: Path, *, allow_outside: bool) -> Iterator[Note]:
    """Files of the fixture that have changed since the calibration was made."""
    recorded = calibration.input_hashes
    if not recorded:
        return
    try:
        fixture = open_fixture(path.parent, skip_bad_frames=True, allow_outside=allow_outside)
    except ErlifError as error:
        text = f"the fixture beside it cannot be read: {error}"
        yield Note(Level.WARNING, "calibration", text)
        return

    files = {page.path for pages in fixture.pairs.pages for page in pages}
    if sum(file.stat().st_size for file in files if file.exists()) > _LARGEST:
        text = "the files of the fixture are not compared with it, they exceed 2 GB"
        yield remark("calibration", text)
        return
    now = hash_inputs(fixture)
    changed = sorted(name for name in recorded if now.get(name) != recorded[name])
    if changed:
        files_now = f"{', '.join(changed)} changed"
        yield remark(
            "calibration",
            f"it was made from other files than the fixture has now: {files_now}",
            f"Calibrate again with: erlif calibrate {path.parent} --overwrite",
        )
