"""The lock plate: published numbers and choices."""

import math
from dataclasses import replace

import pytest

from erlif.joint.sizing import example_joint, walk_guide
from erlif.joint.sizing.lock import size_lock


def with_lock(**changes):
    joint = example_joint()
    plate = replace(joint.lock.plate, yield_stress=600e6)
    given = {"thickness": 10e-3, "throat": 3e-3} | changes
    return replace(joint, lock=replace(joint.lock, plate=plate, **given))


def test_the_weld_of_the_gold_case():
    """100 kN, 80 mm, throat 3 mm, 600 MPa, safety 2: mean diameter 70.00501 mm, less a leg.

    The inner diameter of 65.76237 mm is above the 65.515 mm for which there is room.
    """
    joint = with_lock(weld="internal", weld_diameter=65.76237e-3)
    walk = walk_guide(joint)
    assert walk.step("weld").margin == pytest.approx(0, abs=1e-6)
    assert walk.step("weld_room").allowed[1] == pytest.approx(65.515, abs=1e-3)
    assert not walk.step("weld_room").holds


@pytest.mark.parametrize(("kind", "corner", "face"), [("external", 40, 42), ("internal", 44, 42)])
def test_the_throat_plane_carries_the_torque(kind, corner, face):
    """Legs of 4 mm between the radii of 40 and 44 mm; the plane ends in the middle of the face."""
    joint = with_lock(weld=kind, weld_diameter=80e-3, throat=4e-3 / math.sqrt(2))
    radius = (corner + face) / 2 * 1e-3
    force = 100e3 * 0.04 / radius
    length = math.hypot(face - corner, 2) * 1e-3
    stress = math.sqrt(3) * force / (2 * math.pi * radius * length)
    found = walk_guide(joint).step("weld").number("stress on the throat plane")
    assert found == pytest.approx(stress / 1e6, rel=1e-9)


@pytest.mark.parametrize(
    ("kind", "height"), [("open", 24.83743e-3), ("closed", 20.6043e-3)], ids=["eq. 18", "eq. 20"]
)
def test_prongs_of_the_gold_case(kind, height):
    """10 kN, 10 mm, 30 mm, 300 MPa allowed.

    Closed, by hand: h^2 = (s + sqrt(s^2 + 4 a b^2)) / 2a with b = 6 x 11/16 x 30e3 = 123,750,
    s = 3 x (27/32 x 1000)^2 = 2,135,742 and a = 300^2; as printed, with F/2 in shear, 20.413 mm.
    """
    joint = with_lock(kind=kind, height=None, end_width=None, lever=0.4)
    sized = size_lock(joint, joint.lock)
    assert sized.height == pytest.approx(height, rel=1e-5)
    walk = walk_guide(replace(joint, lock=sized))
    assert walk.step("prong").number("lock force") == pytest.approx(10.0)
    assert walk.step("prong").margin == pytest.approx(0, abs=1e-9)
    if kind == "closed":
        assert walk.step("lock_end").margin == pytest.approx(0, abs=1e-9)
        assert sized.end_width == pytest.approx(5 / 32 * 10e3 / (300e6 * 10e-3))


def test_the_weld_is_internal_where_there_is_room_and_grows_where_it_must():
    inside = replace(with_lock(weld=None, throat=None, weld_diameter=None), force=90e3)
    chosen = size_lock(inside, inside.lock)
    assert (chosen.weld, chosen.throat) == ("internal", 3e-3)

    outside = replace(inside, force=400e3)
    chosen = size_lock(outside, outside.lock)
    assert (chosen.weld, chosen.weld_diameter) == ("external", 0.08)
    assert chosen.throat > 3e-3
    assert walk_guide(replace(outside, lock=chosen)).step("weld").margin == pytest.approx(
        0, abs=1e-9
    )


def test_a_screw_is_sized_where_its_strength_is_known():
    joint = with_lock(screw_yield=640e6)
    chosen = size_lock(joint, joint.lock)
    walk = walk_guide(replace(joint, lock=chosen))
    assert walk.step("lock_screw").margin == pytest.approx(0, abs=1e-9)
    assert walk_guide(with_lock()).step("lock_screw").state == "result"


def test_a_lock_without_load_has_the_size_of_its_plate():
    """As much friction in the seats as in the bushing."""
    joint = with_lock(
        kind="closed", height=None, end_width=None, screw_yield=640e6, friction_seat=1.0
    )
    chosen = size_lock(joint, joint.lock)
    assert chosen.screw_diameter == chosen.height == chosen.end_width == 10e-3
    assert walk_guide(replace(joint, lock=chosen)).step("lock_screw").margin == math.inf


def test_a_joint_without_lock_has_no_steps_of_it():
    keys = {step.key for step in walk_guide(replace(example_joint(), lock=None)).steps}
    assert not keys & {"lock_screw", "weld", "prong", "plate"}
