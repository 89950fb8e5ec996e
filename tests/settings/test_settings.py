"""run.toml and fixture.toml as settings, and back."""

import contextlib
import math
import string
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.core.errors import ConfigError
from erlif.settings import (
    CameraSettings,
    FixtureSettings,
    RunSettings,
    read_fixture_settings,
    read_run_settings,
    to_toml,
)


def edited(lab, *changes):
    lab.edit("run/run.toml", *changes)
    return lab.run


def test_quantities_are_kept_in_si(small_rig):
    settings = read_run_settings(small_rig.run)
    assert settings.mechanism.crank == pytest.approx(0.055)
    assert settings.mechanism.crank_speed == pytest.approx(114 * 2 * math.pi / 60)
    assert settings.joint.pin_radius == pytest.approx(0.03336)
    assert settings.joint.pin.youngs_modulus == pytest.approx(2.7e9)
    assert settings.oil.pressure_viscosity == pytest.approx(20e-9)
    assert settings.optics.pixel_pitch == pytest.approx(19.2e-3 / 128)
    assert settings.camera1.band == 580
    assert settings.camera1.full_scale == 4095


def test_what_is_left_out_has_the_documented_default(lab):
    edited(lab, ("bit_depth = 12\n", ""), ("[thickness]\nroi", "# roi"), ('x_axis = "sliding"', ""))
    settings = read_run_settings(lab.run)
    assert settings.camera1.bit_depth == 12
    assert settings.thickness.roi is None
    assert settings.thickness.least_signal == 100
    assert settings.registration.window == 32
    assert settings.optics.x_axis == "sliding"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('crank = "5.5 cm"', "crank = 5.5", ["[mechanism] crank", "with a unit in quotes"]),
        ('crank = "5.5 cm"', 'crank = "5,5 cm"', ["[mechanism] crank", "decimal point"]),
        (
            'crank = "5.5 cm"',
            'crank = "-5.5 cm"',
            ["[mechanism] crank", "greater than 0", "'-5.5 cm'"],
        ),
        (
            'crank = "5.5 cm"',
            'crnk = "5.5 cm"',
            ["[mechanism] crank: missing", "crnk: unknown key; did you mean 'crank'?"],
        ),
        ('"114 rpm"', '"1 Hz"', ["[mechanism] crank_speed", "rpm, rad/s, deg/s, rev/s"]),
        ('"222.411 N"', '"50 lb"', ["[joint] load", "lbf"]),
        ("bit_depth = 12", "bit_depth = 12.5", ["[camera1] bit_depth", "integer", "12.5"]),
        ("bit_depth = 12", "bit_depth = 24", ["[camera1] bit_depth", "16", "24"]),
        (
            "bit_depth = 12",
            "bit_dept = 12",
            ["[camera1] bit_dept: unknown key; did you mean 'bit_depth'?"],
        ),
        ("[oil]", "[oli]", ["[oil]: missing table", "oli: unknown key; did you mean 'oil'?"]),
        (
            "[optics]",
            "[qqq]",
            ["[optics]: missing table", "qqq: unknown key; known here: calibration, run, camera1"],
        ),
        ("roi = {", "roi = { z = 3,", ["[thickness.roi] z: unknown key; known here: x, y"]),
        (
            'kind = "crank-rocker"',
            'kind = "four-bar"',
            ["[mechanism] kind", "crank-rocker", "slider-crank", "four-bar"],
        ),
        ('kind = "crank-rocker"', "", ["[mechanism] kind", "crank-rocker", "slider-crank"]),
        ('kind = "crank-rocker"', 'kind = "slider-crank"', ["[mechanism] rocker: unknown key"]),
        (
            'x_axis = "sliding"',
            'x_axis = "radial"',
            ["[optics] x_axis", "sliding", "axial", "radial"],
        ),
        (
            'mounted_on = "rocker"',
            'mounted_on = "coupler"',
            ["[encoder] mounted_on", "rocker", "crank", "coupler"],
        ),
        (
            "poissons_ratio = 0.37",
            "poissons_ratio = 0.6",
            ["[joint.pin] poissons_ratio", "0.5", "0.6"],
        ),
        ("poissons_ratio = 0.37", "poissons_ratio = nan", ["[joint.pin] poissons_ratio", "finite"]),
        ('"33.36 mm"', '"34 mm"', ["joint", "smaller than bushing_radius", "34 mm in 33.59 mm"]),
        ('dark = "camera1_dark.tif"', "", ["camera1", "offset"]),
        ('dark = "camera1_dark.tif"', 'dark = "a.tif"\noffset = "64 DN"', ["camera1", "not both"]),
        ('viscosity = "0.12 Pa s"', "", ["oil", "vogel"]),
        ('files = "camera1/*.tif"', 'files = ""', ["[camera1] files", "file name"]),
        (
            'files = "camera1/*.tif"',
            r'files = "a\u0000b"',
            ["[camera1] files", "control characters"],
        ),
        (
            "roi = { x = [4, 15]",
            "roi = { x = [15, 4]",
            ["[thickness] roi", "low < high", "[15, 4]"],
        ),
        ('name = "80W-90"', "name = 90", ["[oil] name", "string", "90"]),
        ("[run]", "run = 3\n[ignored]", ["run: expected a table, got 3"]),
        ('crank = "5.5 cm"', 'crank = "5.5 cm', ["valid TOML", "line 36"]),
    ],
)
def test_a_fault_is_refused_with_its_place(lab, old, new, expected):
    with pytest.raises(ConfigError) as refusal:
        read_run_settings(edited(lab, (old, new)))
    for words in expected:
        assert words in str(refusal.value)


def test_all_faults_come_in_one_message(lab):
    edited(lab, ('"5.5 cm"', "5.5"), ('"114 rpm"', '"1 Hz"'), ("bit_depth = 12", "bit_depth = 99"))
    with pytest.raises(ConfigError) as refusal:
        read_run_settings(lab.run)
    assert len(str(refusal.value).splitlines()) == 4


@pytest.mark.parametrize(
    ("directory", "expected"),
    [
        ("nowhere", "not a directory"),
        ("run/run.toml", "not a directory"),
        ("fixture", "meant for the other command"),
    ],
)
def test_a_directory_without_run_toml_is_refused(lab, directory, expected):
    with pytest.raises(ConfigError, match=expected):
        read_run_settings(lab.directory / directory)


def test_a_run_is_no_fixture(lab):
    with pytest.raises(ConfigError, match="is it meant for the other command"):
        read_fixture_settings(lab.run)


@pytest.mark.parametrize(
    "content",
    [b"\xff\xfe[\x00r\x00", b"\x00", b"[" * 4000, b"a = " + b"9" * 5000, b"a = 2020-99-99"],
)
def test_what_is_no_toml_is_refused(lab, content):
    (lab.run / "run.toml").write_bytes(content)
    with pytest.raises(ConfigError):
        read_run_settings(lab.run)


def test_the_mark_that_windows_puts_before_utf_8_is_no_fault(lab):
    path = lab.run / "run.toml"
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
    assert read_run_settings(lab.run).name == "virtual straight bushing"


@settings(deadline=None, database=None, max_examples=150)
@given(st.data())
def test_a_byte_changed_in_the_settings_is_read_or_refused(small_rig, tmp_path_factory, data):
    content = bytearray((small_rig.run / "run.toml").read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    directory = tmp_path_factory.getbasetemp() / "changed settings"
    directory.mkdir(exist_ok=True)
    (directory / "run.toml").write_bytes(content)
    with contextlib.suppress(ConfigError):
        assert isinstance(read_run_settings(directory), RunSettings)


# settings that are drawn, written and read back

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
        {"files": name, "band": quantity("nm"), level: value},
        bit_depth=st.integers(8, 16),
        flat=name,
        gain=quantity("electron/DN"),
        read_noise=quantity("electron"),
    )
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
    "optics": table({"pixel_pitch": quantity("um")}, x_axis=st.sampled_from(["sliding", "axial"])),
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


def test_settings_cannot_be_changed(small_rig):
    camera = read_run_settings(small_rig.run).camera1
    with pytest.raises(ValueError, match="frozen"):
        camera.bit_depth = 10
    assert set(CameraSettings.model_fields) >= {
        "files",
        "band",
        "bit_depth",
        "dark",
        "offset",
        "flat",
        "gain",
        "read_noise",
    }


def test_every_printable_character_survives_the_way_through_toml(small_rig):
    settings = read_run_settings(small_rig.run)
    renamed = settings.model_copy(
        update={"run": settings.run.model_copy(update={"name": string.printable[:95]})}
    )
    assert tomllib.loads(to_toml(renamed))["run"]["name"] == string.printable[:95]
