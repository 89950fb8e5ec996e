"""The true film: motion of the linkage, gap of the joint, wedge of the fixture and bubbles.

The linkage follows from the law of cosines, the gap from rigid circles. Slider-cranks, discs,
sliders and static films may take the place of the linkage.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.core.speed.kernels import njit
from erlif.rig.settings import RigSettings

# Thickness [um] at object points (x, y) [pixel of camera 1].
Field = Callable[[Array, Array], Array]

# Film that roughness keeps where the smooth gap closes. [um]
BARE_FILM = 0.05
# Film left on the wall inside a bubble. [um]
RESIDUAL_FILM = 0.02

_FIRST_PULSE = 0.37  # steps of a divider after the smallest rocker angle
_WAVES = 12  # turning marks
_WAVELENGTHS = (5, 50)  # pixel: shortest and longest of the marks
_WAVE_SPREAD = np.radians(3)  # of their direction about the axial one
_SCRATCHES = 6
_SCRATCH_SPREAD = 0.4  # rad: of their direction about the sliding one
_SCRATCH_LENGTHS = (0.05, 0.3)  # of the width: half lengths
_SCRATCH_DEPTH = 4  # over the standard deviation of the marks
_SCRATCH_WIDTH = 1.3  # pixel: standard deviation across a scratch
_SCRATCH_END = 3.0  # pixel: standard deviation beyond its ends
_VANISHED = 20.0  # exponent from which on a scratch adds less than 1e-8 of its depth
_SMALLEST_BUBBLE = 3  # pixel
_BUBBLE_SPREAD = 7  # pixel: largest radius over the smallest
_REFERENCE_PICTURE = 320 * 256  # pixels that hold `RigSettings.bubbles`


# linkage

_FIRST = 0.37  # of the spacing of the pictures, by which the first one is off the zero
_LASER = 10.0  # pulses in a second over a static film [Hz]


def rocker_angle(crank_angle: Array, rig: RigSettings) -> Array:
    """Rocker angle at its pivot from the ground link [rad].

    The rocker is on the side of positive crank angles [rad]. The diagonal from the crank pin to the
    rocker pivot splits the four-bar into two triangles (law of cosines). Of a slider-crank it is
    the direction of the rod from crank pin to slider, whose pin stays on the line of the crank.
    """
    if rig.mechanism == "slider-crank":
        return np.asarray(-np.arcsin(rig.crank / rig.coupler * np.sin(crank_angle)))
    r1, r2, r3, r4 = rig.crank, rig.coupler, rig.rocker, rig.ground
    diagonal = np.sqrt(r1**2 + r4**2 - 2 * r1 * r4 * np.cos(crank_angle))
    to_crank_pin = np.arctan2(r1 * np.sin(crank_angle), r4 - r1 * np.cos(crank_angle))
    return np.asarray(to_crank_pin + np.arccos((r3**2 + diagonal**2 - r2**2) / (2 * r3 * diagonal)))


def rocker_speed(crank_angle: Array, rig: RigSettings) -> Array:
    """Angular speed of the rocker [rad/s]: derivative of `rocker_angle` times crank speed."""
    r1, r2, r3, r4 = rig.crank, rig.coupler, rig.rocker, rig.ground
    sin, cos = np.sin(crank_angle), np.cos(crank_angle)
    diagonal = np.sqrt(r1**2 + r4**2 - 2 * r1 * r4 * cos)

    cosine = (r3**2 + diagonal**2 - r2**2) / (2 * r3 * diagonal)
    cosine_rate = r1 * r4 * sin * (diagonal**2 - r3**2 + r2**2) / (2 * r3 * diagonal**3)
    per_crank_angle = (r1 * r4 * cos - r1**2) / diagonal**2 - cosine_rate / np.sqrt(1 - cosine**2)
    return np.asarray(per_crank_angle * rig.crank_speed * 2 * np.pi / 60)


def crank_pin_speed(crank_angle: Array, rig: RigSettings) -> Array:
    """Angular speed [rad/s] at which the crank of a slider-crank turns against its rod."""
    ratio = rig.crank / rig.coupler
    rod = ratio * np.cos(crank_angle) / np.sqrt(1 - (ratio * np.sin(crank_angle)) ** 2)
    return np.asarray((1 + rod) * rig.crank_speed * 2 * np.pi / 60)


def crank_angle(angle: Array, rising: Array, rig: RigSettings) -> Array:
    """Crank angle [rad, 0 to 2 pi] at which the rocker passes `angle` [rad] on either stroke."""
    r1, r2, r3, r4 = rig.crank, rig.coupler, rig.rocker, rig.ground
    pin_x, pin_y = r4 - r3 * np.cos(angle), r3 * np.sin(angle)
    reach = np.hypot(pin_x, pin_y)
    opening = np.arccos((r1**2 + reach**2 - r2**2) / (2 * r1 * reach))
    return (np.arctan2(pin_y, pin_x) + np.where(rising, -opening, opening)) % (2 * np.pi)


def coupler_angle(crank_angle: Array, rig: RigSettings) -> Array:
    """Direction of the coupler from crank pin to rocker pin against the ground link [rad]."""
    psi = rocker_angle(crank_angle, rig)
    if rig.mechanism == "slider-crank":
        return psi  # its rod is the coupler
    return np.arctan2(
        rig.rocker * np.sin(psi) - rig.crank * np.sin(crank_angle),
        rig.ground - rig.rocker * np.cos(psi) - rig.crank * np.cos(crank_angle),
    )


def crank_at(time: Array, rig: RigSettings) -> Array:
    """Crank angle [rad, rising without end] at a time [s] of `Triggers`."""
    start: Array = np.zeros(())
    if rig.mechanism == "crank-rocker":
        start = crank_angle(np.asarray(rocker_range(rig)[0] + 1e-12), np.asarray(True), rig)
    return np.asarray(start + time * rig.crank_speed * 2 * np.pi / 60)


def rocker_range(rig: RigSettings) -> tuple[float, float]:
    """Smallest and largest rocker angle [rad]: crank and coupler folded, and in line."""
    r1, r2, r3, r4 = rig.crank, rig.coupler, rig.rocker, rig.ground
    folded, in_line = (
        np.arccos((r3**2 + r4**2 - side**2) / (2 * r3 * r4)) for side in (r2 - r1, r2 + r1)
    )
    return float(folded), float(in_line)


class Triggers(NamedTuple):
    """One crank cycle, from the smallest rocker angle up and down; every array is (trigger,).

    Attributes
    ----------
    reading : Array
        Encoder reading. [degree]
    zero : float
        Rocker angle at reading 0. [degree]
    crank_angle : Array
        Crank angle, 0 to 360. [degree]
    speed : Array
        Rocker speed, positive on the rising stroke; of a slider-crank the speed of its crank pin.
        [rad/s]
    time : Array
        Time since the rocker stood at its smallest angle, or the crank at 0. [s]
    load : Array
        Load on the joint. [N]
    film_min : Array
        Minimum film thickness of the smooth gap in the region of interest; NaN for the film
        "reynolds", which changes from frame to frame. [um]
    """

    reading: Array
    zero: float
    crank_angle: Array
    speed: Array
    time: Array
    load: Array
    film_min: Array


def list_triggers(rig: RigSettings) -> Triggers:
    """List the encoder triggers, symmetric over the stroke, with the film of each.

    Pulses of a divider come at even crank angles; those of all cycles are then listed.

    The film law is ``film_reference * (|speed|/top speed * mean load/load) ** exponent``, never
    below ``film_floor``.
    """
    # outward and return stroke pass the same encoder marks
    low, high = np.degrees(rocker_range(rig))
    marks = int((high - low) // rig.spacing)
    zero = float(low + (high - low - (marks - 1) * rig.spacing) / 2)
    up = np.arange(marks) * rig.spacing
    reading: Array = np.concatenate([up, up[::-1]])
    rising = np.repeat([True, False], marks)

    # time runs from just after the lower dead point, where the crank angle is defined
    crank = crank_angle(np.radians(zero + reading), rising, rig)
    turned = (crank - crank_at(np.zeros(()), rig)) % (2 * np.pi)
    time: Array = turned / (rig.crank_speed * 2 * np.pi / 60)
    if rig.pulses_per_cycle:
        number = np.arange(int(rig.pulses_per_cycle * rig.cycles))
        time = np.asarray((number + _FIRST_PULSE) * 60 / (rig.pulses_per_cycle * rig.crank_speed))
        crank = crank_at(time, rig)
        reading = np.asarray(np.degrees(rocker_angle(crank, rig)) - zero)

    top = np.abs(rocker_speed(np.linspace(0, 2 * np.pi, 3601), rig)).max()
    return _with_film(rig, crank, rocker_speed(crank, rig), time, reading, zero, top=top)


def _with_film(
    rig: RigSettings,
    crank: Array,
    speed: Array,
    time: Array,
    reading: Array,
    zero: float,
    *,
    top: float,
) -> Triggers:
    """The motion at the triggers with load and film; `top` is the highest speed of the cycle."""
    load = load_of(crank, rig)
    relative = np.abs(speed) / top if top > 0 else np.ones(speed.size)
    film = follow_film_law(rig, relative, load)
    return Triggers(reading, zero, np.degrees(crank) % 360, speed, time, load, film)


def load_of(crank: Array, rig: RigSettings) -> Array:
    """Load on the joint [N] at crank angles [rad]."""
    return np.asarray(rig.load * (1 + rig.load_swing * np.sin(crank)))


def follow_film_law(rig: RigSettings, speed: Array, load: Array) -> Array:
    """Minimum film thickness at a speed [of the highest] and a load [N], by law or table. [um]"""
    if rig.film == "reynolds":
        return np.full(speed.size, np.nan)
    if rig.film_table is None:
        law = rig.film_reference * (speed * rig.load / load) ** rig.exponent
        return np.maximum(law, rig.film_floor)
    if len(rig.film_table) != speed.size:
        raise ModelError(
            f"film_table needs one film for each of {speed.size} triggers, got "
            f"{len(rig.film_table)}. Give one number for each."
        )
    return np.array(rig.film_table, dtype=np.float64)


# gap


def bore_height(rig: RigSettings, axial: Array) -> Array:
    """Height that lobes and edges, or a profile, add to the gap at places from the middle of the
    joint [mm].

    Of each lobe the circle is taken, not its parabola. [um]
    """
    if rig.profile is not None:
        ends = np.linspace(-0.5, 0.5, len(rig.profile)) * rig.length
        return np.interp(axial, ends, rig.profile)
    total: Array = np.zeros(np.shape(axial))
    (radius, height), (edge, depth) = rig.lobe, rig.edge
    for place in rig.lobes or ():
        off = np.minimum(np.abs(axial - place), radius)
        total -= np.maximum(height - 1e3 * (radius - np.sqrt(radius**2 - off**2)), 0.0)
    if edge > 0:
        total += depth * np.clip((np.abs(axial) - rig.length / 2) / edge + 1, 0.0, None) ** 2
    return total


@dataclass(frozen=True)
class Marks:
    """Turning marks along the sliding direction, and a few scratches; fixed in the object.

    Attributes
    ----------
    waves : Array
        Wave vector (x, y) [rad/pixel], phase [rad] and amplitude [um], (wave, 4).
    scratches : Array
        Middle (x, y) [pixel], unit vector along it (x, y), half length [pixel] and depth [um],
        (scratch, 6).
    """

    waves: Array
    scratches: Array

    def __call__(self, x: Array, y: Array) -> Array:
        """Height added to the film [um] at object points [pixel]."""
        return np.asarray(_sum_marks(x, y, self.waves, self.scratches), dtype=np.float64)


def draw_marks(rig: RigSettings, rng: np.random.Generator) -> Marks:
    """Draw a turned surface: waves within some degrees of the axial direction, and scratches."""
    count = _WAVES
    shortest, longest = _WAVELENGTHS
    wave_number = 2 * np.pi / np.exp(rng.uniform(np.log(shortest), np.log(longest), count))
    direction = np.pi / 2 + rng.normal(0, _WAVE_SPREAD, count)
    phase = rng.uniform(0, 2 * np.pi, count)
    amplitude = np.full(count, rig.marks * np.sqrt(2 / count))
    along, across = wave_number * np.cos(direction), wave_number * np.sin(direction)
    waves = np.column_stack([along, across, phase, amplitude])

    count = _SCRATCHES
    direction = rng.normal(0, _SCRATCH_SPREAD, count)
    x, y = rng.uniform(0, rig.width, count), rng.uniform(0, rig.height, count)
    length = rng.uniform(*_SCRATCH_LENGTHS, count) * rig.width
    depth = np.full(count, _SCRATCH_DEPTH * rig.marks)
    scratches = [x, y, np.cos(direction), np.sin(direction), length, depth]
    return Marks(waves, np.column_stack(scratches))


@njit(cache=True, nogil=True)
def _sum_marks(x: Array, y: Array, waves: Array, scratches: Array) -> Array:
    """Height of all waves and scratches at each point. [um]"""
    total = np.empty(x.shape)
    for j in range(x.shape[0]):
        for i in range(x.shape[1]):
            px, py = x[j, i], y[j, i]
            height = 0.0
            for k in range(waves.shape[0]):
                height += waves[k, 3] * np.sin(waves[k, 0] * px + waves[k, 1] * py + waves[k, 2])

            # a scratch is Gaussian across, and fades beyond its ends
            for k in range(scratches.shape[0]):
                off_x, off_y = px - scratches[k, 0], py - scratches[k, 1]
                along = scratches[k, 2] * off_x + scratches[k, 3] * off_y
                across = scratches[k, 2] * off_y - scratches[k, 3] * off_x
                beyond = max(0.0, abs(along) - scratches[k, 4])
                exponent = 0.5 * (across / _SCRATCH_WIDTH) ** 2 + 0.5 * (beyond / _SCRATCH_END) ** 2
                if exponent < _VANISHED:
                    height += scratches[k, 5] * np.exp(-exponent)

            total[j, i] = height
    return total


@dataclass(frozen=True)
class Gap:
    """Film at one trigger: pin and bushing, a ball on a plane, or two planes, and marks.

    Attributes
    ----------
    rig : RigSettings
        The joint and the picture.
    film_min : float
        Minimum film thickness of the smooth gap in the region of interest. [um]
    marks : Marks
        Marks on the surface, the same at all triggers.
    """

    rig: RigSettings
    film_min: float
    marks: Marks

    def smooth(self, x: Array, y: Array) -> Array:
        """Film without marks: of a pin c - e cos(phi); phi = 0 is the thin line. [um]

        The tilt moves the pin by a part of e that is zero at the edge of the region, so that h_min
        is the minimum in the region. A ball of radius R has h_min + r^2/2R. The shape of a bore is
        added, and the pin moved so that h_min stays that of the region.
        """
        rig = self.rig
        along = (x - rig.centre[0]) * rig.pitch - rig.thin_line
        if rig.contact == "ball":
            across = (y - rig.centre[1]) * rig.pitch
            if rig.plateau[0] > 0:
                return self.flattened(along, across)
            return np.asarray(self.film_min + 1e3 * (along**2 + across**2) / (2 * rig.ball_radius))
        phi = along / rig.journal_radius
        from_edge = y * rig.pitch - rig.region[1][0 if rig.tilt >= 0 else 1]  # mm
        rise = rig.tilt / (rig.height * rig.pitch) * from_edge
        if rig.contact == "plane":
            return np.asarray(self.film_min + rise + 0 * along)
        rise = rise - self.least_shape
        gap = rig.clearance - (rig.clearance - self.film_min - rise) * np.cos(phi)
        return np.asarray(gap + self.shape(y))

    def flattened(self, along: Array, across: Array) -> Array:
        """Film of a ball with a plateau, at distances from its centre [mm]. [um]

        Beside it is the gap of Hertz, a^2/(pi R) (sqrt(r^2 - 1) + (r^2 - 2) acos(1/r)) with r over
        its radius a (Johnson 1985, section 4.2). The constriction is as deep as stated at both
        sides and 0.7 of that at the outlet, at +x; the inlet has none. It lies about r = c = 0.85
        with s = (q exp(1 - q))^n, q = (r/c)^2, which has the standard deviation c/(2 sqrt(n)) = 0.1
        and is 0 at the centre. Where the central film is no longer small beside a^2/R, it is wider
        and farther inwards, as that of solved contacts.
        """
        radius, over = self.rig.plateau
        r = np.hypot(along, across) / radius
        beside = np.maximum(r, 1.0)
        gap = np.sqrt(beside**2 - 1) + (beside**2 - 2) * np.arccos(1 / beside)
        gap = 1e3 * radius**2 / (np.pi * self.rig.ball_radius) * gap
        part = across**2 + 0.7 * np.maximum(along, 0.0) ** 2
        part = part / np.maximum(along**2 + across**2, 1e-12)
        thick = min(over * self.film_min * self.rig.ball_radius / (1e3 * radius**2), 1.0)
        lowest, std = 0.85 - 0.3 * thick, 0.1 + 0.15 * thick
        square = (r / lowest) ** 2
        ring = (square * np.exp(1 - square)) ** ((lowest / (2 * std)) ** 2)
        return np.asarray(self.film_min * (over - (over - 1) * part * ring) + gap)

    @property
    def least_shape(self) -> float:
        """Least of shape and tilt of the bore in the region; 0 for a straight one. [um]"""
        rig = self.rig
        if not rig.shaped:
            return 0.0
        low, high = rig.region[1]
        place = np.linspace(low, high, 10 * rig.height)
        from_edge = place - (low if rig.tilt >= 0 else high)
        rise = rig.tilt / (rig.height * rig.pitch) * from_edge
        return float((self.shape(place / rig.pitch) + rise).min())

    def shape(self, y: Array) -> Array:
        """What the shape of the bore adds to the film at rows [pixel]. [um]"""
        middle = self.rig.centre[1] * self.rig.pitch + self.rig.axial_centre
        return bore_height(self.rig, y * self.rig.pitch - middle)

    def __call__(self, x: Array, y: Array) -> Array:
        """Film with marks at object points [pixel]. [um]"""
        return self.close(self.smooth(x, y), self.marks(x, y))

    @staticmethod
    def close(smooth: Array, height: Array) -> Array:
        """Film [um] of a smooth gap with the height of the marks; roughness keeps it open."""
        return np.maximum(smooth + height, BARE_FILM)


def lay_patch(film: Array, x: Array, y: Array, rig: RigSettings) -> Array:
    """The film [um] with the patch at object points [pixel]; unchanged where the rig has none."""
    if rig.reference == 0:
        return film
    (left, right), (top, bottom) = rig.patch
    inside = (left <= x * rig.pitch) & (x * rig.pitch <= right)
    inside &= (top <= y * rig.pitch) & (y * rig.pitch <= bottom)
    return np.where(inside, rig.reference, film)


@dataclass(frozen=True)
class Wedge:
    """Film of the calibration fixture: rises along x, with a smooth error of form.

    Attributes
    ----------
    rig : RigSettings
        The wedge and the picture.
    """

    rig: RigSettings

    def profile(self, x: Array) -> Array:
        """Signed film along x [pixel]; negative beyond the line of contact. [um]"""
        share, (low, high) = x / (self.rig.width - 1), self.rig.wedge
        error = self.rig.wedge_form * np.sin(3 * np.pi * share)
        return np.asarray(low + (high - low) * share + error)

    def __call__(self, x: Array, y: Array) -> Array:
        """Film at object points [pixel], not below what stays on the wall. [um]"""
        return np.maximum(self.profile(x), RESIDUAL_FILM)


@dataclass(frozen=True)
class Bubbles:
    """Discs without oil under a soft meniscus.

    Attributes
    ----------
    x : Array
        Column of each centre, (bubble,). [pixel]
    y : Array
        Row of each centre, (bubble,). [pixel]
    radius : Array
        Radius of each, (bubble,). [pixel]
    meniscus : float
        Width of the edge over which the full film returns. [pixel]
    """

    x: Array
    y: Array
    radius: Array
    meniscus: float = 1.5

    def lack(self, x: Array, y: Array) -> Array:
        """Share of the film that is missing: 1 inside, 0 beyond the meniscus."""
        missing = np.zeros(np.shape(x))
        for centre_x, centre_y, radius in zip(self.x, self.y, self.radius, strict=True):
            rise = np.clip((np.hypot(x - centre_x, y - centre_y) - radius) / self.meniscus, 0, 1)
            missing = np.maximum(missing, 1 - rise**2 * (3 - 2 * rise))  # smooth step
        return missing

    def empty(self, film: Array, x: Array, y: Array) -> Array:
        """The film [um] with the bubbles in it."""
        return film - self.lack(x, y) * (film - np.minimum(film, RESIDUAL_FILM))


def draw_bubbles(rig: RigSettings, rng: np.random.Generator) -> Bubbles:
    """Draw the bubbles of one frame: mostly small, radius 3 to 10 pixels."""
    share = rig.bubbles * rig.width * rig.height / _REFERENCE_PICTURE
    most = min(rig.bubbles, int(np.ceil(share)))
    count = int(rng.integers(0, most + 1))
    radius = _SMALLEST_BUBBLE + _BUBBLE_SPREAD * rng.uniform(size=count) ** 3
    return Bubbles(rng.uniform(0, rig.width, count), rng.uniform(0, rig.height, count), radius)


def list_pictures(rig: RigSettings) -> Triggers:
    """List the pictures of one cycle, with motion and film of each.

    The speed of a disc and of a slider is that of the surface [m/s]: 2 pi n R of the disc, and
    2 pi f s/2 cos of the slider, whose position is s/2 sin. The encoder of a slider-crank reads 0
    at the smallest angle of its rod.
    """
    if rig.mechanism == "crank-rocker":
        return list_triggers(rig)

    number = np.arange(rig.pictures)
    share = (number + _FIRST) / rig.pictures  # of a cycle
    angle = 2 * np.pi * share
    reading, zero = np.degrees(angle), 0.0
    if rig.mechanism == "slider-crank":
        speed = crank_pin_speed(angle, rig)
        time = share * cycle_time(rig)
        zero = -float(np.degrees(np.arcsin(rig.crank / rig.coupler)))
        reading = np.degrees(rocker_angle(angle, rig)) - zero
    elif rig.mechanism == "rotation":
        turns = rig.disc_speed / 60
        speed = np.full(number.size, 2 * np.pi * turns * rig.track_radius / 1e3)
        time = share / turns
    elif rig.mechanism == "sinusoidal":
        speed = np.pi * rig.frequency * rig.stroke / 1e3 * np.cos(angle)
        time = share / rig.frequency
    else:
        angle, reading, speed = np.zeros((3, number.size))
        time = number / _LASER

    return _with_film(rig, angle, speed, time, reading, zero, top=np.abs(speed).max())


def cycle_time(rig: RigSettings) -> float:
    """Time of one cycle of the motion. [s]"""
    return {
        "crank-rocker": 60 / rig.crank_speed,
        "slider-crank": 60 / rig.crank_speed,
        "rotation": 60 / rig.disc_speed,
        "sinusoidal": 1 / rig.frequency,
        "static": rig.pictures / _LASER,
    }[rig.mechanism]
