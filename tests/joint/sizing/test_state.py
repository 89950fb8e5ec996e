"""What follows from a joint with all dimensions."""

import numpy as np
from scenes.joints import altered

from erlif.joint.sizing import JointState


def test_what_is_not_known_stays_unknown():
    state = JointState(altered(pin={"youngs_modulus": None, "conductivity": None}))
    assert state.contact is None
    assert np.isnan([state.heat, state.rise, state.growth_loss]).all()
    assert np.isnan(state.pressure_over_arc(np.zeros(3))).all()
    assert state.heat_is_shared
