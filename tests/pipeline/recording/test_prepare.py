"""What a recording determines as a whole, found or given."""

import numpy as np
import xarray as xr

from erlif.core.progress import silent
from erlif.io.ingest import open_run
from erlif.pipeline.recording.prepare import prepare_chain, prepare_with_map
from erlif.ratio import BlurDifference

BLUR = BlurDifference(0.03, -0.02, 0.001, 0.001)


def without_noise(lab):
    """A run whose gain and flats are not known."""
    noise = ('gain = "4.4 electron/DN"\n', "")
    lab.edit("run/run.toml", noise, noise)
    for camera in (1, 2):
        lab.edit("run/run.toml", (f'flat = "camera{camera}_flat.tif"\n', ""))
    return open_run(lab.run)


def test_options_of_the_settings_reach_the_chain(lab):
    limits = '[thickness]\nleast_signal = "250 electron"\nno_film_below = 0.4\n'
    lab.edit("run/run.toml", ("[thickness]\n", limits))
    chain = prepare_chain(open_run(lab.run), silent).chain
    assert (chain.correct.least_signal, chain.no_film_below) == (250, 0.4)


def test_cameras_of_the_rig_are_equally_sharp_but_for_the_interpolation(prepared):
    """Half a blur variance of 0.1 px2 would show in every edge."""
    blur = prepared.chain.blur
    assert abs(blur.x) < 0.1
    assert abs(blur.y) < 0.1
    assert 0 < blur.std_x < 0.1


def test_given_map_and_sharpness_are_used_as_they_are(run, prepared):
    chain = prepare_with_map(run, prepared.chain.camera_map, blur=BLUR).chain
    assert chain.camera_map is prepared.chain.camera_map
    assert chain.blur == BLUR
    xr.testing.assert_identical(chain.references, prepared.chain.references)


def test_given_map_and_sharpness_reproduce_the_ratio(run, prepared):
    chain = prepare_with_map(run, prepared.chain.camera_map, blur=prepared.chain.blur).chain
    own = prepared.chain.measure(2).to_images().copy(deep=True)
    xr.testing.assert_identical(chain.measure(2).to_images(), own)


def test_given_sharpness_stays_where_the_noise_is_estimated(lab, prepared):
    """The estimate of an unknown gain compares the sharpness anew for itself."""
    completed = prepare_with_map(without_noise(lab), prepared.chain.camera_map, blur=BLUR)
    assert completed.chain.blur == BLUR
    references = completed.chain.references
    assert np.all(np.abs(references.gain - 4.4) < 3 * references.gain_std)
    assert any("estimated from the noise" in note.text for note in completed.notes)
