"""What a recording determines as a whole, found or given."""

import pytest
import xarray as xr
from scenes.rig import small_rig

from erlif.core.progress import silent
from erlif.correction import CameraNoise
from erlif.io.ingest import open_run
from erlif.pipeline.recording.prepare import prepare_chain, restore_chain
from erlif.ratio import BlurDifference
from erlif.rig import simulate

BLUR = BlurDifference(0.03, -0.02, 0.001, 0.001, 0.004, 0.0001)


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


@pytest.mark.parametrize(("second", "warned"), [(0.9, False), (2.5, True)])
def test_a_camera_out_of_focus_is_named(tmp_path, second, warned):
    """Variances differ by 0.56 and by 6 px2."""
    simulate(tmp_path, seed=3, rig=small_rig(blur=(0.5, second)))
    notes = prepare_chain(open_run(tmp_path / "run"), silent).notes
    assert any("out of focus" in note.text for note in notes) == warned


def test_given_map_and_sharpness_are_used_as_they_are(run, prepared):
    noise = CameraNoise(2.0, 0.0, 5.0, 0.0)  # settings, darks and flats determine it
    chain = restore_chain(run, prepared.chain.camera_map, BLUR, (noise, noise))
    assert chain.camera_map is prepared.chain.camera_map
    assert chain.blur == BLUR
    xr.testing.assert_identical(chain.references, prepared.chain.references)
