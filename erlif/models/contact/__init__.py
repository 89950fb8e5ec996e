"""Dry contact of a pin in a bushing, and the scaling of loads between materials.

A pin in a bushing touches over an arc. Half of that arc is the half contact angle, measured at the
axis of the pin. The models differ in how they treat the arc:

- the laws of projected and of sinusoidal pressure prescribe the pressure (Strand, 2005);
- Hertz takes the arc as flat, which holds up to about 20 degrees (Johnson, 1985; Farzaneh, 2002);
- Persson (1964) solves the arc for equal materials, up to contact all round the pin;
- Winkler's bushing is a compliant liner on a rigid shaft (Colbert et al., 2009).

The impact law is that of Lankarani and Nikravesh (1994) as used by Mukras et al. (2008).
"""

from erlif.models.contact.impact import (
    impact_force,
    impact_stiffness,
)
from erlif.models.contact.line import (
    LineContact,
    hertz_line,
)
from erlif.models.contact.persson import (
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
from erlif.models.contact.point import (
    THESIS_F1,
    THESIS_F2,
    EllipticalContact,
    RelativeRadii,
    hertz_ellipse,
    relative_radii,
    thesis_ellipse,
)
from erlif.models.contact.prescribed import (
    projected_pressure,
    sinusoidal_pressure,
)
from erlif.models.contact.scaling import (
    conformal_radius,
    contact_modulus,
    scale_load,
    scale_stress,
)
from erlif.models.contact.winkler import (
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
