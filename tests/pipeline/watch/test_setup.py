"""What trial frames show: a blurred camera, a displaced one."""

import cv2
import numpy as np
import pytest
import tifffile

from erlif.pipeline.watch.setup import SetupWatch
from tests.pipeline.watch.test_follow import wait_until


def test_a_pair_is_shown_with_sharpness_and_registration(lab, small_rig):
    setup = SetupWatch(lab.run)
    with setup.running():
        wait_until(lambda: setup.news(-1, 0, 0, 0.0).get("map"), setup)
        news = setup.news(-1, 0, 0, 0.0)
        assert setup.newest("thickness") is None
        _, _, image, flags = setup.newest("camera2")
    assert news["faults"] == []
    assert len(news["cameras"]) == 2
    assert news["cameras"][0]["dark"] == pytest.approx(64, abs=1)
    assert all(0.8 < camera["measurable"] <= 1 for camera in news["cameras"])
    np.testing.assert_array_equal(image, tifffile.imread(lab.frames(2)[-1]))
    assert not flags.any()
    # the displacement of the rig, without the drift of the frame
    true = np.median(small_rig.truth.displacement_x.values)
    assert news["map"]["shift"][0] == pytest.approx(true, abs=1.5)


def test_a_camera_out_of_focus_is_named(lab):
    setup = SetupWatch(lab.run)
    with setup.running():
        wait_until(lambda: setup.news(-1, 0, 0, 0.0)["cameras"], setup)
        image = tifffile.imread(lab.frames(2)[-1])
        blurred = cv2.GaussianBlur(image, (0, 0), 2.0)
        for n, frame in ((1, tifffile.imread(lab.frames(1)[-1])), (2, blurred)):
            tifffile.imwrite(lab.run / f"camera{n}" / "frame_0006.tif", frame)
        wait_until(
            lambda: any("camera 2 has" in text for text in setup.news(-1, 0, 0, 0.0)["advice"]),
            setup,
        )
