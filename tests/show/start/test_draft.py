"""Settings that are drafted, changed and undone: the files are what a user reads."""

import codecs
import shutil
import tomllib

import pytest

from erlif.core.errors import ConfigError
from erlif.io.settings import read_fixture_settings, read_run_settings
from erlif.show.start.draft import Draft


@pytest.fixture
def draft(lab):
    """The settings that the rig wrote, open."""
    made = Draft()
    made.open("fixture", lab.fixture)
    made.open("run", lab.run)
    return made


def field(draft, name, place):
    (found,) = [one for one in draft.fields(name) if one["place"] == place]
    return found


def test_settings_that_are_there_are_not_touched(lab, draft):
    before = (lab.run / "run.toml").read_bytes()
    assert draft.changes == []
    assert (lab.run / "run.toml").read_bytes() == before
    draft.link()  # a calibration is named already
    assert draft.changes == []


def test_settings_are_drafted_where_there_are_none_and_drafting_is_undone(lab):
    (lab.run / "run.toml").unlink()
    draft = Draft()
    draft.open("fixture", lab.fixture)
    draft.open("run", lab.run, kind="static")
    values = draft.values("run")
    assert "mechanism" not in values
    assert values["calibration"] == "../fixture/calibration.nc"
    assert field(draft, "run", "camera1.band")["gap"]
    assert draft.notes["run"]
    draft.undo()
    assert "run" not in draft.directories
    assert not list(lab.run.glob("*.toml"))
    assert not list(lab.run.glob("*.schema.json"))


def test_undoing_a_draft_leaves_another_run_open(lab, tmp_path):
    shutil.copytree(lab.run, tmp_path / "other")
    (lab.run / "run.toml").unlink()
    draft = Draft()
    draft.open("run", lab.run, kind="static")
    draft.open("run", tmp_path / "other")
    draft.undo()
    assert draft.directories["run"] == tmp_path / "other"
    assert not (lab.run / "run.toml").exists()


def test_a_fixture_elsewhere_is_named_as_the_calibration(lab, draft, tmp_path):
    (lab.run / "run.toml").write_text("[run]\nname = 'a'\n")
    far = tmp_path / "far" / "away" / "april"
    lab.fixture.rename(far.parent.mkdir(parents=True) or far)
    draft.open("fixture", far)
    draft.link()
    assert draft.values("run")["calibration"] == "../../far/away/april/calibration.nc"


def test_a_typed_value_is_written_with_its_unit_and_undone_to_the_byte(lab, draft):
    before = (lab.run / "run.toml").read_bytes()
    typed = {
        "optics.pixel_pitch": ("80", "80 um"),
        "mechanism.crank": ("0.06 m", "0.06 m"),
        "camera1.bit_depth": ("14", 14),
        "joint.pin.poissons_ratio": ("0.3", 0.3),
        "thickness.roi": ({"x": [1, 2], "y": [1.5, 3]}, {"x": [1, 2], "y": [1.5, 3]}),
        "registration.reuse": ("true", True),
        "run.name": ("[x] <b>", "[x] <b>"),
    }
    for place, (text, value) in typed.items():
        draft.change("run", {place: text})
        part = tomllib.loads((lab.run / "run.toml").read_text())
        for name in place.split("."):
            part = part[name]
        assert part == value
    assert read_run_settings(lab.run).optics.pixel_pitch == pytest.approx(80e-6)
    for _ in typed:
        draft.undo()
    assert (lab.run / "run.toml").read_bytes() == before
    with pytest.raises(ConfigError, match="there is none"):
        draft.undo()


def test_a_byte_order_mark_stays(lab):
    path = lab.run / "run.toml"
    before = codecs.BOM_UTF8 + path.read_bytes().replace(b"\n", b"\r\n")
    path.write_bytes(before)
    draft = Draft()
    draft.open("run", lab.run)
    draft.change("run", {"optics.pixel_pitch": "80"})
    assert path.read_bytes() == before.replace(b'"150 um"', b'"80 um"')
    draft.undo()
    assert path.read_bytes() == before


@pytest.mark.parametrize("head", [codecs.BOM_UTF8, b"# caf\xe9, in another encoding\n"])
def test_a_file_that_was_drafted_anew_is_restored_by_undo(lab, head):
    path = lab.run / "run.toml"
    path.write_bytes(before := head + path.read_bytes())
    draft = Draft()
    draft.open("run", lab.run, kind="static", anew=True)
    assert path.read_bytes() != before
    draft.undo()
    assert path.read_bytes() == before


def test_files_of_a_change_are_removed_with_it_unless_they_were_changed(lab, draft):
    masks = [lab.run / "mask_1.png", lab.run / "mask_2.png"]
    for mask in masks:
        mask.write_bytes(b"white under strokes")
        draft.change("run", {"thickness.exclude": [mask.name]}, made=[mask])
    masks[0].write_bytes(b"white under strokes, and edited")
    draft.undo()
    draft.undo()
    assert [mask.exists() for mask in masks] == [True, False]


def test_a_value_that_cannot_be_used_is_refused_and_nothing_is_written(lab, draft):
    before = (lab.run / "run.toml").read_bytes()
    for place, text, reason in (
        ("optics.pixel_pitch", "75 V", "75 V"),
        ("optics.x_axis", "across", "sliding"),
        ("camera1.bit_depth", "twelve", "integer"),
        ("joint.pin.poissons_ratio", "0.6", "0.5"),
        ("thickness.roi.x", "[3, one]", "thickness.roi"),
        ("no.such", "1", "Expected a key"),
        ("no.such", [1], "Expected a key"),
        ("thickness", "1", "Expected a key"),
    ):
        with pytest.raises(ConfigError, match=reason):
            draft.change("run", {place: text})
    assert (lab.run / "run.toml").read_bytes() == before
    assert draft.changes == []


def test_a_contradiction_between_keys_is_listed_and_may_be_resolved(lab, draft):
    draft.change("run", {"camera1.offset": "64"})  # beside dark frames
    assert any("not both" in fault.text for fault in draft.faults("run", draft.values("run")))
    draft.change("run", {"camera1.dark": ""})
    assert draft.faults("run", draft.values("run")) == []


def test_a_required_value_that_is_emptied_is_asked_for_again(draft):
    draft.change("run", {"optics.pixel_pitch": ""})
    asked = field(draft, "run", "optics.pixel_pitch")
    assert (asked["gap"], asked["asked"], asked["unit"]) == (True, True, "um")
    assert asked["other"] == field(draft, "fixture", "optics.pixel_pitch")["value"]


def test_a_file_that_somebody_else_has_changed_keeps_that(lab, draft):
    draft.change("fixture", {"fixture.name": "may"})
    path = lab.fixture / "fixture.toml"
    path.write_text(path.read_text().replace('"may"', '"june"'))
    with pytest.raises(ConfigError, match="changed elsewhere"):
        draft.undo()
    draft.change("fixture", {"camera1.band": "570"})
    settings = read_fixture_settings(lab.fixture)
    assert settings.name == "june"
    assert settings.camera1.band == 570
    assert "june" not in draft.changes[-1].change.lines  # of what this change does alone


def test_keys_of_the_mechanism_are_those_of_its_kind(lab):
    (lab.run / "run.toml").unlink()
    draft = Draft()
    draft.open("run", lab.run, kind="rotation")
    places = {one["place"] for one in draft.fields("run")}
    assert "mechanism.radius" in places
    assert "mechanism.crank" not in places


def test_cameras_that_were_taken_for_each_other_are_exchanged(lab, draft):
    draft.change("run", {"camera1.gain": "4 electron/DN", "camera2.gain": ""})
    before = draft.values("run")
    draft.exchange("run")
    after = draft.values("run")
    assert after["camera1"] == before["camera2"]
    assert after["camera2"] == before["camera1"]
    assert len(draft.changes) == 2
    draft.undo()
    assert draft.values("run") == before
