"""Cameras exchanged in run.toml."""

from __future__ import annotations

import numpy as np

from erlif.calibration import Calibration
from erlif.core.errors import CalibrationError
from erlif.pipeline.chain import Chain, some_frames


def _refuse_foreign_ratio(chain: Chain, calibration: Calibration) -> None:
    """Recognise cameras swapped against the calibration: the inverse of the ratio is possible, the ratio itself is not.

    No film, however thick, has a ratio above K p/q.
    """
    low, high = calibration.predict_log(calibration.thickness_range)
    margin = 0.1 * (high - low)
    K, p, q = calibration.parameters
    gradient = np.array([1 / K, 1 / p, -1 / q])
    ceiling = np.log(K * p / q) + 2 * np.sqrt(gradient @ calibration.covariance @ gradient)
    shares = []
    for k in some_frames(chain.recording, 3):
        ratios = chain.ratio(k)
        good = ratios.flags.values == 0
        ratio, std = ratios.log_ratio.values[good], np.sqrt(ratios.log_ratio_var.values[good])
        if ratio.size:
            within = [(value > low - margin) & (value < high + margin) for value in (ratio, -ratio)]
            shares.append([within[0].mean(), within[1].mean(), (ratio - 2 * std > ceiling).mean()])
    if not shares:
        return
    inside, inverted, impossible = np.median(shares, axis=0)
    if inverted > 0.6 and (inside < 0.2 or impossible > 0.15):
        raise CalibrationError(
            f"Expected ratios camera2/camera1 between {np.exp(low):.3f} and {np.exp(high):.3f} as calibrated; {inverted:.0%} of the pixels "
            f"have the inverse of such a ratio, and {impossible:.0%} one that no film has. The cameras look swapped: exchange the files of "
            "[camera1] and [camera2] in run.toml."
        )
