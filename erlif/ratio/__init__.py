"""Light of two cameras to the logarithm of their ratio, with its variance."""

from erlif.ratio.accumulation import RatioSum, combine_frames
from erlif.ratio.bubbles import find_bubbles
from erlif.ratio.camera_noise import NoiseEstimate, NoiseView, estimate_camera_noise
from erlif.ratio.cells import NO_CELLS, LightCells, cell_places, sample_cells
from erlif.ratio.log_ratio import compute_ratio
from erlif.ratio.noise_fit import NoiseUnknowns
from erlif.ratio.pair import PairRatio
from erlif.ratio.pulses import NO_PULSE, PulseFault, PulseSample, find_pulse_faults, sample_pulse
from erlif.ratio.sharpness import BlurDifference, BlurMoments
from erlif.ratio.smoothing import smooth_ratio

__all__ = [
    "NO_CELLS",
    "NO_PULSE",
    "BlurDifference",
    "BlurMoments",
    "LightCells",
    "NoiseEstimate",
    "NoiseUnknowns",
    "NoiseView",
    "PairRatio",
    "PulseFault",
    "PulseSample",
    "RatioSum",
    "cell_places",
    "combine_frames",
    "compute_ratio",
    "estimate_camera_noise",
    "find_bubbles",
    "find_pulse_faults",
    "sample_cells",
    "sample_pulse",
    "smooth_ratio",
]
