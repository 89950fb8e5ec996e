"""Surfaces of [contact] that cannot touch as they are stated."""

import pytest
from pydantic import ValidationError

from erlif.io.settings import ContactSettings

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}
FLAT = dict(STEEL)


def contact(body, counterbody=FLAT, **keys):
    return ContactSettings.model_validate(
        {"body": STEEL | body, "counterbody": STEEL | counterbody, **keys}
    )


@pytest.mark.parametrize(
    ("body", "counterbody", "keys", "words"),
    [
        ({"radius": "0 mm"}, {}, {}, "must not be zero"),
        ({}, {}, {}, "must touch in a point or a line"),
        ({"radius": "40 mm"}, {"radius_along": "-10 mm"}, {}, "must touch"),
        ({"radius_along": "10 mm"}, {}, {}, "or length"),
        ({"radius": "10 mm"}, {}, {"length": "8 mm"}, "or length"),
    ],
    ids=["no radius", "two planes", "ball too large for its ring", "no length", "length of a ball"],
)
def test_bodies_that_cannot_touch_so_are_refused(body, counterbody, keys, words):
    with pytest.raises(ValidationError, match=words):
        contact(body, counterbody, **keys)
