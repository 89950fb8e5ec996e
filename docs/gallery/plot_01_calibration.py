"""
Calibration: ratio against film thickness
=========================================

The fixture has a gap whose thickness a coordinate measuring machine (CMM) has measured. Each
point of its profile gives one pair of thickness and ratio. The three parameters of the
reabsorption model are fitted to them with errors in both.
"""

import matplotlib.pyplot as plt
from sample import CALIBRATION

import erlif

calibration = erlif.open_calibration(CALIBRATION)

fig, (curve, residuals) = plt.subplots(
    2, sharex=True, figsize=(6, 5), height_ratios=(2, 1), layout="constrained"
)
erlif.plots.ratio_against_thickness(calibration, ax=curve)
erlif.plots.ratio_residuals(calibration, ax=residuals)
curve.set_xlabel("")
plt.show()

# %%
# The shaded range is the calibrated range, in which the curve may be used. The lower panel
# shows the points against the fit: scatter about zero, and no structure.
#
# The parameters and their standard deviations:

for name, value, std in (
    ("K, ratio of a vanishing film", calibration.ratio_at_zero, calibration.covariance[0, 0]),
    ("p, camera 1 [1/um]", calibration.attenuation_camera1, calibration.covariance[1, 1]),
    ("q, camera 2 [1/um]", calibration.attenuation_camera2, calibration.covariance[2, 2]),
):
    print(f"{name:30s} {value:.4f} ± {std**0.5:.4f}")
