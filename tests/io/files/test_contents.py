"""What is read from a film."""

import tomllib

import numpy as np
import pytest
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.io.files import (
    check_trigger,
    fastest_trigger,
    flag_shares,
    has_identity,
    region_of,
    settings_of,
)
from erlif.io.files.soundness import check_film
from erlif.io.settings import to_toml


def triggers(speed, stroke):
    return xr.Dataset({"rocker_speed": ("trigger", speed), "stroke": ("trigger", stroke)})


def test_the_region_is_that_of_the_settings(small_rig, opened):
    written = tomllib.loads((small_rig.run / "run.toml").read_text())["thickness"]["roi"]
    assert [list(region_of(opened).x), list(region_of(opened).y)] == [written["x"], written["y"]]


def test_without_a_region_the_whole_image_is_taken(opened):
    settings = settings_of(opened)
    whole = settings.thickness.model_copy(update={"roi": None})
    without = opened.assign_attrs(
        settings=to_toml(settings.model_copy(update={"thickness": whole}))
    )
    region = region_of(without)
    assert region.x == (0, float(opened.x[-1]))
    assert region.y == (0, float(opened.y[-1]))


def test_without_an_outward_stroke_the_fastest_of_all_is_taken():
    assert fastest_trigger(triggers([-1.0, -2.0], [-1, -1])) == 1


def test_a_film_has_the_identity_of_its_work_and_no_other(film, opened):
    assert has_identity(film, opened.attrs["identity"])
    assert not has_identity(film, "ab" * 32)


@pytest.mark.parametrize("content", [None, b"", b"something else"])
def test_a_missing_or_foreign_file_has_no_identity(tmp_path, content):
    path = tmp_path / "film.nc"
    if content is not None:
        path.write_bytes(content)
    assert not has_identity(path, "ab" * 32)


def test_a_film_from_before_a_flag_was_added_has_shares_of_all_flags(opened):
    older = opened.isel(flag=slice(-1))
    check_film(older)
    np.testing.assert_array_equal(flag_shares(older), flag_shares(opened))


def test_shares_of_flags_are_those_of_the_maps(opened):
    """A film that has no counts, as one of an earlier version, is counted map by map."""
    counted, read = flag_shares(opened), flag_shares(opened.drop_vars(["flagged_pixels", "flag"]))
    np.testing.assert_array_equal(counted, read)
    np.testing.assert_array_equal(counted[:, 0], (opened.flags == 0).mean(("y", "x")))


@pytest.mark.parametrize("given", ["90 deg", 1.0, None, [0, 1]])
def test_a_trigger_that_is_no_number_is_refused_with_the_way_from_an_angle(given):
    film = xr.Dataset({"joint_load": ("trigger", [220.0, 230.0])})
    check_trigger(film, np.int64(1))
    check_trigger(film, film["joint_load"].argmin("trigger"))
    with pytest.raises(ErlifError, match=r"from 0 to 1; got .*choose_trigger\(film, crank_angle="):
        check_trigger(film, given)
