"""The pin joint of Farzaneh (2002) as a line contact, in steel and in acrylic."""

from erlif.models.contact import conformal_radius, contact_modulus

LBF = 4.4482216152605


LENGTH = 0.237


RADIUS = conformal_radius(0.03336, bushing_radius=0.03359)


STEEL = contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)


ACRYLIC = contact_modulus(2.7e9, poisson_1=0.37, youngs_2=2.7e9, poisson_2=0.37)


def thesis_case(load, **changes):
    case = {
        "viscosity": 0.12,
        "pressure_viscosity": 2e-8,
        "radius": RADIUS,
        "contact_modulus": STEEL,
    }
    return {**case, "load_per_length": load / LENGTH, **changes}


MAP = [
    (ACRYLIC, 50, 0.107, 0.0017, (128.4, 0.61, 13.6, 1.92), "isoviscous-rigid"),
    (ACRYLIC, 1333, 2.85, 0.229, (4.82, 0.61, 7.05, 1.25), "isoviscous-elastic"),
    (STEEL, 8e3, 2.04, 3.36, (0.802, 0.613, 0.899, 0.872), "isoviscous-elastic"),
    (STEEL, 28e3, 7.15, 22.0, (0.229, 0.613, 0.700, 0.741), "piezoviscous-elastic"),
    (STEEL, 100e3, 25.5, 149.0, (0.064, 0.613, 0.543, 0.628), "piezoviscous-elastic"),
]
"""Modulus, load [lbf], gE, gV, asymptotes [um] and regime of the five cases of the source."""
