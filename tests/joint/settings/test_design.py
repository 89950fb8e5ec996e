"""joint.toml: units, defaults and messages."""

import tomllib
from pathlib import Path

import pytest

from erlif.core.errors import ConfigError
from erlif.joint.settings import DesignSettings, read_design_settings

FAULTS = tomllib.loads(Path(__file__).with_name("faults.toml").read_text(encoding="utf-8"))

SMALL = """\
[joint]
name = "test"
[load]
force = "10 tonne_force"
safety = 2.0
[pin]
material = "C45 QT"
[bushing]
material = "CuSn10Zn2"
"""


def read(tmp_path, text):
    path = tmp_path / "joint.toml"
    path.write_text(text, encoding="utf-8")
    return read_design_settings(path)


@pytest.mark.parametrize(
    ("text", "brinell"),
    [
        ("200 HB", 200),
        ("200 HBW", 200),
        ("200 HV", 190),
        ("1961.33 MPa", 200),
        ("1.96133 GPa", 200),
    ],
)
def test_hardness_in_all_its_units(text, brinell):
    """1 HB is 9.80665 MPa; Vickers after ISO 18265, 200 HV to 190 HB."""
    raw = tomllib.loads(SMALL.replace("10 tonne_force", "1 kN"))
    raw["bushing"]["hardness"] = text
    assert DesignSettings.model_validate(raw).bushing.hardness == pytest.approx(brinell, rel=1e-12)


def test_bad_values_are_named(tmp_path):
    for old, new, named in FAULTS["design"]:
        text = SMALL.replace(old, new).replace("10 tonne_force", "100 kN")
        with pytest.raises(ConfigError) as raised:
            read(tmp_path, text)
        assert named in str(raised.value)
