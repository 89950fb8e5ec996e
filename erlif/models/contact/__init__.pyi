from .hertz import (
    THESIS_F1,
    THESIS_F2,
    EllipticalContact,
    LineContact,
    RelativeRadii,
    hertz_ellipse,
    hertz_line,
    relative_radii,
    thesis_ellipse,
)
from .impact import (
    impact_force,
    impact_stiffness,
)
from .persson import (
    FULL_CONTACT,
    ConformalContact,
    closed_contact_pressure,
    persson_contact,
    persson_group,
    persson_half_angle,
    persson_load,
    persson_peak_group,
    persson_pressure,
)
from .prescribed import (
    projected_pressure,
    sinusoidal_pressure,
)
from .scaling import (
    conformal_radius,
    contact_modulus,
    scale_load,
    scale_stress,
)
from .winkler import (
    WinklerContact,
    winkler_contact,
    winkler_load,
    winkler_modulus,
)

__all__ = [
    "FULL_CONTACT",
    "THESIS_F1",
    "THESIS_F2",
    "ConformalContact",
    "EllipticalContact",
    "LineContact",
    "RelativeRadii",
    "WinklerContact",
    "closed_contact_pressure",
    "conformal_radius",
    "contact_modulus",
    "hertz_ellipse",
    "hertz_line",
    "impact_force",
    "impact_stiffness",
    "persson_contact",
    "persson_group",
    "persson_half_angle",
    "persson_load",
    "persson_peak_group",
    "persson_pressure",
    "projected_pressure",
    "relative_radii",
    "scale_load",
    "scale_stress",
    "sinusoidal_pressure",
    "thesis_ellipse",
    "winkler_contact",
    "winkler_load",
    "winkler_modulus",
]
