"""The attribute `erlif` of a film."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from matplotlib.figure import Figure

import erlif
from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.show.notebook.film import describe_in_html, describe_in_text
from erlif.show.plots import example_film


@pytest.fixture(scope="module")
def example():
    return example_film()


def test_masks_are_those_of_the_flags(example):
    flags = example.flags.values
    npt.assert_array_equal(example.erlif.mask("no_film"), flags & Flag.NO_FILM > 0)
    both = (flags & (Flag.NO_FILM | Flag.OUTSIDE_OVERLAP)) > 0
    npt.assert_array_equal(example.erlif.mask("no_film", "outside_overlap"), both)
    npt.assert_array_equal(example.erlif.mask(), ~example.erlif.valid)
    npt.assert_array_equal(example.erlif.valid, np.isfinite(example.thickness))
    assert example.isel(trigger=2).erlif.mask("no_film").dims == ("y", "x")


def test_groups_of_a_film_come_from_its_file(film):
    with erlif.open_film(film) as opened:
        assert opened.erlif.frames.sizes["frame"] == 6
        assert "displacement_x" in opened.erlif.registration


def test_a_map_is_drawn_with_y_downwards_in_the_axes_given(example):
    ax = Figure().subplots()
    drawn = example.erlif.plot_map("thickness_std", trigger=1, ax=ax)
    assert drawn.get_cmap() == erlif.plots.thickness_map(example, trigger=1).get_cmap()
    assert example.erlif.plot_map(trigger=1, cmap="gray").get_cmap().name == "gray"
    assert drawn.axes is ax
    assert ax.yaxis_inverted()
    assert ax.get_aspect() == 1
    upwards = example.erlif.plot_map(trigger=1, ax=Figure().subplots(), yincrease=True, vmax=3.0)
    assert not upwards.axes.yaxis_inverted()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda film: film.erlif.mask("bubble"), "masked; got bubble"),
        (lambda film: film.erlif.frames, r"open_film\(.*group=\"frames\"\)"),
        (lambda film: film.erlif.plot_map(), "Give trigger="),
        (lambda film: film.erlif.plot_map(trigger=6), "from 0 to 5"),
        (lambda film: film.erlif.plot_map("pressure", trigger=0), "with pressure"),
        (lambda film: film.thickness.erlif.plot(), r"isel\(trigger=3\)"),
        (lambda film: film.erlif.region(x=(1, 2)), "at least 32 x 32 pixels"),
        (lambda film: film[["film_min"]].erlif.region(), "erlif.open_film"),
        (lambda film: film[["film_min"]].erlif.valid, "holds"),
    ],
)
def test_what_is_not_there_is_named_with_the_next_step(example, call, message):
    with pytest.raises(ErlifError, match=message):
        call(example)


def test_any_dataset_can_be_shown():
    other = xr.Dataset({"counts": ("x", [1, 2])})
    assert "holds counts" in repr(other.erlif)
    assert "erlif.open_film" in other.erlif._repr_html_()


def test_axes_have_the_long_names_and_units_of_a_film_from_a_file(film):
    with erlif.open_film(film) as opened:
        ax = Figure().subplots()
        opened.thickness.isel(trigger=1).erlif.plot(ax=ax, add_colorbar=False)
        angle = float(opened.crank_angle[1])
        assert ax.get_title() == f"trigger 1, crank angle {angle:.4g}°"
        assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (sliding) [mm]", "y [mm]")
        line = Figure().subplots()
        opened.film_min.plot(x="crank_angle", ax=line)
        assert line.get_xlabel() == "crank angle [degree]"
        assert line.get_ylabel() == "minimum film thickness [um]"


@pytest.fixture
def noted():
    return example_film().assign_attrs(notes="warning: no flat\nset by <b>hand</b>")


def test_the_numbers_are_those_of_the_film(noted):
    text = describe_in_text(noted)
    low, high = float(noted.film_min.min()), float(noted.film_min.max())
    assert f"min {low:.2f} ± 0.03 to {high:.2f} ± 0.03, mean " in text
    assert "222.4 N" in text
    assert "warning: no flat" in text


def test_names_from_files_stay_text(noted):
    evil = "<script>alert(1)</script>"
    noted.attrs["settings"] = noted.attrs["settings"].replace('"example"', f'"{evil}"')
    noted.attrs["notes"] = f"warning: {evil}"
    page = describe_in_html(noted)
    assert "<script" not in page
    assert page.count("&lt;script&gt;") == 2


def test_a_film_without_values_or_theory_is_shown(noted):
    bare = noted.drop_vars(["film_theory", "film_predicted_min", "joint_load", "crank_angle"])
    bare["thickness"] = bare.thickness * np.nan
    assert "<img" not in describe_in_html(bare)
    assert "film                    min " in describe_in_text(bare.isel(trigger=0))

    # the name is that of the title where there are no settings
    del noted.attrs["settings"]
    assert "oil-film thickness, example" in describe_in_text(noted)
