"""The datasets that travel between the stages, each named and described.

All of them are `xarray.Dataset`; with the names, a signature, the type checker and `require` notice
a skipped stage. Image rows are ``y`` (down), columns ``x`` (right), pixel centres at integers.
"""

from typing import NewType

import xarray as xr

from erlif.core.errors import ErlifError

EncoderLog = NewType("EncoderLog", xr.Dataset)
"""Log of the encoder, one row for each frame pair: number (frame).

Where they are logged, angle (frame) [degree], with angle_rate (frame) [degree/s] from a continuous
log, time (frame) [s], load (frame) [N], temperature (frame) [degree_Celsius], sliding_speed (frame)
[m s-1] and rotation_speed (frame) [rad s-1]; further columns under their own names. Without a log,
time (frame) comes from the headers of the camera files.
"""

Frames = NewType("Frames", xr.Dataset)
"""Raw counts of both cameras: counts (camera, frame, y, x) [DN], camera = 1, 2.

The coordinate pulse_energy (frame), relative to the mean of the run, scales a background [1].
"""

References = NewType("References", xr.Dataset)
"""Both cameras as darks, flats and settings describe them.

dark and dark_var [DN, DN2], flat and flat_var [1], bad: (camera, y, x). gain [electron/DN],
read_noise [electron], full_scale (count at saturation) [DN]: (camera).

Where the dry joint was recorded, background and background_var (camera, y, x), its light above the
dark at the mean pulse energy [DN, DN2]; the variance is that of the mean page, dark not included.
background_recorded (camera) is False where there were no pages, background_pages is their number.

Characteristics after EMVA 1288, (camera), NaN where not measured: gain_measured and
read_noise_measured with gain_std and read_noise_std, dark_signal with dark_signal_std and
dark_spread [DN], response_spread, bend of the photon transfer with bend_std [1],
saturation_capacity [electron]. Whether they are known: gain_known, read_noise_known, has_flat.
"""

CorrectedFrames = NewType("CorrectedFrames", xr.Dataset)
"""Light of both cameras: signal (camera, frame, y, x) [DN], dark subtracted, divided by the flat.

signal_var is the variance that is new in every frame, signal_var_fixed that of dark and flat, which
repeats from frame to frame [DN2]; they are disjoint. flags [bit mask].
"""

AlignedFrames = NewType("AlignedFrames", xr.Dataset)
"""CorrectedFrames with camera 2 on the pixel grid of camera 1.

displacement_std (y, x), standard deviation of that grid [px]; interpolation (frame), the factor by
which the interpolation lowers the variance of a pixel of camera 2 [1].
"""

RatioImages = NewType("RatioImages", xr.Dataset)
"""log_ratio (.., y, x): natural logarithm of camera 2 over camera 1 [1].

log_ratio_var is the variance of a pixel without that of the registration; it includes
log_ratio_var_fixed, which repeats from frame to frame (dark, flat). This departs from signal_var
and signal_var_fixed, which are disjoint. log_ratio_var_shared is the variance by the registration,
common to neighbouring pixels and to all frames, and not included in log_ratio_var [1].

flags [bit mask]; noise_correlation, variance of a mean over many pixels over that of independent
pixels [1].
"""

ThicknessMaps = NewType("ThicknessMaps", xr.Dataset)
"""thickness (.., y, x) [um], NaN exactly where flags is not 0.

thickness_std, from the noise of the pixel; thickness_std_shared, from calibration and registration,
common to all pixels [um]; flags [bit mask]; log_ratio_near, mean log ratio about the pixel [1].
"""


def require(dataset: xr.Dataset, *names: str) -> None:
    """Check that a product holds what a stage reads.

    Parameters
    ----------
    dataset : xarray.Dataset
        Product of the stage before.
    *names : str
        Variables that are read.

    Raises
    ------
    ErlifError
        If a variable is absent, naming the missing ones and those present.

    Examples
    --------
    >>> require(xr.Dataset({"counts": 1, "flags": 0}), "counts")
    >>> require(xr.Dataset({"counts": 1}), "signal")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    erlif.core.errors.ErlifError: This stage reads signal; signal is missing from the dataset, ...
    """
    missing = ", ".join(name for name in names if name not in dataset)
    if missing:
        present = ", ".join(str(name) for name in dataset.variables)
        raise ErlifError(
            f"This stage reads {', '.join(names)}; {missing} is missing from the dataset, which "
            f"holds {present}. Call the stage before it first."
        )
