"""Profiles that are off as a whole, against light by quadrature."""

from dataclasses import replace

import numpy as np
import pytest
from scenes.fixture import P, calibrate_wedge, light, log_ratio, wedge_profile

from erlif.pipeline.engines.results import FrameResult
from erlif.pipeline.physics.profile_offset import note_profile_offset
from erlif.ratio.cells import LightCells, cell_places

X, Y = cell_places()
FILM = 9.05 + 8.95 * X
"""Film of a straight wedge in the cells of the image. [um]"""


def frames(rng, illumination, *, speckle=0.02):
    """Cells of six pulses of different energy."""
    lit = np.log(light(FILM, P)) + illumination + speckle * rng.normal(size=X.size)
    none = np.zeros(X.size)
    return [
        FrameResult(n, (0.0, 0.0), (0, 0), cells=LightCells(one, log_ratio(FILM), none, none))
        for n, one in enumerate(lit + 0.1 * rng.normal(size=(6, 1)))
    ]


def note(rng, offset, illumination):
    profile = wedge_profile(rng)
    profile = replace(profile, thickness=profile.thickness + offset)
    return note_profile_offset(
        frames(rng, illumination), calibrate_wedge(rng, profile=profile), "profile.csv"
    )


BEAMS = {
    "even": 0 * X,
    "beam": -0.6 * (X - 0.3) ** 2 - 0.4 * (Y + 0.2) ** 2,
    "beam beside the image": -0.3 * (X + 1.2) ** 2 - 0.2 * X * Y,
    "flat beam": -0.2 * (X**4 + Y**4),
}


@pytest.mark.parametrize("beam", BEAMS)
@pytest.mark.parametrize("seed", range(4))
def test_a_sound_profile_has_no_note(beam, seed):
    assert note(np.random.default_rng(seed), 0.0, BEAMS[beam]) == []


@pytest.mark.parametrize("beam", ["even", "beam", "beam beside the image"])
@pytest.mark.parametrize(
    ("offset", "word"), [(5.0, "thinner"), (2.0, "thinner"), (-2.0, "thicker")]
)
def test_the_offset_of_a_profile_is_that_of_its_light(beam, offset, word):
    (found,) = note(np.random.default_rng(1), offset, BEAMS[beam])
    size = float(found.text.split("films ")[2].split(" um")[0])
    assert size == pytest.approx(abs(offset), abs=0.6)
    assert f"um {word} than in the profile" in found.text


def test_light_in_few_cells_shows_nothing():
    rng = np.random.default_rng(3)
    dark = [
        replace(one, cells=LightCells(*(np.where(X > -0.7, np.nan, part) for part in one.cells)))
        for one in frames(rng, 0 * X)
    ]
    assert note_profile_offset(dark, calibrate_wedge(rng), "profile.csv") == []
