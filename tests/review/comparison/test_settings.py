"""Settings that differ between runs."""

import xarray as xr

from erlif.io.files import write_dataset
from erlif.review.comparison import compare, describe_comparison


def test_settings_that_differ_are_listed_with_the_value_of_each_run(film, other, tmp_path):
    text = other.attrs["settings"].replace("50 lbf", "100 lbf").replace("-100000", "-99000")
    name = '[run]\nname = "example"\n'
    assert name in text
    later = text.replace(name, name.replace("example", "later"))
    later = later.replace("[camera1]", '[camera1]\nserial = "11"')
    found = compare([film, other.assign_attrs(settings=later)])

    expected = {
        "[joint] load": ['"50 lbf"', '"100 lbf"'],
        "[prediction] cavitation_pressure": ['"-100000 Pa"', '"-99000 Pa"'],
        "[camera1] serial": ["none", '"11"'],
    }
    listed = dict(zip(found.setting.values.tolist(), found.stated.values.tolist(), strict=True))
    assert {key: listed[key] for key in expected} == expected
    assert not any("name" in key for key in listed)
    assert '  [joint] load: example "50 lbf", later "100 lbf"' in describe_comparison(found)

    write_dataset(found, tmp_path / "compare.nc")
    with xr.open_dataset(tmp_path / "compare.nc") as kept:
        assert kept.stated.sel(setting="[joint] load").values.tolist() == ['"50 lbf"', '"100 lbf"']


def test_runs_of_the_same_settings_list_none(film, other):
    found = compare([film, other.assign_attrs(settings=film.attrs["settings"])])
    assert "stated" not in found
    assert not any("settings" in line for line in describe_comparison(found))
