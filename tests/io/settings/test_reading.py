"""run.toml and fixture.toml, read and checked."""

import contextlib
import math
import os
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.core.errors import ConfigError
from erlif.io.settings import (
    RunSettings,
    read_fixture_settings,
    read_run_settings,
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


def test_a_key_left_out_has_the_documented_default(lab):
    edited(lab, ("bit_depth = 12\n", ""), ("[thickness]\nroi", "# roi"), ('x_axis = "sliding"', ""))
    settings = read_run_settings(lab.run)
    assert settings.camera1.bit_depth == 12
    assert settings.thickness.roi is None
    assert settings.thickness.least_signal == 100
    assert settings.registration.window == 32
    assert settings.optics.x_axis == "sliding"


CRANK, KIND, DEPTH = 'crank = "5.5 cm"', 'kind = "crank-rocker"', "bit_depth = 12"
DARK, FILES = 'dark = "camera1_dark.tif"', 'files = "camera1/*.tif"'
POISSON = "poissons_ratio = 0.37"

FAULTS = [
    # what is replaced in run.toml, by what, and words of the message
    (CRANK, "crank = 5.5", "[mechanism] crank", "with a unit in quotes"),
    (CRANK, 'crank = "5,5 cm"', "[mechanism] crank", "decimal point"),
    (CRANK, 'crank = "-5.5 cm"', "[mechanism] crank", "greater than 0", "'-5.5 cm'"),
    (CRANK, 'crnk = "5.5 cm"', "[mechanism] crank: missing", "crnk: unknown key; did you mean"),
    (CRANK, 'crank = "5.5 cm', "valid TOML", "line 36"),
    ('"114 rpm"', '"1 Hz"', "[mechanism] crank_speed", "rpm, rad/s, deg/s, rev/s"),
    (KIND, 'kind = "four-bar"', "[mechanism] kind", "crank-rocker", "slider-crank", "four-bar"),
    (KIND, "", "[mechanism] kind", "crank-rocker", "slider-crank"),
    (KIND, 'kind = "slider-crank"', "[mechanism] rocker: unknown key"),
    ('"222.411 N"', '"50 lb"', "[joint] load", "lbf"),
    (POISSON, "poissons_ratio = 0.6", "[joint.pin] poissons_ratio", "0.5", "0.6"),
    (POISSON, "poissons_ratio = nan", "[joint.pin] poissons_ratio", "finite"),
    ('"33.36 mm"', '"34 mm"', "joint", "smaller than bushing_radius", "34 mm in 33.59 mm"),
    (DEPTH, "bit_depth = 12.5", "[camera1] bit_depth", "integer", "12.5"),
    (DEPTH, "bit_depth = 24", "[camera1] bit_depth", "16", "24"),
    (DEPTH, "bit_dept = 12", "[camera1] bit_dept: unknown key; did you mean 'bit_depth'?"),
    (DEPTH, 'part = "middle"', "[camera1] part", "channel 2", "middle"),
    (DARK, "", "camera1", "offset"),
    (DARK, 'dark = "a.tif"\noffset = "64 DN"', "camera1", "not both"),
    (DARK, 'dark = "camera1/*.tif"', "dark and files name the same frames", "dark_dataset"),
    (FILES, 'files = ""', "[camera1] files", "file name"),
    (FILES, r'files = "a\u0000b"', "[camera1] files", "control characters"),
    ("[oil]", "[oli]", "oli: unknown key; did you mean 'oil'?"),
    ("[optics]", "[qqq]", "[optics]: missing table", "qqq: unknown key; known here: calibration"),
    ('x_axis = "sliding"', 'x_axis = "up"', "[optics] x_axis", "sliding", "axial", "'up'"),
    ('mounted_on = "rocker"', 'mounted_on = "frame"', "[encoder] mounted_on", "coupler"),
    ('viscosity = "0.12 Pa s"', "", "oil", "vogel"),
    ('name = "80W-90"', "name = 90", "[oil] name", "string", "90"),
    ("roi = {", "roi = { z = 3,", "[thickness.roi] z: unknown key; known here: x, y"),
    ("x = [4, 15]", "x = [15, 4]", "[thickness] roi", "low < high", "[15, 4]"),
    ("[run]", "run = 3\n[ignored]", "run: expected a table, got 3"),
]

PREDICTION = [
    ('sideways = "held"', 'expected "free", "guided" or a stiff'),
    ('sideways = "-5 N/m"', "[prediction] sideways", "above 0"),
    ('start_film = "5"', "[prediction] start_film", '"5 mm"'),
    ('cavitation_pressure = "20 kPa"', "[prediction] cavitation_pressure", "or equal to 0"),
]


def test_a_fault_is_refused_with_its_place(lab):
    path, missed = lab.run / "run.toml", []
    whole = path.read_text()
    added = [("[run]", f"[prediction]\n{line}\n[run]", *words) for line, *words in PREDICTION]
    for old, new, *words in FAULTS + added:
        assert old in whole
        path.write_text(whole.replace(old, new, 1))
        with pytest.raises(ConfigError) as refusal:
            read_run_settings(lab.run)
        missed += [(new, one) for one in words if one not in str(refusal.value)]
    assert not missed


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
        ("fixture", "use the command for that"),
    ],
)
def test_a_directory_without_run_toml_is_refused(lab, directory, expected):
    with pytest.raises(ConfigError, match=expected):
        read_run_settings(lab.directory / directory)


def test_a_run_is_no_fixture(lab):
    with pytest.raises(ConfigError, match="use the command for that"):
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


@settings(deadline=None, database=None, max_examples=60)
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


# gaps that erlif init has left


def test_gaps_are_listed_all_at_once_with_unit_and_meaning(lab):
    edited(lab, ('"5.5 cm"', '"?? cm"'), ('"encoder.csv"', '"??"'), ('"2.7 GPa"', '"?? GPa"'))
    with pytest.raises(ConfigError) as refusal:
        read_run_settings(lab.run)
    first, *lines = str(refusal.value).splitlines()
    assert "3 gaps are left" in first
    assert lines == [
        '  [encoder] file: file name or pattern, for example "encoder.csv". '
        "Encoder log: one row for each frame pair, or a column of times.",
        '  [mechanism] crank: length, for example "5.5 cm". '
        "Length of the crank, from pivot to pivot.",
        '  [joint.pin] youngs_modulus: pressure, for example "2.7 GPa". Young\'s modulus.',
    ]


def test_faults_are_listed_after_the_gaps(lab):
    edited(lab, ('"5.5 cm"', '"?? cm"'), ('"114 rpm"', '"1 Hz"'))
    with pytest.raises(ConfigError) as refusal:
        read_run_settings(lab.run)
    lines = str(refusal.value).splitlines()
    assert "1 gap is left" in lines[0]
    assert lines[2] == "and correct these:"
    assert "[mechanism] crank_speed" in lines[3]
    assert len(lines) == 4


def test_a_pattern_with_question_marks_is_not_a_gap(lab):
    edited(lab, ('"camera1/*.tif"', '"camera1/frame_00??.tif"'))
    assert read_run_settings(lab.run).camera1.files == "camera1/frame_00??.tif"


@pytest.mark.parametrize(("name", "option"), [("run.toml", ""), ("fixture.toml", " --fixture")])
def test_a_directory_without_settings_is_refused_with_the_command_that_makes_them(
    tmp_path, name, option
):
    read = {"run.toml": read_run_settings, "fixture.toml": read_fixture_settings}[name]
    with pytest.raises(ConfigError) as refusal:
        read(tmp_path)
    assert str(refusal.value).endswith(f"erlif init {tmp_path}{option}")


@pytest.mark.parametrize("kind", ["pipe", "device", "large"])
def test_settings_without_an_end_are_refused_at_once(tmp_path, kind):
    path = tmp_path / "run.toml"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    else:
        path.write_text("# " + "a" * 2**20)
    start = time.monotonic()
    with pytest.raises(ConfigError, match=r"it is a|it holds") as caught:
        read_run_settings(tmp_path)
    assert "erlif init" in str(caught.value)
    assert time.monotonic() - start < 1
