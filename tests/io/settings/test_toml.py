"""Settings written as TOML read back to the same settings."""

import pickle
import string
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.io.settings import FixtureProfile, OpticsSettings, read_run_settings, to_toml
from erlif.io.settings.toml import toml_value

TEXT = st.text(st.characters(blacklist_categories=["Cs", "Cc"]), max_size=12) | st.sampled_from(
    ["a'b\"c\\d", "µm [x] # = {}", string.printable[:95]]
)
ORIGIN = st.tuples(st.floats(-99, 99), st.floats(-99, 99)).map(list)


@settings(max_examples=60)
@given(name=TEXT, profile=TEXT.filter(bool), turn=st.floats(-360, 360), origin=ORIGIN)
def test_texts_and_numbers_written_as_toml_read_back_the_same(name, profile, turn, origin):
    """Every key of a file, by its example: test_template."""
    written = FixtureProfile(name=name, profile=profile, direction=f"{turn!r} deg", origin=origin)
    assert FixtureProfile.model_validate(tomllib.loads(to_toml(written))) == written


@pytest.mark.parametrize("pitch", ["50 um", "1.92 mm", "0.05 mm", "5e-5 m"])
def test_quantities_stand_as_the_user_wrote_them(pitch):
    optics = OpticsSettings(pixel_pitch=pitch)
    line = f'pixel_pitch = "{pitch}"'
    assert line in to_toml(optics)
    assert line in to_toml(optics.model_copy(deep=True))
    assert line in to_toml(pickle.loads(pickle.dumps(optics)))


def test_quantity_without_a_text_is_the_shortest_decimal_in_its_unit(small_rig):
    settings = read_run_settings(small_rig.run)
    joint = settings.joint.model_copy(update={"load": 200.0})
    written = to_toml(settings.model_copy(update={"joint": joint}))
    assert 'load = "200 N"' in written
    assert 'least_signal = "100 electron"' in written


@pytest.mark.parametrize(
    "value", [True, 3, 0.1, 1e-9, 'a "quoted" text', [1.5, 2.0], {"a": "1 K", "b": [1, 2]}]
)
def test_a_single_value_reads_back(value):
    assert tomllib.loads(f"value = {toml_value(value)}")["value"] == value
