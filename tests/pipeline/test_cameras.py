"""Cameras of a fixture on the disk: darks, flats and a few frames, against a known camera."""

import numpy as np
import numpy.testing as npt
import pytest
import tifffile

from erlif.core.notes import join_notes
from erlif.ingest import open_fixture
from erlif.pipeline.cameras import (
    characterise_cameras,
    count_frames,
    declared_noise,
    measure_cameras,
)

SHAPE, GAINS, OFFSET = (72, 80), (4.4, 2.2), 64

CAMERA = """
[camera{n}]
files = "camera{n}/*.tif"
band = "{band} nm"
dark = "dark{n}.tif"
flat = "flat{n}.tif"
"""


def expose(electrons, gain, rng):
    counts = (rng.poisson(electrons, SHAPE) + rng.normal(0, 9, SHAPE)) / gain + OFFSET
    return np.clip(np.rint(counts), 0, 4095).astype(np.uint16)


def write(path, pages):
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(page, contiguous=False)


@pytest.fixture
def directory(tmp_path):
    rng = np.random.default_rng(1)
    for n, gain in enumerate(GAINS, 1):
        write(tmp_path / f"dark{n}.tif", [expose(0, gain, rng) for _ in range(8)])
        levels = (900 * gain, 2700 * gain)
        flats = [expose(level, gain, rng) for level in levels for _ in range(4)]
        write(tmp_path / f"flat{n}.tif", flats)
        (tmp_path / f"camera{n}").mkdir()
        for k in range(3):
            write(tmp_path / f"camera{n}" / f"{k}.tif", [expose(1000 * gain, gain, rng)])
    text = '[fixture]\nname = "test"\nprofile = "profile.csv"\n[optics]\npixel_pitch = "60 um"\n'
    text += "".join(CAMERA.format(n=n, band=band) for n, band in ((1, 580), (2, 610)))
    (tmp_path / "fixture.toml").write_text(text)
    return tmp_path


def edit(directory, *changes):
    path = directory / "fixture.toml"
    text = path.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)


def test_each_camera_is_measured_from_its_own_files(directory):
    references = characterise_cameras(open_fixture(directory)).references
    assert np.all(abs(references.gain - GAINS) < 4 * references.gain_std)
    assert np.all(abs(references.read_noise - 9) < 4 * references.read_noise_std)
    npt.assert_allclose(references.dark_signal, OFFSET, atol=0.1)


def test_a_level_in_the_settings_stands_for_the_darks(directory):
    edit(directory, ('dark = "dark2.tif"', 'offset = "70 DN"'))
    one, two = measure_cameras(open_fixture(directory))
    assert (one.darks.pages, two.darks.pages) == (8, 0)
    assert two.darks.level == 70


def test_a_camera_without_a_flat_is_reported(directory):
    edit(directory, ('flat = "flat1.tif"\n', ""))
    one, two = measure_cameras(open_fixture(directory))
    assert not one.has_flat
    assert two.has_flat
    assert "camera1: no flat" in join_notes(characterise_cameras(open_fixture(directory)).notes)


def test_declared_values_come_from_the_table_of_each_camera(directory):
    given = 'band = "610 nm"\ngain = "2.3 electron/DN"\nread_noise = "8 electron"'
    edit(directory, ('band = "610 nm"', given))
    recording = open_fixture(directory)
    one, two = declared_noise(recording)
    assert (one.gain, one.read_noise) == (None, None)
    assert (two.gain, two.read_noise) == (2.3, 8.0)
    references = characterise_cameras(recording).references
    assert references.gain[1] == 2.3
    assert references.gain[0] != 2.3


def test_a_few_frames_of_each_camera_are_counted(directory):
    one, two = count_frames(open_fixture(directory).pairs)
    for camera, histogram in enumerate((one, two), 1):
        images = [tifffile.imread(path) for path in (directory / f"camera{camera}").iterdir()]
        expected = np.bincount(np.stack(images).ravel(), minlength=4096)
        npt.assert_array_equal(histogram, expected)


def test_saturation_in_the_frames_of_one_camera_is_found_for_that_camera(directory):
    rng = np.random.default_rng(2)
    speckle = 13000 * rng.gamma(40, 1 / 40, SHAPE)
    bright = np.minimum(expose(speckle, 4.4, rng), 3302)
    write(directory / "camera2" / "1.tif", [bright])
    references = characterise_cameras(open_fixture(directory)).references
    assert references.full_scale.values.tolist() == [4095, 3302]
