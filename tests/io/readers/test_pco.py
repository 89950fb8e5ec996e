"""PCO B16."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_b16

from erlif.io.readers import open_frames


@pytest.mark.parametrize("start", [28, 512, 4096])
def test_known_counts(tmp_path, start):
    frame = random_frames(np.random.default_rng(start), bits=16)[0]
    file = open_frames(write_b16(tmp_path / "a.b16", frame, start=start))
    npt.assert_array_equal(file.read(0), frame)
    assert list(map(str, file.kinds)) == ["8 x 6 uint16"]
    assert file.bits is None
    file.close()
