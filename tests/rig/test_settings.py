"""Settings of the rig: derived quantities and refusals."""

import dataclasses
import math

import pytest

from erlif.core.errors import ModelError
from erlif.rig import RigSettings

IMPOSSIBLE = (
    {"width": 8},
    {"width": "320"},
    {"cycles": 0},
    {"light": 0.0},
    {"spacing": 0.0},
    {"crank": 30.0},
    {"crank": 27.0},
    {"pin_radius": 34.0},
    {"wedge": (5.0, 1.0)},
    {"scale": (2.0, 1.0)},
    {"rotation": -20.0},
    {"distortion": 11.0},
    {"flat_levels": ()},
    {"film_floor": 0.0},
    {"background": -0.01},
    {"background_beam": -0.01},
    {"reference": -1.0},
    {"background_pages": -1},
    {"bleaching": (0.0, 1.0)},
    {"sideways": "glued"},
    {"sideways": -1.0},
    {"film": "reynolds"},
    {"mechanism": "rotation", "log": "continuous"},
    {"mechanism": "slider-crank", "crank": 44.0},
    {"mechanism": "slider-crank", "pulses_per_cycle": 7.3},
    {"film": "reynolds", "tilt": 0.0, "mechanism": "rotation"},
    {"liner": (1.0, 1.4, 0.4)},
    {"rough": True},
    {"film": "reynolds", "tilt": 0.0, "liner": (1.0, 1.4, 0.5)},
    {"profile": (1.0,)},
    {"profile": (1.0, 2.0), "lobes": (0.0,)},
    {"film": "reynolds", "tilt": 0.0, "film_table": (1.0,) * 6},
    *({name: "other"} for name in ("film", "encoder", "reading", "log", "mechanism")),
    {"mechanism": "rotation", "pictures": 1000, "cycles": 10_000},
    {"viscosity": -1.0},
    {"elapsed": -1.0},
    {"cavitation_pressure": 20.0},
    {"pictures": 0},
    {"spacing": 1e-9},
    {"cycles": 10**9},
)


def test_a_rig_that_cannot_work_is_refused():
    for wrong in IMPOSSIBLE:
        with pytest.raises(ModelError):
            RigSettings(**wrong)


@pytest.mark.parametrize(("width", "height"), [(320, 256), (96, 80), (64, 200)])
def test_region_is_clear_of_the_edges_and_scales_with_the_picture(width, height):
    rig = RigSettings(width=width, height=height)
    (left, right), (top, bottom) = rig.region
    assert 0 < left < right < rig.field_width
    assert 0 < top < bottom < height * rig.pitch
    assert (right - left) / rig.field_width == pytest.approx(11 / 19.2, abs=1e-3)


NUMBERS = [
    field
    for field in dataclasses.fields(RigSettings)
    if isinstance(field.default, int | float | tuple) and not isinstance(field.default, bool)
]


def test_a_number_that_is_not_finite_is_refused_by_name():
    for field in NUMBERS:
        for wrong in (math.nan, math.inf, -math.inf):
            given = (wrong,) * len(field.default) if isinstance(field.default, tuple) else wrong
            with pytest.raises(ModelError, match=f"Expected {field.name} of the virtual rig"):
                RigSettings(**{field.name: given})
