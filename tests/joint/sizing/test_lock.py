"""The lock plate: published numbers and choices."""

import math

import pytest
from scenes.joints import altered, assessed

from erlif.joint.sizing.lock import size_lock


def with_lock(*, force=100e3, **changes):
    lock = {"plate": {"yield_stress": 600e6}, "thickness": 10e-3, "throat": 3e-3, **changes}
    return altered(force=force, lock=lock)


def test_the_weld_of_the_gold_case():
    """100 kN, 80 mm, throat 3 mm, 600 MPa, safety 2: mean diameter 70.00501 mm, less a leg.

    The inner diameter of 65.76237 mm is above the 65.515 mm for which there is room.
    """
    assessment = assessed(with_lock(weld="internal", weld_diameter=65.76237e-3))
    assert assessment.step("weld").margin == pytest.approx(0, abs=1e-6)
    assert assessment.step("weld_room").allowed[1] == pytest.approx(65.515, abs=1e-3)
    assert not assessment.step("weld_room").holds


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


@pytest.mark.parametrize(
    ("kind", "height"), [("open", 24.83743e-3), ("closed", 20.6043e-3)], ids=["eq. 18", "eq. 20"]
)
def test_prongs_of_the_gold_case(kind, height):
    """10 kN, 10 mm, 30 mm, 300 MPa allowed.

    Closed, by hand: h^2 = (s + sqrt(s^2 + 4 a b^2)) / 2a with b = 6 x 11/16 x 30e3 = 123,750,
    s = 3 x (27/32 x 1000)^2 = 2,135,742 and a = 300^2; as printed, with F/2 in shear, 20.413 mm.
    """
    joint = with_lock(kind=kind, height=None, end_width=None, lever=0.4, screw_yield=640e6)
    sized = size_lock(joint, joint.lock)
    assert sized.height == pytest.approx(height, rel=1e-5)
    assessment = assessed(joint, lock=sized)
    assert assessment.step("prong").number("lock force") == pytest.approx(10.0)
    for key in ("prong", "lock_screw", *(["lock_end"] if kind == "closed" else [])):
        assert assessment.step(key).margin == pytest.approx(0, abs=1e-9)
    if kind == "closed":
        assert sized.end_width == pytest.approx(5 / 32 * 10e3 / (300e6 * 10e-3))


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


def test_a_screw_of_unknown_strength_is_a_result_and_no_lock_has_no_steps():
    assert assessed(with_lock()).step("lock_screw").state == "result"
    keys = {step.key for step in assessed(lock=None).steps}
    assert not keys & {"lock_screw", "weld", "prong", "plate"}
