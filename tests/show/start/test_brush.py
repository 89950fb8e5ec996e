"""A mask from strokes."""

import numpy as np
from PIL import Image

from erlif.io.ingest.exclusions import exclude_pixels
from erlif.io.settings import read_fixture_settings
from erlif.show.start.brush import write_mask


def test_what_lies_under_the_brush_is_excluded_and_earlier_masks_stay(lab):
    shape = 96, 128
    names = [
        write_mask(lab.fixture, [[(20, 30), (60, 30)], [(100, 50)]], width=11, shape=shape)
        for _ in range(2)
    ]
    assert names == ["mask_1.png", "mask_2.png"]
    mask = np.asarray(Image.open(lab.fixture / names[1])) > 0
    y, x = np.mgrid[:96, :128]
    along = np.hypot(x - np.clip(x, 20, 60), y - 30)
    away = np.minimum(along, np.hypot(x - 100, y - 50))  # from the way of the brush
    assert mask[away < 4.5].all()
    assert not mask[away > 6.5].any()

    lab.edit(
        "fixture/fixture.toml", ("[optics]", '[thickness]\nexclude = ["mask_2.png"]\n\n[optics]')
    )

    settings = read_fixture_settings(lab.fixture)
    np.testing.assert_array_equal(exclude_pixels(lab.fixture, settings, shape), mask)
