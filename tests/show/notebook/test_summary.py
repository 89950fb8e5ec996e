"""A film at a glance."""

import numpy as np
import pytest
from scenes.motion import DISC, SLIDER, film_of

from erlif.show.notebook.summary import describe_in_html, describe_in_text
from erlif.show.plots import example_film


@pytest.fixture
def film():
    return example_film().assign_attrs(notes="warning: no flat\nset by <b>hand</b>")


def test_the_numbers_are_those_of_the_film(film):
    text = describe_in_text(film)
    low, high = float(film.film_min.min()), float(film.film_min.max())
    assert f"{low:.2f} to {high:.2f} um" in text
    assert "222.4 N" in text
    assert "warning: no flat" in text


def test_names_from_files_stay_text(film):
    evil = "<script>alert(1)</script>"
    film.attrs["settings"] = film.attrs["settings"].replace('"example"', f'"{evil}"')
    film.attrs["notes"] = f"warning: {evil}"
    film.film_predicted_min.attrs["regime"] = evil
    page = describe_in_html(film)
    assert "<script" not in page
    assert page.count("&lt;script&gt;") == 3


def test_a_film_without_values_or_theory_is_shown(film):
    bare = film.drop_vars(["film_theory", "film_predicted_min", "joint_load", "crank_angle"])
    bare["thickness"] = bare.thickness * np.nan
    assert "<img" not in describe_in_html(bare)
    assert "minimum film" in describe_in_text(bare.isel(trigger=0))

    # the name is that of the title where there are no settings
    del film.attrs["settings"]
    assert "oil-film thickness, example" in describe_in_text(film)


def test_the_angle_is_named_after_what_turns():
    for mechanism, title in ((DISC, "disc angle"), (SLIDER, "drive angle")):
        lines = describe_in_text(film_of(mechanism)).splitlines()
        assert any(line.strip().startswith(title) for line in lines)
        assert not any("crank angle" in line for line in lines)
