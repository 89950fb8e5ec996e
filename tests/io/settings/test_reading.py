"""run.toml and fixture.toml, read and checked."""

import contextlib
import math
import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from erlif.core.errors import ConfigError
from erlif.io.settings import RunSettings, read_fixture_settings, read_run_settings
from erlif.io.settings.reading import find_faults


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


def test_a_fault_is_refused_with_its_place(lab):
    path, missed = lab.run / "run.toml", []
    whole = path.read_text()
    rows = tomllib.loads(Path(__file__).with_name("faults.toml").read_text(encoding="utf-8"))
    for line, *words in rows["prediction"]:
        rows["faults"].append(["[run]", f"[prediction]\n{line}\n[run]", *words])
    for old, new, *words in rows["faults"]:
        assert old in whole
        path.write_text(whole.replace(old, new, 1))
        with pytest.raises(ConfigError) as refusal:
            read_run_settings(lab.run)
        missed += [(new, one) for one in words if one not in str(refusal.value)]
    assert not missed


def test_a_pair_that_is_none_is_asked_for_in_words(lab):
    lab.edit("fixture/fixture.toml", ("origin = [", 'origin = "0; 48" # ['))
    with pytest.raises(ConfigError, match=r"origin: expected a pair of numbers.*, got '0; 48'"):
        read_fixture_settings(lab.fixture)


def test_the_mark_that_windows_puts_before_utf_8_is_no_fault(lab):
    path = lab.run / "run.toml"
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
    assert read_run_settings(lab.run).name == "virtual straight bushing"


@settings(max_examples=60)
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


def test_gaps_and_faults_come_in_one_message(lab):
    edited(
        lab,
        *(('"5.5 cm"', '"?? cm"'), ('"encoder.csv"', '"??"')),
        *(('"114 rpm"', '"1 Hz"'), ("bit_depth = 12", "bit_depth = 99")),
    )
    with pytest.raises(ConfigError) as refusal:
        read_run_settings(lab.run)
    lines = str(refusal.value).splitlines()
    assert "2 gaps are left" in lines[0]
    places = ["[encoder] file", "[mechanism] crank:", "correct these"]
    places += ["[camera1] bit_depth", "[mechanism] crank_speed"]
    for line, place in zip(lines[1:], places, strict=True):
        assert place in line


def test_faults_have_the_place_of_their_key_and_gaps_are_none(small_rig):
    values = tomllib.loads((small_rig.run / "run.toml").read_text())
    assert find_faults(values, RunSettings) == []
    values["optics"]["pixel_pitch"], values["camera1"]["band"] = "75 V", "?? nm"
    values["joint"]["pin"]["poissons_ratio"] = 3.0
    values["mechanism"]["crank"] = "5 s"
    places = [fault.place for fault in find_faults(values, RunSettings)]
    assert places == [
        ("optics", "pixel_pitch"),
        ("mechanism", "crank"),
        ("joint", "pin", "poissons_ratio"),
    ]
