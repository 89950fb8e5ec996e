"""What follows from a joint with all dimensions."""

from dataclasses import replace

import numpy as np
import pytest

from erlif.core.errors import ModelError
from erlif.joint.sizing import JointState, example_joint


def test_what_is_not_known_stays_unknown():
    joint = example_joint()
    pin = replace(joint.pin, youngs_modulus=None, conductivity=None)
    state = JointState(replace(joint, pin=pin))
    assert (state.contact, state.heat, state.rise, state.growth_loss) == (None,) * 4
    assert np.isnan(state.pressure_over_arc(np.zeros(3))).all()
    assert state.heat_is_shared


def test_all_dimensions_are_needed():
    with pytest.raises(ModelError, match="wall must be known"):
        JointState(replace(example_joint(), wall=None))
