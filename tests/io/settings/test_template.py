"""Templates: valid TOML, every key commented, gaps where values are not known."""

import tomllib

import pytest

from erlif.io.settings import (
    GAP,
    FixtureSettings,
    RotationSettings,
    RunSettings,
    SinusoidalSettings,
    SliderCrankSettings,
    keys_of,
    tables_of,
    to_toml,
    write_template,
)

OTHER_FORMS = (SliderCrankSettings, RotationSettings, SinusoidalSettings)
"""Forms of [mechanism] after its first one."""

KINDS = pytest.mark.parametrize("kind", [RunSettings, FixtureSettings])


@KINDS
def test_without_any_value_all_required_keys_are_gaps(kind):
    raw = tomllib.loads(write_template(kind, {}, {}))
    seen = set()
    for table in tables_of(kind):
        if not table.required or table.title in seen:
            continue
        seen.add(table.title)
        part = raw
        for name in table.path:
            part = part[name]
        for key in keys_of(table.kind):
            if key.required and len(key.choices) != 1:
                assert part[key.name].startswith("??"), f"{table.title}.{key.name}"


@KINDS
def test_every_key_is_written_after_its_meaning(kind):
    lines = write_template(kind, {}, {}).splitlines()
    text = " ".join(line.lstrip("# ") for line in lines)
    for table in tables_of(kind):
        for key in keys_of(table.kind):
            written = table.required or len(table.path) == 1
            if written and table.kind not in OTHER_FORMS:
                assert key.meaning in text
                assert any(line.lstrip("# ").startswith(f"{key.name} = ") for line in lines)


def test_commented_keys_hold_values_that_the_reader_accepts():
    """With the gaps filled by examples and every comment of a key taken away, the file is valid;
    its settings, written as TOML, read back the same."""
    lines = []
    values = {"oil.viscosity": "0.12 Pa s"}
    text = write_template(RunSettings, values, {}, leave_out=["contact"])  # in place of [joint]
    for line in text.splitlines():
        if line.startswith("# ") and " = " in line and line.split()[1].isidentifier():
            line = line.removeprefix("# ")
        if not line.startswith(("offset", "vogel", "pulse", "bins")):  # in place of others
            lines.append(line)
    raw = tomllib.loads("\n".join(lines))
    for table in (one for one in tables_of(RunSettings) if one.path[:1] != ("contact",)):
        part = raw
        for name in table.path:
            part = part.setdefault(name, {}) if table.required else part.get(name, {})
        for key in keys_of(table.kind):
            if str(part.get(key.name, "")).startswith("??"):
                part[key.name] = key.example
    settings = RunSettings.model_validate(raw)
    assert RunSettings.model_validate(tomllib.loads(to_toml(settings))) == settings


def test_a_value_is_written_with_the_remark_about_it():
    text = write_template(RunSettings, {"camera1.bit_depth": 14}, {"camera1.bit_depth": "Seen."})
    place = text.index("bit_depth = 14")
    assert text[:place].endswith("# -> Seen.\n")


def test_an_optional_key_may_be_a_gap():
    raw = tomllib.loads(write_template(RunSettings, {"joint.load": GAP}, {}))
    assert raw["joint"]["load"] == "?? lbf"


def test_a_form_is_chosen_and_tables_are_left_out():
    text = write_template(
        RunSettings, {}, {}, forms={"mechanism": "rotation"}, leave_out=("joint", "contact", "oil")
    )
    raw = tomllib.loads(text)
    assert raw["mechanism"] == {"kind": "rotation", "radius": "?? mm"}
    assert "joint" not in raw
    assert "oil" not in raw
    assert "[joint" not in text


@pytest.mark.parametrize("full", [False, True])
def test_known_inner_tables_are_values_in_the_order_of_the_manual(full):
    liner = {"thickness": "1 mm", "youngs_modulus": "1.4 GPa", "poissons_ratio": 0.4}
    known = {"joint.liner": liner, "joint.bore": {"ovality": "2 um"}}
    joint = tomllib.loads(write_template(RunSettings, known, {}, full=full))["joint"]
    inner = [(name, joint[name]) for name in joint if f"joint.{name}" in known]
    assert inner == [("bore", {"ovality": "2 um"}), ("liner", liner)]
