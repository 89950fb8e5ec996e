"""Write docs/sources.md, published numbers beside those of erlif: ``python docs/make_sources.py``.

The printed numbers are in sources/numbers.csv, the misprints in sources/errata.csv and what has no
data in sources/sources.toml; the column `model` of the first names an entry of `MODELS`, which
computes the same number in the same unit.
"""

import csv
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import scipy
from jinja2 import Environment, StrictUndefined
from scipy.constants import inch, pound_force

from erlif.joint.models import bearing, friction, linkage, reaction, running_in, slider_wear, wear
from erlif.joint.models.linkage.motor import HORSEPOWER
from erlif.models import contact, film
from erlif.models.arguments import Values
from erlif.models.mechanism import CrankRocker, SliderCrank, crank_for_swing

# Turn per minute. [rad/s]
RPM = 2 * np.pi / 60

DOCS = Path(__file__).parent

_SOURCES = tomllib.loads((DOCS / "sources" / "sources.toml").read_text(encoding="utf-8"))

# Author and title of each source, by its key in the tables.
TITLES: dict[str, str] = {key: row["title"] for key, row in _SOURCES.items()}

# The crank-rocker of Farzaneh (2002), appendix A.2.
RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)

# Crank speed of that rig. [rad/s]
RIG_SPEED = 114 * RPM

# Greatest rocker speed by the crank-over-rocker rule of the source. [rad/s]
RULE_SPEED = RIG_SPEED * 5.5 / 26

# The slider-crank of Mukras et al. (2008), whose Table 1 gives half lengths.
MUKRAS = SliderCrank(crank=2 * 0.0381, coupler=2 * 0.1016)

# Its masses and spring, Tables 1 to 3; the preload of the spring is not stated.
_MUKRAS_BODIES = reaction.SliderCrankBodies(
    rod_mass=0.8175, rod_inertia=5500e-6, slider_mass=5.5487, spring_stiffness=525.4
)

# Radii of pin and bushing and length of the joint of Farzaneh (2002). [m]
PIN, BUSHING, LENGTH = 0.03336, 0.03359, 0.237

# E* of steel on steel. [Pa]
STEEL = contact.contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)


@dataclass(frozen=True)
class PublishedNumber:
    """A number printed by a source, and the one computed by the model.

    Attributes
    ----------
    source : str
        Key of `TITLES`.
    place : str
        Section, equation or table of the source.
    quantity : str
        What the number is.
    printed : str
        As printed, with a decimal point; empty where the source gives no number.
    unit : str
        Unit of both numbers.
    within : float
        Half width of agreement, by default half a unit of the last printed digit.
    model : str
        Key of `MODELS`.
    computed : float
        Number of the model.
    note : str
        Reason of a difference, or conditions of the comparison.
    """

    source: str
    place: str
    quantity: str
    printed: str
    unit: str
    within: float
    model: str
    computed: float
    note: str

    @property
    def verdict(self) -> str:
        """Whether the model agrees with the printed number to its last digit."""
        if not self.printed:
            return "not printed"
        agrees = abs(self.computed - float(self.printed)) <= self.within
        return "agrees" if agrees else "**differs**"


def published_numbers() -> tuple[PublishedNumber, ...]:
    """Compute every number of sources/numbers.csv, in the order of the table."""
    return tuple(
        PublishedNumber(
            **row
            | {
                # half a unit of the last digit of a decimal number
                "within": float(
                    row["within"] or 0.5 * 10.0 ** -len(row["printed"].partition(".")[2])
                ),
                "computed": float(MODELS[row["model"]]()),
            }
        )
        for row in _table("numbers.csv")
    )


def render_sources() -> str:
    """Text of docs/sources.md: published numbers, errata, and what has no data."""
    environment = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    page = (DOCS / "sources" / "page.txt").read_text(encoding="utf-8")
    return environment.from_string(page).render(
        sources=_SOURCES, numbers=published_numbers(), errata=_table("errata.csv")
    )


def _table(name: str) -> list[dict[str, Any]]:
    lines = (DOCS / "sources" / name).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(lines))


def _film(pressure_viscosity: float) -> Values:
    """Film of the steel joint at 100,000 lbf and the mean speed, eq. 2.8 in standard form. [m]"""
    return film.dowson_higginson_film(
        0.042,
        load_per_length=1e5 * pound_force / LENGTH,
        viscosity=0.12,
        pressure_viscosity=pressure_viscosity,
        radius=contact.conformal_radius(PIN, bushing_radius=BUSHING),
        contact_modulus=STEEL,
    )


def _lobe(load: float, *, exact: bool = False) -> contact.EllipticalContact:
    """Contact of one of the two lobes of the undercut bushing under a total load [lbf]."""
    radius, across = contact.relative_radii(
        -BUSHING, radius_1_across=0.2, radius_2=PIN, radius_2_across=np.inf
    )
    ellipse = contact.hertz_ellipse if exact else contact.thesis_ellipse
    return ellipse(
        load / 2 * pound_force, radius=radius, radius_across=across, contact_modulus=STEEL
    )


def _torque(radius: float) -> Values:
    """Torque of the friction 0.15 at 100,000 lbf. [N m]"""
    return friction.friction_torque(0.15, load=1e5 * pound_force, radius=radius)


def _drive() -> linkage.DrivePower:
    """Power of the drive of appendix A.4.2."""
    return linkage.drive_power(RIG, crank_speed=RIG_SPEED, torque=_torque(1.25 * inch))


def _life(load: float, exponent: float) -> Values:
    """Life of the ball bearings of the rig. [h]"""
    return (
        reaction.rolling_bearing_life(load, rating=23.9e3, speed=RIG_SPEED, exponent=exponent)
        / 3600
    )


def _growth_with_hole(hole_ratio: Values) -> Values:
    """Growth of the pin diameter by a lubrication hole. [%]"""
    case = {"free_length": 0.1, "yield_stress": 6e8, "safety": 2.0}
    plain = bearing.pin_diameter_in_bending(1e5, **case)
    return 100 * (bearing.pin_diameter_with_hole(1e5, hole_ratio=hole_ratio, **case) / plain - 1)


def _safe_from(simple: float) -> float:
    """Half contact angle above which a simple law's d p / 2q exceeds Persson's. [degree]"""
    return float(
        np.degrees(
            scipy.optimize.brentq(
                lambda angle: contact.persson_peak_group(angle) - simple, 0.1, 1.8
            )
        )
    )


@cache
def _local_wear(cycles: int, *, preload: float, width: float) -> tuple[float, float]:
    """Worn mass [g] and depth [mm] of the same joint where each place wears by its pressure.

    Eqs. 2 to 5 of the source with changing dynamics; a wall of 3 mm and a clearance of 10 um.
    """
    worn = slider_wear.wear_slider_crank(
        replace(MUKRAS, clearance=10e-6),
        crank_speed=np.pi,
        bodies=replace(_MUKRAS_BODIES, spring_preload=preload, pin_radius=9.525e-3),
        joint=slider_wear.WearingJoint(
            width=width,
            thickness=3e-3,
            modulus=contact.winkler_modulus(0.139e9, poisson=0.38),
            specific_wear=5.05e-13,
        ),
        cycles=cycles,
        extrapolation=1000,
    ).isel(cycle=-1)
    return float(worn.worn_volume) * 2200e3, float(worn.greatest_depth) * 1e3


@cache
def _wear(cycles: int, preload: float = 68.354) -> tuple[float, float]:
    """Worn mass [g] and depth [mm] of the joint of Mukras et al. (2008), from initial dynamics.

    Archard's law of the whole contact, eq. 1: the worn volume is k times load and sliding distance.

    The source states neither the preload of the spring nor the width of the bushing; both are
    fitted to the first row of its Table 4. The bushing is PTFE of 2200 kg/m3.
    """
    worn = wear.coupled_wear(
        MUKRAS,
        crank_speed=np.pi,
        bodies=replace(_MUKRAS_BODIES, spring_preload=preload),
        bushing_radius=9.535e-3,
        bushing_width=8.468e-3,
        specific_wear=5.05e-13,
        cycles=cycles,
        coupled=False,
    )
    return float(worn.volume[-1]) * 2200e3, float(worn.depth[-1]) * 1e3


# Function for each row of sources/numbers.csv, by its column `model`, in the unit of the row.
MODELS: dict[str, Callable[[], Values]] = {
    # Farzaneh (2002), sections 1.2 and 2.2.2: dimensions and film of the steel joint
    "thesis_bore": lambda: 2e3 * BUSHING,
    "thesis_clearance": lambda: 2e3 * BUSHING - 66.7,
    "klbf_100": lambda: 1e5 * pound_force / 1e3,
    "sliding_speed": lambda: RULE_SPEED * PIN,
    "film_standard": lambda: _film(2e-8) * 1e6,
    "film_alpha": lambda: (
        1e8 * scipy.optimize.brentq(lambda alpha: _film(alpha) - 0.54e-6, 1e-9, 1e-7, xtol=1e-14)
    ),
    "film_parameter": lambda: film.film_parameter(
        0.54e-6, roughness_a=0.25e-6, roughness_b=0.25e-6
    ),
    # section 3: Hertz contact of the lobes, test stages
    "lobe_pressure": lambda: _lobe(1e5).pressure / 1e6,
    "lobe_pressure_exact": lambda: _lobe(1e5, exact=True).pressure / 1e6,
    "lobe_a": lambda: _lobe(1e5).a * 1e3,
    "lobe_a_exact": lambda: _lobe(1e5, exact=True).a * 1e3,
    "lobe_b": lambda: _lobe(1e5).b * 1e3,
    "lobe_b_exact": lambda: _lobe(1e5, exact=True).b * 1e3,
    "lobe_approach": lambda: _lobe(1e5).approach * 1e3,
    "lobe_pressure_light": lambda: _lobe(1e4).pressure / 1e6,
    "lobe_a_light": lambda: _lobe(1e4).a * 1e3,
    "lobe_b_light": lambda: _lobe(1e4).b * 1e3,
    "lobe_approach_light": lambda: _lobe(1e4).approach * 1e3,
    "lobe_pressure_quarter": lambda: _lobe(4e4, exact=True).pressure / 1e6,
    "fe_above_hertz": lambda: 100 * (756e6 / _lobe(1e4).pressure - 1),
    "undercut": lambda: 100 * 543 / 2340,
    "stage_6": lambda: 8e3 + 5 * 4e3,
    "stage_5": lambda: 8e3 + 4 * 4e3,
    # section 5 and appendix A.2: the crank-rocker
    "images": lambda: np.floor(2 * np.degrees(np.ptp(RIG.limits())) / 0.96),
    "swing": lambda: np.degrees(np.ptp(RIG.limits())),
    "crank_for_26": lambda: (
        100 * crank_for_swing(np.radians(26), coupler=0.44, rocker=0.26, ground=0.51)
    ),
    "rocker_over_crank": lambda: RIG.rocker / RIG.crank,
    "speed_rule": lambda: RULE_SPEED,
    "speed_fall": lambda: -RIG.speed_limits(crank_speed=RIG_SPEED)[0],
    "speed_rise": lambda: RIG.speed_limits(crank_speed=RIG_SPEED)[1],
    "speed_rule_rpm": lambda: RULE_SPEED / RPM,
    # appendices A.3 and A.4: drive, bearings and rods
    "torque": lambda: _torque(1.25 * inch) * 100,
    "torque_true": lambda: _torque(PIN) * 100,
    "link_force": lambda: _torque(1.25 * inch) / RIG.rocker / 1e3,
    "link_force_worst": lambda: (
        np.max(
            reaction.coupler_force(
                RIG, crank_angle=np.array([0, np.pi]), rocker_torque=_torque(1.25 * inch)
            )
        )
        / 1e3
    ),
    "life_4": lambda: _life(4.1e3, 3.0),
    "life_4_printed": lambda: _life(4.1e3, 10 / 3),
    "life_8": lambda: _life(8.2e3, 3.0),
    "life_8_printed": lambda: _life(8.2e3, 10 / 3),
    "rod": lambda: reaction.rod_stress(8.2e3, diameter=0.5 * inch) / 1e6,
    "rod_safety": lambda: 50e6 / reaction.rod_stress(8.2e3, diameter=0.5 * inch),
    "power": lambda: _torque(1.25 * inch) * 24 * RPM / HORSEPOWER,
    "crank_speed_for_24": lambda: (
        linkage.measure_linkage(RIG, rocker_speed=24 * RPM).crank_speed / RPM
    ),
    "thread_safety": lambda: linkage.fatigue_safety(
        8.2e3 / linkage.thread_stress_area(0.5 * inch, pitch=inch / 13), fatigue_strength=50e6
    ),
    "hole_for_60": lambda: (0.045 - 2.5 * 8.2e3 / (60e6 * 0.02)) * 1e3,
    "pin_hole": lambda: linkage.pin_hole_concentration(0.5),
    "section_for_37": lambda: 8.2e3 * RIG.rocker / 37e6 * 1e6,
    "power_exact": lambda: _drive().peak_power / HORSEPOWER,
    "motor": lambda: linkage.choose_motor(_drive().peak_power, series="hp") / HORSEPOWER,
    "power_mean": lambda: _drive().mean_power / HORSEPOWER,
    # Strand (2005)
    "hole_least": lambda: np.min(_growth_with_hole(np.linspace(0, 0.2, 401))),
    "hole_largest": lambda: np.max(_growth_with_hole(np.linspace(0, 0.2, 401))),
    "cosine": lambda: contact.sinusoidal_pressure(1.0, pin_diameter=1.0),
    "cosine_safe": lambda: _safe_from(2 / np.pi),
    "double_safe": lambda: _safe_from(1.0),
    "hardness": lambda: bearing.hardness_from_strength(1e9) / 1e9,
    "closed_end": lambda: bearing.end_force_of_closed_lock(1.0),
    "persson": lambda: contact.persson_group(np.pi / 2),
    "persson_peak": lambda: contact.persson_peak_group(np.pi / 2),
    "persson_closed": lambda: contact.persson_peak_group(np.pi - 1e-9),
    # Mukras et al. (2008); 32,000 cycles took 17 h
    "crank_rpm": lambda: 32_000 / (17 * 60),
    "mass_1": lambda: _wear(32_000)[0],
    "mass_slack": lambda: _wear(32_000, preload=0.0)[0],
    "depth_1": lambda: _wear(32_000)[1],
    "mass_2": lambda: _wear(21_400)[0],
    "depth_2": lambda: _wear(21_400)[1],
    "mass_local": lambda: _local_wear(32_000, preload=46.32, width=8.551e-3)[0],
    "mass_local_slack": lambda: _local_wear(32_000, preload=0.0, width=8.551e-3)[0],
    "depth_local": lambda: _local_wear(32_000, preload=46.32, width=8.551e-3)[1],
    "mass_local_2": lambda: _local_wear(21_400, preload=46.32, width=8.551e-3)[0],
    "depth_local_2": lambda: _local_wear(21_400, preload=46.32, width=8.551e-3)[1],
    "error_mass_1": lambda: 100 * (1 - 0.2336 / 0.2616),
    "error_depth_1": lambda: 100 * (1 - 0.6575 / 0.7850),
    "error_mass_2": lambda: 100 * (1 - 0.1589 / 0.1714),
    "error_depth_2": lambda: 100 * (1 - 0.4524 / 0.4850),
    # Colbert et al. (2009)
    "uniform": lambda: friction.uniform_torque_ratio(np.pi / 2),
    "steady_wear": lambda: friction.cosine_torque_ratio(np.pi / 2),
    "interference": lambda: scipy.optimize.brentq(
        lambda group: (
            running_in.thin_wall_torque_ratio(
                40e3,
                clearance=-group * 40e3 * 3e-3 / (1e9 * 5e-3),
                shaft_radius=5e-3,
                thickness=3e-3,
                modulus=1e9,
            )
            - 1.6
        ),
        0.0,
        0.3,
    ),
    "ptfe": lambda: 0.105 * friction.STEADY_WEAR_TORQUE_RATIO,
    "projected": lambda: contact.projected_pressure(400.0 / 0.010, pin_diameter=0.010) / 1e6,
}


if __name__ == "__main__":
    (DOCS / "sources.md").write_text(render_sources(), encoding="utf-8")
