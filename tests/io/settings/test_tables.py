"""Tables of run.toml that complete or exclude each other."""

import pytest
from scenes.film import run_settings

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}
BALL = {"body": STEEL | {"radius": "9 mm"}, "counterbody": STEEL}


def test_joint_and_contact_together_are_refused():
    with pytest.raises(ValueError, match="not both"):
        run_settings(contact=BALL)


def test_load_and_surfaces_are_those_of_the_joint_or_of_the_contact():
    joint = run_settings()
    assert joint.surfaces == (joint.joint.pin, joint.joint.bushing)
    disc = {"kind": "rotation", "radius": "20 mm", "speed": "60 rpm"}
    ball = run_settings(joint=None, mechanism=disc, contact=BALL | {"load": "20 N"})
    assert (ball.load, ball.surfaces) == (20.0, (ball.contact.body, ball.contact.counterbody))
    assert run_settings(joint=None, mechanism=disc).surfaces == ()
