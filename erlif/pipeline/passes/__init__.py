"""The fast path: few compiled passes over a frame pair, in place of one for each idea.

Each pass fills plain arrays. The functions of the stages (`erlif.correction`, `erlif.registration`,
`erlif.ratio`, `erlif.thickness`, `erlif.trend`) do the same in plain steps and are the reference:
tests hold the passes to them.
"""

from erlif.pipeline.passes.accumulation import PairSum
from erlif.pipeline.passes.drift import DriftSearch
from erlif.pipeline.passes.film import FilmMaps, measure_film, measure_pulse
from erlif.pipeline.passes.light import PairLight
from erlif.pipeline.passes.pair import PairRatio
from erlif.pipeline.passes.tables import FilmTables

__all__ = [
    "DriftSearch",
    "FilmMaps",
    "FilmTables",
    "PairLight",
    "PairRatio",
    "PairSum",
    "measure_film",
    "measure_pulse",
]
