"""The lock plate: published numbers and choices."""

import math

import pytest
from scenes.joints import altered, assessed

from erlif.joint.sizing.lock import size_lock


def with_lock(*, force=100e3, **changes):
    lock = {"plate": {"yield_stress": 600e6}, "thickness": 10e-3, "throat": 3e-3, **changes}
    return altered(force=force, lock=lock)


@pytest.mark.parametrize(("kind", "corner", "face"), [("external", 40, 42), ("internal", 44, 42)])
def test_the_throat_plane_carries_the_torque(kind, corner, face):
    """Legs of 4 mm between the radii of 40 and 44 mm; the plane ends in the middle of the face."""
    joint = with_lock(weld=kind, weld_diameter=80e-3, throat=4e-3 / math.sqrt(2))
    radius = (corner + face) / 2 * 1e-3
    force = 100e3 * 0.04 / radius
    length = math.hypot(face - corner, 2) * 1e-3
    stress = math.sqrt(3) * force / (2 * math.pi * radius * length)
    on_plane = assessed(joint).step("weld").number("stress on the throat plane")
    assert on_plane == pytest.approx(stress / 1e6, rel=1e-9)


@pytest.mark.parametrize("kind", ["open", "closed"])
def test_chosen_prong_end_and_screw_are_just_enough(kind):
    joint = with_lock(kind=kind, height=None, end_width=None, lever=0.4, screw_yield=640e6)
    assessment = assessed(joint, lock=size_lock(joint, joint.lock))
    assert assessment.step("prong").number("lock force") == pytest.approx(10.0)
    for key in ("prong", "lock_screw", *(["lock_end"] if kind == "closed" else [])):
        assert assessment.step(key).margin == pytest.approx(0, abs=1e-9)


def test_the_weld_is_internal_where_there_is_room_and_grows_where_it_must():
    inside = with_lock(force=90e3, weld=None, throat=None, weld_diameter=None)
    chosen = size_lock(inside, inside.lock)
    assert (chosen.weld, chosen.throat) == ("internal", 3e-3)

    outside = altered(inside, force=400e3)
    chosen = size_lock(outside, outside.lock)
    assert (chosen.weld, chosen.weld_diameter) == ("external", 0.08)
    assert chosen.throat > 3e-3
    assert assessed(outside, lock=chosen).step("weld").margin == pytest.approx(0, abs=1e-9)


def test_a_lock_without_load_has_the_size_of_its_plate():
    """As much friction in the seats as in the bushing."""
    joint = with_lock(
        kind="closed", height=None, end_width=None, screw_yield=640e6, friction_seat=1.0
    )
    chosen = size_lock(joint, joint.lock)
    assert chosen.screw_diameter == chosen.height == chosen.end_width == 10e-3
    assert assessed(joint, lock=chosen).step("lock_screw").margin == math.inf
