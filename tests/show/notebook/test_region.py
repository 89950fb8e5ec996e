"""Mean and minimum of a rectangle from the maps of a film."""

import numpy as np

import erlif
from erlif.rig import RigSettings
from erlif.show.notebook import summarise_region


def test_the_region_of_the_settings_has_the_statistics_of_the_film(opened):
    roi = erlif.files.region_of(opened)
    found = summarise_region(opened, x=roi.x, y=roi.y)
    for name in ("film_mean", "film_min"):
        difference = np.abs(found[name] - opened[name]) / opened[f"{name}_std"]
        assert float(difference.max()) < 0.5
        ratio = found[f"{name}_std"] / opened[f"{name}_std"]
        assert float(np.abs(ratio - 1).max()) < 0.1


def test_the_mean_of_a_part_is_that_of_the_known_film(opened, small_rig):
    x, y = (2.0, 12.0), (3.0, 11.0)
    found = summarise_region(opened, x=x, y=y)
    known = small_rig.truth.film.values
    inside = (opened.x.values >= x[0]) & (opened.x.values <= x[1])
    down = (opened.y.values >= y[0]) & (opened.y.values <= y[1])
    part = np.where(opened.flags.values == 0, known, np.nan)[:, down][:, :, inside]
    pull = (found.film_mean.values - np.nanmean(part, axis=(1, 2))) / found.film_mean_std.values
    assert np.abs(pull).max() < 4
    assert found.pixels.values.tolist() == np.isfinite(part).sum(axis=(1, 2)).tolist()


def test_the_minimum_lies_where_the_true_gap_has_it(opened):
    """The vertex to 1 px, 60 um, in spite of marks; across, to the error by noise and marks."""
    rig = RigSettings(width=opened.sizes["x"], height=opened.sizes["y"])
    vertex = rig.centre[0] + rig.thin_line / rig.pitch
    rows, columns = slice(10, 60), slice(16, 72)
    x, y = opened.x.values[columns], opened.y.values[rows]
    part = summarise_region(opened, x=(x[0], x[-1]), y=(y[0], y[-1]))
    roi = erlif.files.region_of(opened)
    own = np.hypot(*(opened.film_min_error.sel(error_term=term) for term in ("noise", "marks")))
    for found, row in ((opened, np.searchsorted(opened.y, roi.y[0])), (part, rows.start)):
        np.testing.assert_allclose(found.film_min_x, vertex, atol=1.0)
        rise = rig.tilt / rig.height * (found.film_min_y.values - row)
        assert (rise < 2 * own).all()


def test_both_parts_of_the_error_make_the_whole(opened):
    found = summarise_region(opened.isel(trigger=[1]))
    for name in ("film_mean_std", "film_min_std"):
        parts = np.hypot(found[f"{name}_random"], found[f"{name}_shared"])
        np.testing.assert_allclose(parts, found[name])
    assert "crank_angle" in found.film_mean.coords
    one = summarise_region(opened.isel(trigger=2))
    assert one.film_mean.ndim == 0
    assert 0 < float(one.share_valid) <= 1


def test_random_part_is_the_noise_whatever_the_shared_error_of_the_maps_is(opened):
    """The maps hold the shared error as it was before the run, which may have reduced it."""
    roi = erlif.files.region_of(opened)
    wider = opened.assign(thickness_std_shared=opened.thickness_std_shared + 0.5)
    found = summarise_region(wider, x=roi.x, y=roi.y)
    for name in ("film_mean", "film_min"):
        noise = opened[f"{name}_error"].sel(error_term="noise")
        np.testing.assert_allclose(found[f"{name}_std_random"], noise, rtol=0.15)
