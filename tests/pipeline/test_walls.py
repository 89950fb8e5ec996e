"""A joint whose wall reflects 30 % and a fixture whose wall reflects 10 %, from frames to film."""

import numpy as np
import pytest
from scenes.rig import small_rig

import erlif
from conftest import Laboratory

pytestmark = pytest.mark.usefixtures("without_theory")

RIG = small_rig(film_reference=4.0, wall=(0.1, 0.3), spacing=6.0)
OPTICS = 'x_axis = "sliding"'


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    lab = Laboratory.simulated(tmp_path_factory.mktemp("walls"), seed=71, rig=RIG)
    lab.edit("fixture/fixture.toml", (OPTICS, f'{OPTICS}\nwall = "10 %"'))
    path = lab.fixture / "calibration.nc"
    erlif.save_calibration(erlif.calibrate(lab.fixture), path, overwrite=True)
    return lab


def test_films_before_the_stated_wall_are_those_of_the_truth(lab):
    film = lab.process_copy("stated", (OPTICS, f'{OPTICS}\nwall = "30 %"'))
    inside, error = lab.errors(film, above=2.5, below=5)
    off = np.median(error[inside])
    assert abs(np.median(error[inside] / lab.truth.film.values[inside])) < 0.02
    assert abs(off) < 2 * np.median(film.thickness_std_shared.values[inside])
    assert "a joint whose wall reflects 30%" in film.attrs["notes"]
    assert "wall" in film.error_term

    # with the curve of the fixture, films of the joint read half as thick again
    plain = lab.process_copy("plain", add='\n[light]\nerrors = "report"\n')
    inside, error = lab.errors(plain, above=2.5, below=5)
    assert np.median(error[inside]) > 1.0
