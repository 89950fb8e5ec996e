"""``erlif calibrate``."""

import numpy as np

import erlif


def test_a_fixture_is_calibrated_with_its_figure(lab, command):
    before = erlif.open_calibration(lab.fixture / "calibration.nc")
    (lab.fixture / "calibration.nc").unlink()
    printed = command("calibrate", lab.fixture).stdout
    after = erlif.open_calibration(lab.fixture / "calibration.nc")
    np.testing.assert_array_equal(after.parameters, before.parameters)
    for value, std in zip(after.parameters, after.standard_deviations, strict=True):
        assert f"{value:.5f} ± {std:.5f}" in printed
    assert (lab.fixture / "calibration.png").read_bytes().startswith(b"\x89PNG")
