"""Settings written as TOML read back to the same settings."""

import pickle
import string
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.io.settings import (
    FixtureSettings,
    OpticsSettings,
    RunSettings,
    read_run_settings,
    to_toml,
)
from erlif.io.settings.toml import toml_value

text = st.text(st.characters(blacklist_categories=["Cs", "Cc"]), max_size=12) | st.sampled_from(
    ["a'b\"c\\d", "µm [x] # = {}"]
)
name = text.filter(bool)


def number(low, high):
    return st.floats(low, high, exclude_min=True)


def quantity(unit, low=1e-9, high=1e12):
    return number(low, high).map(lambda value: f"{value!r} {unit}")


def optional(**keys):
    return st.fixed_dictionaries({}, optional=keys)


def table(required, **keys):
    return st.fixed_dictionaries(required, optional=keys)


cameras = st.one_of(
    table(
        {"files": name, "band": quantity("nm", 200, 2000), level: value},
        bit_depth=st.integers(8, 16),
        flat=name,
        gain=quantity("electron/DN"),
        read_noise=quantity("electron"),
        alignment=st.sampled_from(["left", "right"]),
        part=st.sampled_from(["top", "odd", "channel 2"]),
        dataset=name,
    ).filter(lambda camera: camera["files"] not in (camera.get("dark"), camera.get("flat")))
    for level, value in (("dark", name), ("offset", quantity("DN")))
)
materials = table(
    {"youngs_modulus": quantity("GPa", high=1e3), "poissons_ratio": number(-1, 0.5)},
    roughness=quantity("um", high=1e3),
)
joints = table(
    {
        "pin_radius": quantity("mm", 1, 10),
        "bushing_radius": quantity("mm", 11, 20),
        "length": quantity("mm"),
        "pin": materials,
        "bushing": materials,
    },
    load=quantity("lbf"),
)
vogel = st.fixed_dictionaries(
    {"a": quantity("mPa s"), "b": quantity("K"), "c": quantity("degC", -273, 100)}
)
oils = st.one_of(
    table({law: value, "pressure_viscosity": quantity("1/GPa")}, name=text)
    for law, value in (("viscosity", quantity("Pa s")), ("vogel", vogel))
)
links = {key: quantity("cm") for key in ("crank", "coupler", "rocker", "ground")}
mechanisms = st.fixed_dictionaries(
    {"kind": st.just("crank-rocker"), **links, "crank_speed": quantity("rpm")}
) | (
    st.fixed_dictionaries(
        {
            "kind": st.just("slider-crank"),
            "crank": links["crank"],
            "coupler": links["coupler"],
            "crank_speed": quantity("rad/s"),
        }
    )
)
interval = st.tuples(st.floats(-9, 1), st.floats(2, 99)).map(list)
shared = {
    "camera1": cameras,
    "camera2": cameras,
    "optics": table(
        {"pixel_pitch": quantity("um", 0.05, 5000)}, x_axis=st.sampled_from(["sliding", "axial"])
    ),
}
choices = {
    "registration": optional(
        window=st.integers(16, 256), model=st.sampled_from(["auto", "surface", "local"])
    ),
    "thickness": optional(
        roi=st.fixed_dictionaries({"x": interval, "y": interval}),
        least_signal=quantity("electron"),
        no_film_below=number(0, 0.99),
    ),
}
runs = table(
    {
        "run": st.fixed_dictionaries({"name": text}),
        **shared,
        "encoder": table(
            {"file": name},
            mounted_on=st.sampled_from(["rocker", "crank"]),
            zero=quantity("deg", -360, 360),
            triggers_per_cycle=st.integers(2, 9999),
        ),
        "mechanism": mechanisms,
        "joint": joints,
        "oil": oils,
    },
    calibration=name,
    prediction=optional(
        sideways=st.sampled_from(["free", "guided", "12 N/mm"]),
        start_film=st.sampled_from(["fit", "20 um"]),
        load_line=quantity("mm", -9, 99),
        cavitation_pressure=quantity("kPa", -101, 0),
        long=st.booleans(),
    ),
    **choices,
)
fixtures = table(
    {
        "fixture": table(
            {"name": text, "profile": name},
            origin=st.tuples(st.floats(-99, 99), st.floats(-99, 99)).map(list),
            direction=quantity("deg", -360, 360),
            align=st.booleans(),
        ),
        **shared,
    },
    **choices,
)


@settings(deadline=None, database=None, max_examples=60)
@given(runs)
def test_run_settings_written_as_toml_read_back_the_same(raw):
    written = RunSettings.model_validate(raw)
    assert RunSettings.model_validate(tomllib.loads(to_toml(written))) == written


@settings(deadline=None, database=None, max_examples=40)
@given(fixtures)
def test_fixture_settings_written_as_toml_read_back_the_same(raw):
    written = FixtureSettings.model_validate(raw)
    assert FixtureSettings.model_validate(tomllib.loads(to_toml(written))) == written


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


def test_every_printable_character_survives_the_way_through_toml(small_rig):
    settings = read_run_settings(small_rig.run)
    renamed = settings.model_copy(
        update={"run": settings.run.model_copy(update={"name": string.printable[:95]})}
    )
    assert tomllib.loads(to_toml(renamed))["run"]["name"] == string.printable[:95]


@pytest.mark.parametrize(
    "value", [True, 3, 0.1, 1e-9, 'a "quoted" text', [1.5, 2.0], {"a": "1 K", "b": [1, 2]}]
)
def test_a_single_value_reads_back(value):
    assert tomllib.loads(f"value = {toml_value(value)}")["value"] == value
