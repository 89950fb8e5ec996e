"""The camera map of a recording: found on its frames, or taken from a calibration."""

from dataclasses import replace

import numpy as np
import pytest

from erlif.core.errors import CalibrationError, RegistrationError
from erlif.core.progress import silent
from erlif.io.settings import RegistrationOptions
from erlif.pipeline.recording.register import FixtureMap, register_cameras

REUSE = RegistrationOptions(reuse=True)


def test_stored_map_for_another_frame_size_is_refused(prepared):
    chain = prepared.chain
    cut = replace(chain.camera_map, displacement_x=chain.camera_map.displacement_x[:-2])
    with pytest.raises(RegistrationError, match=r"\(96, 128\).*\(94, 128\)"):
        register_cameras(chain.correct, REUSE, stored=cut, progress=silent)


def test_stored_map_of_another_magnification_is_refused(prepared):
    """A stretch of 5 % is no drift: it leaves 3 px at the edge of 128 columns."""
    chain = prepared.chain
    stretch = 0.05 * (np.arange(128, dtype=np.float32) - 63.5)
    other = replace(chain.camera_map, displacement_x=chain.camera_map.displacement_x + stretch)
    with pytest.raises(RegistrationError, match="stored"):
        register_cameras(chain.correct, REUSE, stored=other, progress=silent)


def test_the_map_of_the_fixture_is_kept_only_where_it_is_used(run, calibration):
    settings = run.settings
    known = FixtureMap.of(calibration, settings)
    assert known.stored is None
    assert known.nodes is not None

    reused = settings.model_copy(
        update={"registration": settings.registration.model_copy(update={"reuse": True})}
    )
    assert FixtureMap.of(calibration, reused).stored is not None
    without = replace(calibration, camera_map=None)
    assert FixtureMap.of(without, settings) == FixtureMap(None, None)
    with pytest.raises(CalibrationError, match="Calibrate again, or set reuse = false"):
        FixtureMap.of(without, reused)
