"""What trial frames show: a blurred camera, a displaced one."""

import cv2
import numpy as np
import pytest
import tifffile

from erlif.pipeline.watch.setup import MapCheck, SetupWatch, advise, check_counts
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


def test_counts_are_described_by_their_own_numbers():
    counts = np.full((100, 100), 400, np.uint16)
    counts[:2] = 4095  # 2 %
    check = check_counts(counts, 4095)
    assert check.saturated == pytest.approx(0.02)
    assert check.mean == pytest.approx(0.98 * 400 + 0.02 * 4095)
    assert check.highest == 1.0
    assert sum(check.histogram) == counts.size
    assert check.histogram[400 * 64 // 4096] == 9800
    assert check.histogram[-1] == 200


def test_advice_names_the_camera_and_what_to_turn():
    bright = check_counts(np.full((64, 64), 4095, np.uint16), 4095)
    weak = check_counts(np.full((64, 64), 819, np.uint16), 4095)
    good = check_counts(np.full((64, 64), 3000, np.uint16), 4095)
    nothing = [float("nan")] * 2
    assert advise([good, good], None, nothing) == []
    first, second = advise([bright, weak], None, nothing)
    assert first.startswith("camera 1 saturates in 100.0 %")
    assert "camera 2 uses 20 % of its range: 4.0 times" in second
    soft = good._replace(sharpness=0.2)
    (text,) = advise([good._replace(sharpness=0.4), soft], None, [0.4, 0.4])
    assert "camera 2 has 50 % of the best sharpness" in text
    (text,) = advise([good, good], MapCheck((60.0, 0.0), 0.9, 0.8, 0.0), nothing)
    assert "sees 80 %" in text
    assert "+60 px along x" in text
