"""Wear after Archard (1953), worn bushings, and the heat and pv of a sliding joint.

The wear laws are those of Farzaneh (2002) and Strand (2005), who also gives the heat. The worn
bushing is that of Colbert et al. (2009), appendix A. The wear that changes its own forces is that
of Mukras et al. (2008). Arguments that are off by orders of magnitude raise
`erlif.core.errors.UnitWarning`.
"""

from erlif.models.wear.bushing import (
    WornBushing,
    steady_bushing_wear,
)
from erlif.models.wear.coupled import (
    LARGEST_STEP,
    CoupledWear,
    coupled_wear,
)
from erlif.models.wear.heat import (
    bushing_heat_share,
    friction_heat,
    mean_sliding_speed,
    pressure_velocity,
    surface_temperature,
    thermal_growth,
)
from erlif.models.wear.laws import (
    abrasive_wear,
    adhesive_wear,
    fatigue_wear,
    wear_depth,
)

__all__ = [
    "LARGEST_STEP",
    "CoupledWear",
    "WornBushing",
    "abrasive_wear",
    "adhesive_wear",
    "bushing_heat_share",
    "coupled_wear",
    "fatigue_wear",
    "friction_heat",
    "mean_sliding_speed",
    "pressure_velocity",
    "steady_bushing_wear",
    "surface_temperature",
    "thermal_growth",
    "wear_depth",
]
