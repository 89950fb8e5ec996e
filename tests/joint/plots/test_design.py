"""Figures of a design."""

import numpy as np
import pytest
from scenes.joints import designed, designed_without_motion
from scenes.pictures import picture, without_texts

from erlif.joint.plots import (
    design_figure,
    design_margins,
    design_margins_figure,
    design_pressure,
    design_pv,
    design_temperature,
    design_wear,
)
from erlif.joint.sizing.design import example_design


def test_bars_are_what_is_used_of_the_limits():
    steps = [
        step
        for step in example_design().assessment.steps
        if step.kind in ("limit", "recommendation") and step.margin == step.margin
    ]
    bars = design_margins(example_design())
    assert [bar.get_width() for bar in bars] == pytest.approx(
        [1 / (1 + step.margin) for step in steps]
    )


def test_the_pressure_has_its_peak_under_the_load():
    persson = design_pressure(example_design())[0]
    angle, pressure = persson.get_data()
    assert angle[np.argmax(pressure)] == 0
    assert pressure.max() == pytest.approx(
        example_design().assessment.step("pressure_peak").present
    )


def test_loads_that_are_alike_are_one_point():
    (point,) = design_pv(designed(('mean_force = "80 kN"', "")))
    assert point.get_label() == "largest and mean load"


def test_interference_and_large_play_are_drawn():
    for play in ("-200 um", "0 um", "3 mm"):
        lines = design_pressure(designed(('# play = "160 um"', f'play = "{play}"')))
        assert all(np.isfinite(line.get_ydata()).all() for line in lines)


def test_what_is_not_known_is_stated():
    still = designed_without_motion()
    for draw in (design_pv, design_temperature, design_wear):
        assert draw(still) == []
    assert len(design_figure(still).axes) == 4


def test_an_exceeded_limit_and_a_doubtful_one_look_different():
    bars = design_margins(designed(('# diameter = "80 mm"', 'diameter = "20 mm"')))
    assert len({bar.get_edgecolor() for bar in bars}) == 3
    fast = design_margins(designed(('"8 s"', '"0.5 s"')))
    assert any(bar.get_hatch() for bar in fast)
    assert len(design_margins_figure(example_design()).axes) == 1


@picture
def test_picture_of_a_design():
    return without_texts(design_figure(example_design()))
