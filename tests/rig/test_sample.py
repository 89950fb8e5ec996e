"""The sample run: the settings that a laboratory would have stated."""

from dataclasses import replace

from scenes.rig import SMALL

from erlif.io.settings import read_run_settings
from erlif.rig.sample import write_sample


def test_the_joint_is_acrylic_and_the_laboratory_states_its_widths(tmp_path):
    out = write_sample(tmp_path / "sample", rig=replace(SMALL, write_systematics=False))
    settings = read_run_settings(out / "run")
    assert settings.joint.pin.youngs_modulus == 2.7e9
    assert settings.systematics.background == 0.2  # %
    assert "0.05 %" in (out / "fixture" / "fixture.toml").read_text()
