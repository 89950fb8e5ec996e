"""endurance.toml."""

import pytest

from erlif.core.errors import ConfigError
from erlif.joint.settings import read_endurance_settings

TEXT = """
[columns]
cells = ["Zelle A", "Zelle B"]
arm_force = "Stange"
[units]
cells = "kN"
[machine]
pin_radius = "33.36 mm"
arm = "30 cm"
[designs]
uncut = ["uncut_*.csv"]
undercut = ["undercut_1.csv", "undercut_2.csv"]
"""


def test_tables_are_read_in_si_units(tmp_path):
    path = tmp_path / "endurance.toml"
    path.write_text(TEXT, encoding="utf-8")
    settings = read_endurance_settings(path)
    assert settings.machine.pin_radius == pytest.approx(0.03336)
    assert settings.machine.arm == pytest.approx(0.3)
    assert settings.columns.cells == ("Zelle A", "Zelle B")
    assert settings.designs["undercut"] == ("undercut_1.csv", "undercut_2.csv")
    assert settings.galling.significance == 0.01


def test_what_cannot_be_used_is_named(tmp_path):
    path = tmp_path / "endurance.toml"
    path.write_text(TEXT.replace('"kN"', '"bar"'), encoding="utf-8")
    with pytest.raises(ConfigError, match="cells"):
        read_endurance_settings(path)
