"""The joint and its dimensions."""

import pytest
from scenes.joints import altered

from erlif.core.errors import ModelError
from erlif.joint.sizing import assess_joint


def test_a_dimension_that_is_not_known_is_named():
    with pytest.raises(ModelError, match="wall must be known"):
        assess_joint(altered(wall=None))
