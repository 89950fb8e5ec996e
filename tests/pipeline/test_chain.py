"""From counts to ratios with the map of a whole recording: stored maps, misfired pulses."""

import numpy as np
import numpy.testing as npt
import pytest
import tifffile

import erlif
from erlif.core.flags import Flag

pytestmark = pytest.mark.usefixtures("without_theory")

REUSE = ("[thickness]", "[registration]\nreuse = true\n\n[thickness]")


def test_map_stored_with_the_calibration_is_used_for_a_run(lab, film, opened):
    """Camera 2 has moved since the fixture; the map is as good as one of the run's own frames."""
    lab.edit("run/run.toml", REUSE)
    reused = erlif.process(lab.run, output=lab.film)
    groups = [erlif.open_film(path, group="registration") for path in (film, lab.film)]
    for name in ("displacement_x", "displacement_y"):
        npt.assert_allclose(
            groups[1][name].values[8:-8, 8:-8], groups[0][name].values[8:-8, 8:-8], atol=0.08
        )
    assert "stored with the calibration" in groups[1].attrs["registration_model"]
    npt.assert_allclose(reused.film_mean, opened.film_mean, rtol=0.01)


@pytest.mark.parametrize("camera", [1, 2])
def test_frame_of_a_misfired_pulse_is_flagged_and_has_a_note(lab, camera):
    """One frame shows nothing but room light, without the texture of the other camera."""
    rng = np.random.default_rng(1)
    path = lab.frames(camera)[2]
    tifffile.imwrite(path, rng.normal(900, 14, (96, 128)).astype(np.uint16))
    film = erlif.process(lab.run)
    assert np.all(film.flags.values[2] & Flag.POOR_REGISTRATION)
    assert np.isnan(film.thickness.values[2]).all()
    assert (film.flags.values[[0, 1, 3]] == 0).mean() > 0.7
    assert "frame pairs 2: no common texture" in film.attrs["notes"]
