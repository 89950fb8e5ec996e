from .accumulation import RatioSum, combine_frames
from .bubbles import find_bubbles, flag_bubbles
from .camera_noise import NoiseEstimate, NoiseView, estimate_camera_noise
from .cells import NO_CELLS, LightCells, cell_centres, cell_places, sample_cells
from .excess import ExcessSums
from .focus import measure_sharpness
from .log_ratio import compute_ratio
from .noise_fit import NoiseUnknowns
from .pair import NO_DARK, PairRatio
from .pulses import NO_PULSE, PulseFault, PulseSample, find_pulse_faults, sample_pulse
from .sharpness import BlurDifference, BlurMoments
from .smoothing import smooth_ratio

__all__ = [
    "NO_CELLS",
    "NO_DARK",
    "NO_PULSE",
    "BlurDifference",
    "BlurMoments",
    "ExcessSums",
    "LightCells",
    "NoiseEstimate",
    "NoiseUnknowns",
    "NoiseView",
    "PairRatio",
    "PulseFault",
    "PulseSample",
    "RatioSum",
    "cell_centres",
    "cell_places",
    "combine_frames",
    "compute_ratio",
    "estimate_camera_noise",
    "find_bubbles",
    "find_pulse_faults",
    "flag_bubbles",
    "measure_sharpness",
    "sample_cells",
    "sample_pulse",
    "smooth_ratio",
]
