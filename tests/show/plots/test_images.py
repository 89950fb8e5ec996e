"""Light and ratio behind a map, as they are drawn."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.core.flags import Flag
from erlif.pipeline import restore_images
from erlif.show import plots

TRIGGER = 3


@pytest.fixture(scope="module")
def images(film_path):
    return restore_images(film_path, film_path.parent, trigger=TRIGGER)


def test_band_image_shows_the_light_of_its_camera(images, film):
    """A lamp in a flagged pixel does not darken the rest of the image."""
    for camera, band in ((1, "580 nm"), (2, "610 nm")):
        image = plots.band_images(images, film, camera=camera)
        npt.assert_array_equal(image.get_array(), images.light.values[camera - 1])
        assert image.axes.get_title() == f"camera {camera}, {band}"
    bright = images.copy(deep=True)
    bright.light.values[0, 30, 30] = 1e6
    bright.flags.values[30, 30] = Flag.SATURATED
    _, high = plots.band_images(bright, film, camera=1).get_clim()
    assert high < 2000


def test_ratio_is_drawn_where_no_flag_is_set(images, film):
    image = plots.ratio_image(images, film)
    drawn = np.ma.filled(image.get_array(), np.nan)
    npt.assert_array_equal(np.isnan(drawn), images.flags.values != 0)
    expected = scene.true_ratio(scene.true_film()[TRIGGER])
    valid = images.flags.values == 0
    npt.assert_allclose(drawn[valid], expected[valid], rtol=2e-3)
    blind = images.copy(deep=True)
    blind.flags.values[:] = Flag.POOR_REGISTRATION
    assert np.ma.count(plots.ratio_image(blind, film).get_array()) == 0


def test_figure_names_trigger_and_frame(images, film):
    for frames, words in (([3], "frame pair 3"), ([3, 9], "mean of 2 frame pairs")):
        named = images.assign_attrs(frames=frames)
        title = plots.band_images_figure(named, film, trigger=TRIGGER).get_suptitle()
        assert "; trigger 3, " in title
        assert title.endswith(f", {words}")
