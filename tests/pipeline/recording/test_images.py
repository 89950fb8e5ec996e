"""The images behind a map are those that the map was made from."""

from __future__ import annotations

import shutil

import numpy as np
import numpy.testing as npt
import pytest
import tifffile

import erlif
from erlif.calibration import calibration_of
from erlif.core.errors import FrameError, OutputError
from erlif.io.files import open_film
from erlif.pipeline import restore_images
from erlif.thickness import measure_thickness

pytestmark = pytest.mark.usefixtures("without_theory")

SHARE_OF_STD = 0.1  # of the standard deviation of a pixel: rounding error of a stored thickness
STORED_BITS = 5  # of the mantissa of a stored standard deviation


@pytest.fixture(scope="module")
def cycles(two_cycles, calibration, tmp_path_factory):
    """A run with two frames of each trigger, and its film."""
    run = shutil.copytree(two_cycles.run, tmp_path_factory.mktemp("images") / "run")
    erlif.process(run, calibration=calibration, output=run / "film.nc", workers=1).close()
    return run


def assert_behind_map(images, film, trigger):
    """The thickness of the ratio is that of the map, to the rounding of the file."""
    maps = measure_thickness(images, calibration_of(film))
    stored = film.isel(trigger=trigger)
    npt.assert_array_equal(maps.flags.values, stored.flags.values)
    valid = stored.flags.values == 0
    assert valid.mean() > 0.5
    thickness, std = maps.thickness.values[valid], maps.thickness_std.values[valid]
    # one more part in 1e5: the film stores the camera map in single precision
    error = np.abs(stored.thickness.values[valid] - thickness)
    assert np.all(error <= SHARE_OF_STD * std + 1e-5 * thickness)
    npt.assert_allclose(
        stored.thickness_std.values[valid], std, rtol=2.0 ** -(STORED_BITS + 1) + 1e-5
    )


@pytest.mark.parametrize("trigger", [0, 4])
def test_ratio_is_the_one_behind_the_map(cycles, trigger):
    images = restore_images(cycles / "film.nc", cycles, trigger=trigger)
    assert len(images.attrs["frames"]) == 2
    with open_film(cycles / "film.nc") as film:
        assert_behind_map(images, film, trigger)


def smooth(lab):
    lab.edit("run/run.toml", ("[thickness]", "[thickness]\nsmoothing = 5"))


def leave_noise_open(lab):
    """Without read noise and darks it is estimated from the frames, and enters the ratio."""
    lines = (lab.run / "run.toml").read_text().splitlines()
    kept = [line for line in lines if not line.startswith(("read_noise", "dark", "flat"))]
    kept = [line.replace("bit_depth", 'offset = "64 DN"\nbit_depth') for line in kept]
    (lab.run / "run.toml").write_text("\n".join(kept))


@pytest.mark.parametrize(
    ("change", "noted"), [(smooth, "smoothing"), (leave_noise_open, "read noise estimated from")]
)
def test_ratio_under_other_settings_is_the_one_behind_the_map(lab, change, noted):
    change(lab)
    erlif.process(lab.run, output=lab.film, workers=1).close()
    images = restore_images(lab.film, lab.run, trigger=1)
    with open_film(lab.film) as stored:
        assert noted in stored.attrs["notes"] or noted in stored.attrs
        assert_behind_map(images, stored, 1)


def test_light_is_the_mean_of_the_frames_less_dark_over_flat(cycles):
    """Camera 1 stays on its own grid, so that plain arithmetic on the files gives its light."""
    images = restore_images(cycles / "film.nc", cycles, trigger=2)
    pages = [tifffile.imread(path) for path in sorted((cycles / "camera1").iterdir())]
    counts = np.mean([pages[k].astype(float) for k in images.attrs["frames"]], axis=0)
    dark = tifffile.imread(cycles / "camera1_dark.tif").astype(float).mean(axis=0)
    flat = tifffile.imread(cycles / "camera1_flat.tif").astype(float).mean(axis=0) - dark
    sound = images.flags.values == 0
    expected = (counts - dark)[sound] / flat[sound]
    ratio = images.light.values[0][sound] / expected
    npt.assert_allclose(ratio, np.median(ratio), rtol=1e-3)
    assert images.light.attrs["units"] == "DN"


def test_settings_are_those_of_the_film(lab, film):
    """An edit of run.toml after the film was made does not change the images behind the film."""
    lab.edit("run/run.toml", ("[thickness]", '[thickness]\nleast_signal = "4000 electron"'))
    images = restore_images(film, lab.run, trigger=1)
    with open_film(film) as stored:
        assert_behind_map(images, stored, 1)


def test_trigger_whose_frames_were_left_out_is_refused(lab):
    lab.frames(1)[2].write_bytes(b"no image")
    erlif.process(lab.run, output=lab.film, workers=1, skip_bad_frames=True).close()
    with pytest.raises(FrameError, match="all of them were left out"):
        restore_images(lab.film, lab.run, trigger=2)


def test_run_of_other_files_is_refused(film, lab):
    for camera in (1, 2):
        for path in lab.frames(camera):
            path.rename(path.with_name(f"other_{path.name}"))
    with pytest.raises(FrameError, match="Expected the run that the film was made from"):
        restore_images(film, lab.run, trigger=0)
    for camera in (1, 2):
        lab.frames(camera)[5].unlink()
    log = (lab.run / "encoder.csv").read_text().splitlines()
    (lab.run / "encoder.csv").write_text("\n".join(log[:-1]) + "\n")
    with pytest.raises(FrameError, match="6 frames of 128 x 96"):
        restore_images(film, lab.run, trigger=0)


def test_film_without_its_sharpness_is_refused(film, small_rig, tmp_path):
    """The ratio of such a film could differ from the one behind its map."""
    import h5py

    copy = shutil.copy(film, tmp_path / "film.nc")
    with h5py.File(copy, "r+") as file:
        del file["registration"].attrs["blur_difference"]
    with pytest.raises(OutputError, match="blur_difference"):
        restore_images(copy, small_rig.run, trigger=0)
