"""Design of a grease-lubricated pin joint after Strand (2005), chapter 2, in corrected form.

One function for each equation; `erlif.joint.sizing` takes a joint through all of them.
Equations 6 to 9 are in `erlif.models.contact`, 26 to 32 in `erlif.models.wear`. The argument
`safety` is the safety factor that the source calls eta.
"""

from erlif.models.bearing.bushing import (
    BRINELL_OVER_STRENGTH,
    RECOMMENDED_WIDTH,
    STANDARD_GRAVITY,
    hardness_from_strength,
    least_bushing_width,
    least_projected_area,
    least_seat_width,
)
from erlif.models.bearing.fit import (
    RECOMMENDED_PLAY,
    press_fit_displacement,
    relative_play,
)
from erlif.models.bearing.housing import (
    RECOMMENDED_HOUSING,
    least_eyebar_diameter,
)
from erlif.models.bearing.lock import (
    CLOSED_LOCK_MOMENT,
    CLOSED_LOCK_SHEAR,
    end_force_of_closed_lock,
    largest_internal_weld_diameter,
    least_closed_end_width,
    least_closed_prong_height,
    least_open_prong_height,
    least_weld_diameter,
    lock_force,
)
from erlif.models.bearing.pin import (
    LARGEST_HOLE_RATIO,
    RECOMMENDED_SLENDERNESS,
    hole_stress_concentration,
    lateral_force,
    lateral_shift,
    pin_diameter_in_bending,
    pin_diameter_in_shear,
    pin_diameter_with_hole,
)

__all__ = [
    "BRINELL_OVER_STRENGTH",
    "CLOSED_LOCK_MOMENT",
    "CLOSED_LOCK_SHEAR",
    "LARGEST_HOLE_RATIO",
    "RECOMMENDED_HOUSING",
    "RECOMMENDED_PLAY",
    "RECOMMENDED_SLENDERNESS",
    "RECOMMENDED_WIDTH",
    "STANDARD_GRAVITY",
    "end_force_of_closed_lock",
    "hardness_from_strength",
    "hole_stress_concentration",
    "largest_internal_weld_diameter",
    "lateral_force",
    "lateral_shift",
    "least_bushing_width",
    "least_closed_end_width",
    "least_closed_prong_height",
    "least_eyebar_diameter",
    "least_open_prong_height",
    "least_projected_area",
    "least_seat_width",
    "least_weld_diameter",
    "lock_force",
    "pin_diameter_in_bending",
    "pin_diameter_in_shear",
    "pin_diameter_with_hole",
    "press_fit_displacement",
    "relative_play",
]
