"""Frames of the dry joint, reduced."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import FrameError
from erlif.correction import (
    DeclaredNoise,
    count_pixels,
    declare_darks,
    make_references,
    measure_camera,
    reduce_background,
    reduce_darks,
)


@pytest.fixture
def camera(simulated):
    return simulated(shape=(60, 64))


def test_mean_light_and_its_share_of_the_light_of_the_run(camera):
    rng = np.random.default_rng(4)
    darks = reduce_darks(camera.darks(16, rng))
    run = count_pixels(camera.expose(8000, rng), 4095)
    dry = [camera.expose(240, rng) for _ in range(16)]
    found = reduce_background(dry, darks=darks, histogram=run, camera="camera1")
    assert found.pages == 16
    noise = np.sqrt((240 + 2 * 81) / 16 / found.light.size)
    npt.assert_allclose(4.4 * found.light.mean(), 240, atol=5 * noise)
    assert found.share == pytest.approx(0.03, abs=0.002)


def test_no_pages_are_no_background():
    darks = declare_darks(64.0, (4, 4))
    assert reduce_background([], darks=darks, histogram=np.ones(9), camera="camera1") is None


def test_frames_of_a_film_are_refused_as_background(camera):
    rng = np.random.default_rng(5)
    run = count_pixels(camera.expose(8000, rng), 4095)
    with pytest.raises(FrameError, match=r"camera2 .*dry .*100%"):
        reduce_background(
            [camera.expose(8000, rng)],
            darks=declare_darks(64.0, camera.shape),
            histogram=run,
            camera="camera2",
        )


def test_references_hold_the_background_with_the_variance_of_its_mean(camera):
    """One camera alone was recorded dry: the other one has a background of zero."""
    rng = np.random.default_rng(6)
    histogram = count_pixels(camera.expose(8000, rng), 4095)
    measured = [
        measure_camera(
            darks=64.0,
            flats=(),
            histogram=histogram,
            shape=camera.shape,
            camera="camera1",
            background=dry,
        )
        for dry in ([camera.expose(400, rng) for _ in range(5)], ())
    ]
    found = make_references(measured, declared=[DeclaredNoise(4.4, 9.0)] * 2)
    light = found.references.background.values
    npt.assert_allclose(light[1], 0)
    variance = found.references.background_var.values
    npt.assert_allclose(variance[0].mean(), (400 / 4.4**2 + camera.temporal_var) / 5, rtol=0.03)
    npt.assert_allclose(light[0].var(), variance[0].mean(), rtol=4 * np.sqrt(2 / 3840))
    assert any("5 frame(s) of the dry joint" in str(note) for note in found.notes)
