"""A finished design."""

from erlif.pipeline.design import example_design


def test_a_design_is_as_sound_as_its_steps():
    designed = example_design()
    assert designed.sound == designed.walk.sound
    assert designed.joint is designed.walk.joint
