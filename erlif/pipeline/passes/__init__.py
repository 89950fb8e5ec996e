"""The compiled kernels of the stages, composed for one frame pair.

Few passes over plain arrays do what `erlif.correction.correct_frames`,
`erlif.registration.align_frames`, `erlif.ratio.compute_ratio`, `erlif.thickness.measure_thickness`
and `erlif.trend.sum_blocks` do for datasets.
"""

from erlif.pipeline.passes.drift import PairDrift
from erlif.pipeline.passes.film import FilmMaps, measure_film, measure_pulse

__all__ = ["FilmMaps", "PairDrift", "measure_film", "measure_pulse"]
