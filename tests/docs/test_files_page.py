"""The pages about files and the JSON schemas, held to what erlif reads and writes."""

import re
from pathlib import Path

import h5netcdf
import numpy as np
import pytest
import xarray as xr
from scenes.scripts import load_script

import erlif
from erlif.calibration import read_profile
from erlif.calibration.departure import Departure
from erlif.core.variables import CALIBRATION
from erlif.io.files import write_dataset
from erlif.io.ingest import read_encoder_log
from erlif.io.settings import keys_of

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def page():
    return load_script(DOCS / "make_files.py")


@pytest.mark.parametrize("name", ["settings.md", "film_nc.md", "other_files.md"])
def test_the_committed_pages_are_the_generated_ones(page, name):
    assert (DOCS / name).read_text(encoding="utf-8") == page.PAGES[name](), (
        "python docs/make_files.py"
    )


def test_pages_list_every_key_variable_and_attribute(page):
    settings = (DOCS / "settings.md").read_text(encoding="utf-8")
    kinds = [getattr(page, name) for name in dir(page) if name.endswith("Settings")]
    keys = [
        key.name for kind in kinds for table in page.tables_of(kind) for key in keys_of(table.kind)
    ]
    assert len(keys) > 200
    assert not [name for name in keys if f"`{name}`" not in settings]

    for name, products in {
        "film_nc.md": ("FILM", "FRAMES", "REGISTRATION"),
        "other_files.md": ("CALIBRATION", "PREDICTION", "PREDICTION_FRAMES", "PRESSURE"),
    }.items():
        text = (DOCS / name).read_text(encoding="utf-8")
        listed = [one for each in products for one in getattr(page, each)]
        listed += [one.name for each in products for one in getattr(page, f"{each}_ATTRIBUTES", ())]
        text = re.sub(r"`(\w+)`, `_std`", r"`\1`, `\1_std`", text)
        assert not [one for one in listed if f"`{one}`" not in text]


def test_the_committed_schemas_are_the_generated_ones(page):
    for name, text in page.schemas().items():
        assert (DOCS / "schema" / name).read_text(encoding="utf-8") == text, (
            "python docs/make_files.py"
        )


def contents(group):
    """Dims, type and unit of each variable of a group; text is stored as rows of characters."""
    found = {}
    for name, variable in group.variables.items():
        kind = (
            "text"
            if variable.dtype == object or variable.dtype.kind in "SU"
            else str(variable.dtype)
        )
        dims = tuple(dim for dim in variable.dimensions if not dim.startswith("string"))
        unit = variable.attrs.get("units", "")
        found[name] = (dims, kind, unit.decode() if isinstance(unit, bytes) else unit)
    return found


def check_names(found, documented):
    """Names of the file are on the page; names of the page without a condition are in the file."""
    assert set(found) <= {one.name for one in documented}
    assert {one.name for one in documented if not one.when} <= set(found)


def check_variables(found, documented):
    check_names(found, documented.values())
    form = {name: (one.dims, one.dtype, one.units) for name, one in documented.items()}
    assert found == {name: form[name] for name in found}


def check_group(group, page, name):
    """Variables and attributes of a group are those that the page lists under a name."""
    check_variables(contents(group), getattr(page, name))
    if attributes := getattr(page, f"{name}_ATTRIBUTES", ()):
        check_names(group.attrs, attributes)


def test_film_holds_the_variables_and_attributes_of_the_page(page, film):
    with h5netcdf.File(film) as file:
        found = contents(file)
        assert found.pop("laser_mJ") == (("trigger",), "float64", "")  # a further column of the log
        check_variables(found, page.FILM)
        check_names(file.attrs, page.FILM_ATTRIBUTES)
        check_group(file.groups["frames"], page, "FRAMES")
        registration = file.groups["registration"]
        check_variables(contents(registration), page.REGISTRATION)
        check_names(registration.attrs, [*page.REGISTRATION_ATTRIBUTES, *page.BLUR_ATTRIBUTES])
        used = {name for variable in file.variables.values() for name in variable.attrs}
        # bookkeeping of netCDF and of text
        check_names(used - {"_FillValue", "_Encoding"}, page.VARIABLE_ATTRIBUTES)


@pytest.mark.usefixtures("coarse_pressure")
def test_other_products_hold_the_variables_and_attributes_of_the_page(
    page, film, small_rig, tmp_path
):
    erlif.predict(film, output=tmp_path / "prediction.nc").close()
    write_dataset(erlif.pressure_from_film(film), tmp_path / "pressure.nc")
    for path, name, groups in (
        (tmp_path / "prediction.nc", "PREDICTION", {"frames": "PREDICTION_FRAMES"}),
        (tmp_path / "pressure.nc", "PRESSURE", {}),
        (small_rig.fixture / "calibration.nc", "CALIBRATION", {"registration": "REGISTRATION"}),
    ):
        with h5netcdf.File(path) as file:
            check_group(file, page, name)
            for group, listed in groups.items():
                check_group(file.groups[group], page, listed)


def test_a_departure_from_the_model_is_stored_as_the_page_describes(page):
    spline = Departure(np.arange(8.0), np.zeros(4), np.eye(4)).variables()
    dataset = xr.Dataset({name: CALIBRATION[name].fill(values) for name, values in spline.items()})
    found = {
        str(name): (dataset[name].dims, str(dataset[name].dtype), dataset[name].attrs["units"])
        for name in dataset
    }
    form = {name: one for name, one in page.CALIBRATION.items() if name.startswith("departure")}
    assert found == {name: (one.dims, one.dtype, one.units) for name, one in form.items()}


def test_conditional_attributes_appear_under_their_condition(page, lab):
    lab.edit("run/run.toml", ("[thickness]", "[thickness]\nsmoothing = 3"))
    lab.frames(1)[2].write_bytes(b"")
    erlif.process(lab.run, output=lab.film, skip_bad_frames=True).close()
    with h5netcdf.File(lab.film) as file:
        assert set(file.attrs) == {one.name for one in page.FILM_ATTRIBUTES}
        assert set(file.groups["frames"].attrs) == {one.name for one in page.FRAMES_ATTRIBUTES}


def test_the_documented_columns_of_the_log_are_read_with_their_units(page, tmp_path):
    path = tmp_path / "encoder.csv"
    names = [name for name, *_ in page.ENCODER]
    path.write_text(",".join(names) + "\n" + ",".join("1" for _ in names) + "\n")
    log = read_encoder_log(path)
    assert "number" in log
    units = sorted(log[name].attrs["units"].replace("_", " ") for name in log if name != "number")
    assert units == sorted(unit for _, unit, *_ in page.ENCODER if unit)


@pytest.mark.parametrize(
    "left_out", [(), ("y_mm",), ("uncertainty_um",), ("y_mm", "uncertainty_um")]
)
def test_the_documented_columns_of_the_profile_are_read(page, tmp_path, left_out):
    names = [name for name, *_ in page.PROFILE if name not in left_out]
    assert all(need == "optional" for name, _, need, _ in page.PROFILE if name in left_out)
    path = tmp_path / "profile.csv"
    rows = [",".join(str(1 + (k * (n + 1)) % 7) for n in range(len(names))) for k in range(12)]
    rows = [f"{k},{row.partition(',')[2]}" for k, row in enumerate(rows)]
    path.write_text("\n".join([",".join(names), *rows]))
    profile = read_profile(path)
    assert (profile.uncertainty is None) == ("uncertainty_um" in left_out)
    assert (profile.position.ndim == 1) == ("y_mm" in left_out)
