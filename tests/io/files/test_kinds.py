"""Products told apart by what they hold."""

from pathlib import Path

import pytest
import xarray as xr

from erlif.io.files.kinds import kind_of


@pytest.mark.parametrize(
    ("names", "kind"),
    [
        (("film_predicted", "film_min"), "prediction"),
        (("thickness", "film_min", "film_predicted_min"), "film"),
        (("pressure", "peak_pressure"), "pressure"),
        (("drift_x", "film_predicted_min"), "frames"),
        (("displacement_x",), "registration"),
        (("ratio_at_zero",), "calibration file"),
        (("counts",), "dataset"),
    ],
)
def test_a_dataset_has_the_kind_of_its_variables(names, kind):
    assert kind_of(xr.Dataset(dict.fromkeys(names, 1.0))) == kind


def test_paths_and_other_things():
    assert kind_of(Path("film.nc")) == kind_of("film.nc") == "path"
    assert kind_of(None) == kind_of(4.2) == ""
