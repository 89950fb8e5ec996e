"""Overlap, registration and pulses against the truth of the rig."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.io.ingest import read_pair
from erlif.review.check.cameras import (
    choose_consecutive,
    correlate_flats,
    note_pulses,
    note_registration,
)


def test_registration_is_described_by_three_pairs(surveyed):
    first, *pairs = note_registration(surveyed)
    assert len(pairs) == 3
    assert all(note.level == "note" for note in (first, *pairs))
    # the rig displaces camera 2 by (4, -3) px in the middle, and by 0.3 px more in each frame
    x, y = first.text.split("(")[1].split(")")[0].split(", ")
    npt.assert_allclose([float(x), float(y)], [4.0, -3.0], atol=0.4)


@pytest.mark.parametrize(
    ("change", "words"),
    [({"quality": 0.2}, "correlation of 0.20"), ({"overlap": None}, "0% of the image in common")],
)
def test_poor_registrations_are_warnings(surveyed, change, words):
    found = surveyed.chain.camera_map
    change = {k: np.zeros_like(found.overlap) if v is None else v for k, v in change.items()}
    chain = replace(surveyed.chain, camera_map=replace(found, **change))
    texts = [n.text for n in note_registration(replace(surveyed, chain=chain)) if n.level != "note"]
    assert len(texts) == 1
    assert words in texts[0]


def test_frames_without_a_common_texture_are_named(surveyed):
    frames = (replace(surveyed.frames[0], drift=(np.nan, np.nan)), *surveyed.frames[1:])
    last = list(note_registration(replace(surveyed, frames=frames)))[-1]
    assert last.level == "warning"
    assert last.text.startswith("no common texture of the cameras in pairs 0.")


def test_copies_that_the_counts_did_not_show_are_named(surveyed, run):
    """Of a long recording other pairs are counted than those that are searched in a row."""
    one, two, *others = surveyed.frames
    frames = (one, replace(two, pulse=one.pulse, digests=one.digests), *others)
    copied = replace(surveyed, frames=frames)
    texts = [note.text for note in note_pulses(copied, run.pairs) if note.level == "warning"]
    assert any("frame pairs 0, 1: they show the same image" in text for text in texts)
    counted = [note.text for note in note_pulses(copied, run.pairs, counted=range(6))]
    assert len(counted) == 1


def test_the_light_of_each_pair_is_that_above_the_dark(surveyed, run):
    """Against the counts of the files, within the vignetting of the flat."""
    for one, light in zip(surveyed.frames, surveyed.light, strict=True):
        for camera in range(2):
            counts = read_pair(run.pairs, one.frame).counts[camera]
            dark = float(surveyed.chain.references.dark_signal.values[camera])
            npt.assert_allclose(light[camera], np.median(counts) - dark, rtol=0.1)


@pytest.mark.parametrize(("count", "first", "chosen"), [(60, 0, 60), (61, 22, 16), (1000, 492, 16)])
def test_of_a_long_recording_consecutive_pairs_are_searched(run, count, first, chosen):
    page = run.pairs.pages[0][0]
    pairs = replace(run.pairs, pages=((page,) * count, (page,) * count))
    assert choose_consecutive(pairs) == list(range(first, first + chosen))


def test_the_picture_shows_light_and_a_difference_without_film(surveyed):
    picture = surveyed.picture
    assert picture.light[0].shape == (96, 128)
    valid = np.isfinite(picture.difference)
    assert valid.mean() > 0.8
    assert abs(np.nanmean(picture.difference)) < 0.01  # the film is taken out
    ratio = np.nanmedian(picture.light[1] / picture.light[0])
    npt.assert_allclose(ratio, np.exp(np.median(surveyed.log_ratios)), rtol=0.05)


@pytest.mark.parametrize("orientation", ["normal", "mirrored_x"])
def test_a_texture_of_the_object_is_found_where_the_map_places_it(orientation):
    """Camera 2 sees it 5 px to the right and 3 px up; both sensors add structure of their own."""
    rng = np.random.default_rng(5)
    wall = 1 + 0.03 * rng.normal(size=(110, 140)).astype(np.float32)
    one, two = wall[6:102, 6:134], wall[9:105, 1:129]
    if orientation == "mirrored_x":
        two = two[:, ::-1]
    flats = np.stack([one, two]) * (1 + 0.01 * rng.normal(size=(2, 96, 128)))
    flats, good = flats.astype(np.float32), np.zeros(flats.shape, bool)
    x, y = np.full((96, 128), 5, np.float32), np.full((96, 128), -3, np.float32)
    options = {"orientation": orientation}
    # the sensors have a tenth of the variance: 0.0009 / (0.0009 + 0.0001)
    assert correlate_flats(flats, good, x, y, **options) == pytest.approx(0.9, abs=0.07)
    assert abs(correlate_flats(flats, good, x + 4, y, **options)) < 0.05
