"""A scratch and a bolt in the image of both cameras, excluded, against the truth of the rig.

Both are painted into the frames with constant light. The bolt stands before the film: camera 2 sees
it 3 px beside the film that it hides, and it does not move with the drift of the cameras.
"""

import shutil
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
from PIL import Image
from scenes.rig import small_rig

import erlif
from conftest import Laboratory, read_film
from erlif.core.flags import Flag
from erlif.io.ingest import open_run
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.watch.live import LiveFilm, run_of

pytestmark = pytest.mark.usefixtures("without_theory")

RIG = small_rig(spacing=6.0)
"""Eight triggers on 128 x 96 pixels of 150 um."""

Y, X = np.indices((96, 128), dtype=float)
BOLT, RADIUS, PARALLAX = (48.0, 60.0), 9.0, 3.0  # px

REGION = (slice(14, 87), slice(27, 101))
"""Rows and columns of the region of interest, x 4 to 15 mm and y 2 to 13 mm."""

MARGIN = 3.0
"""By which the mask is wider than what it hides. [px]"""


def on_bolt(x, y, margin=0.0):
    return np.hypot(x - BOLT[0], y - BOLT[1]) <= RADIUS + margin


def on_scratch(x, y, margin=0.0):
    return np.abs(y - 30 - 0.25 * (x - 64)) <= 1 + margin


def on_both(x, y, margin=0.0):
    return on_bolt(x, y, margin) | on_scratch(x, y, margin)


MASK = on_both(X, Y, MARGIN) | on_bolt(X - PARALLAX, Y, MARGIN)


def paint(directory, displacement):
    """A scratch on the surface, and a bolt before it, in every frame of a run or fixture."""
    dx, dy = displacement
    for path in (directory / "camera1").iterdir():
        image = tifffile.imread(path)
        image[on_bolt(X, Y)], image[on_scratch(X, Y)] = 2400, 1800
        tifffile.imwrite(path, image)
    for path in (directory / "camera2").iterdir():
        image = tifffile.imread(path)
        image[on_bolt(X - dx - PARALLAX, Y - dy)], image[on_scratch(X - dx, Y - dy)] = 2600, 1750
        tifffile.imwrite(path, image)


def exclude(directory, name):
    """Exclude the mask by the settings of a run or fixture."""
    Image.fromarray(np.where(MASK, 255, 0).astype(np.uint8)).save(directory / "mask.png")
    path, head = directory / name, "[thickness]\n"
    text = path.read_text(encoding="utf-8")
    text = text if head in text else f"{text}\n{head}"
    line = 'exclude = ["mask.png"]\n'
    path.write_text(text.replace(head, head + line), encoding="utf-8")


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """Runs as the rig wrote them and with both marks, each with a mask and without."""
    lab = Laboratory.simulated(tmp_path_factory.mktemp("marks"), seed=41, rig=RIG)
    moved = lab.truth.displacement_x.values, lab.truth.displacement_y.values
    for name in ("marked", "masked", "masked without marks"):
        run = lab.copy_run(name)
        if name != "masked without marks":
            paint(run, moved)
        if name != "marked":
            exclude(run, "run.toml")
    return lab


@pytest.fixture(scope="module")
def films(lab):
    found = {}
    for name in ("marked", "masked", "masked without marks"):
        path = lab.directory / name / "film.nc"
        erlif.process(path.parent, output=path, workers=2).close()
        found[name] = read_film(path)
    return found


def mean_errors(lab, film):
    """Error of the mean over the region, in its standard deviations."""
    true = lab.truth.film.where(np.isfinite(film.thickness.values)).values[:, *REGION]
    return (film.film_mean.values - np.nanmean(true, axis=(1, 2))) / film.film_mean_std.values


def far_pixels(lab, film):
    """Pixels whose film is wrong by more than six standard deviations."""
    error = film.thickness.values - lab.truth.film.values
    return np.abs(error) > 6 * np.hypot(film.thickness_std, film.thickness_std_shared).values


def test_masked_pixels_have_this_flag_alone_and_no_other_pixel_has_it(films):
    flags = films["masked"]["flags"].values
    npt.assert_array_equal(flags & Flag.MASKED > 0, np.broadcast_to(MASK, flags.shape))
    assert (flags[:, MASK] == Flag.MASKED).mean() > 0.99


def test_statistics_are_those_of_the_film_that_is_left(lab, films):
    """Without the mask the mean is wrong by many standard deviations."""
    assert np.abs(mean_errors(lab, films["marked"])).min() > 8
    assert np.abs(mean_errors(lab, films["masked"])).max() < 3
    assert far_pixels(lab, films["marked"]).sum() > 100
    assert not far_pixels(lab, films["masked"]).any()


def test_minimum_is_that_of_the_rig(lab, films):
    film = films["masked"]
    error = film.film_min.values - lab.truth.film_min.values
    assert (np.abs(error) < 3 * film.film_min_std.values).all()


@pytest.mark.parametrize("name", ["film_min", "film_mean", "film_gap_mean"])
def test_nothing_depends_on_what_is_under_a_mask(films, name):
    """A run without scratch and bolt has the same numbers under the same mask."""
    one, other = films["masked"], films["masked without marks"]
    apart = np.abs(one[name].values - other[name].values)
    assert (apart < 0.1 * one[f"{name}_std"].values).all()


@pytest.mark.usefixtures("films")
def test_registration_does_not_follow_a_bolt(lab):
    """It stands still while the cameras drift: the drift of each pair and the map of the film."""
    drifts, maps = {}, {}
    true = lab.truth
    for name in ("marked", "masked"):
        path = lab.directory / name / "film.nc"
        found, registered = read_film(path, "frames"), read_film(path, "registration")
        # a mean drift is part of the map
        apart = found.drift_x.values - true.drift_x.values, found.drift_y.values - true.drift_y
        drifts[name] = float(np.hypot(*(axis.std() for axis in apart)))
        dx = registered.displacement_x.values - true.displacement_x.values
        dy = registered.displacement_y.values - true.displacement_y.values
        maps[name] = float(np.sqrt(np.nanmean(np.hypot(dx, dy)[~MASK] ** 2)))
    assert drifts["masked"] < 0.01  # px
    assert drifts["marked"] > 3 * drifts["masked"]
    assert maps["masked"] < 0.015  # px
    assert maps["marked"] > maps["masked"]


def test_the_film_states_its_mask_and_the_hash_of_its_file(films):
    film = films["masked"]
    share = f"{MASK.sum()} pixels, {100 * MASK.mean():.1f} % of the image"
    assert f"excluded: {share}" in film.attrs["notes"]
    assert "mask.png" in film.attrs["input_hashes"]
    assert "excluded" not in films["marked"].attrs["notes"]


def test_a_pair_that_is_watched_has_the_mask(lab):
    run = open_run(lab.directory / "masked")
    bare = run_of(run.directory, run.settings, replace(run.pairs, excluded=None))
    film = LiveFilm.prepare(bare, *find_calibration(bare, None))
    maps, _ = film.task.measure_pair(4, 4, 0.0)
    npt.assert_array_equal(maps["flags"] & Flag.MASKED > 0, MASK)


def test_a_calibration_leaves_out_what_its_fixture_excludes(lab):
    """Frames of the fixture with both marks and without have one calibration under the mask."""
    moved = lab.truth.displacement_x.values, lab.truth.displacement_y.values
    for name in ("clean", "marked", "masked"):
        shutil.copytree(lab.fixture, lab.directory / "fixtures" / name)
    for name in ("marked", "masked"):
        paint(lab.directory / "fixtures" / name, moved)
    for name in ("clean", "masked"):
        exclude(lab.directory / "fixtures" / name, "fixture.toml")
    clean, marked, masked = (
        erlif.calibrate(lab.directory / "fixtures" / name) for name in ("clean", "marked", "masked")
    )

    films = np.linspace(1.0, 10.0, 19)
    expected, std = clean.predict_log(films), clean.log_ratio_std(films)
    assert (np.abs(masked.predict_log(films) - expected) < 0.5 * std).all()
    assert (np.abs(marked.predict_log(films) - expected) / std).max() > 20
    assert "mask.png" in masked.input_hashes
    assert any(note.subject == "excluded" for note in masked.notes)
