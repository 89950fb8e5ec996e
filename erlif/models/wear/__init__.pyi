from .bushing import (
    WornBushing,
    steady_bushing_wear,
)
from .coupled import (
    LARGEST_STEP,
    CoupledWear,
    coupled_wear,
)
from .heat import (
    bushing_heat_share,
    friction_heat,
    mean_sliding_speed,
    pressure_velocity,
    surface_temperature,
    thermal_growth,
)
from .laws import (
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
