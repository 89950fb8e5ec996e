"""The datasets that travel between the stages, each named and described.

All of them are `xarray.Dataset`; the names let a signature, the type checker and `require` notice a skipped stage.
Image rows are ``y`` (down), columns ``x`` (right), pixel centres at integers.
"""

from typing import NewType

import xarray as xr

from erlif.core.errors import ErlifError

EncoderLog = NewType("EncoderLog", xr.Dataset)
"""angle (frame) [degree], and where logged time (frame) [s], load (frame) [N], temperature (frame) [degree_Celsius]; other
columns under their own names."""

Frames = NewType("Frames", xr.Dataset)
"""counts (camera, frame, y, x) [DN]: raw counts of both cameras, camera = 1, 2."""

References = NewType("References", xr.Dataset)
"""What the darks and flats say of both cameras: dark, dark_var, flat, flat_var, bad (camera, y, x); gain [electron/DN],
read_noise [electron] and full_scale, the count at saturation [DN], each (camera). Beside them, NaN where not measured, the
characteristics after EMVA 1288: gain_measured and read_noise_measured with gain_std and read_noise_std, dark_signal with
dark_signal_std and dark_spread [DN], response_spread, bend of the photon transfer with bend_std [1], saturation_capacity
[electron]; and gain_known, read_noise_known, has_flat."""

CorrectedFrames = NewType("CorrectedFrames", xr.Dataset)
"""signal (camera, frame, y, x) [DN]: dark subtracted, divided by the flat; signal_var, what is new in every frame, and
signal_var_fixed, the noise of dark and flat, the same in every frame [DN2]; flags [bit mask]."""

AlignedFrames = NewType("AlignedFrames", xr.Dataset)
"""CorrectedFrames with camera 2 on the pixel grid of camera 1; displacement_std (y, x) [px] of that grid; interpolation (frame), the
factor by which it lowers the variance of a pixel."""

RatioImages = NewType("RatioImages", xr.Dataset)
"""log_ratio (.., y, x): natural logarithm of camera 2 over camera 1 [1]; log_ratio_var, the random part of a pixel, of which
log_ratio_var_fixed is the same in every frame; log_ratio_var_shared, what the registration adds to neighbours and frames alike; flags;
noise_correlation, the variance of a mean over many pixels over that of independent ones."""

ThicknessMaps = NewType("ThicknessMaps", xr.Dataset)
"""thickness (.., y, x) [um], thickness_std (random), thickness_std_shared, flags; NaN exactly where flags is not 0."""


def require(dataset: xr.Dataset, *names: str) -> None:
    """Check that a product holds what a stage reads.

    Raises
    ------
    ErlifError
        If a variable is absent, naming the missing ones and those present.
    """
    missing = [name for name in names if name not in dataset]
    if missing:
        raise ErlifError(
            f"This stage reads {', '.join(names)}; {', '.join(missing)} is missing from the dataset, which holds "
            f"{', '.join(str(name) for name in dataset.variables)}. Was a stage of the pipeline left out?"
        )
