"""Sources of error of a film, and the terms among them that the frames do not show (GUM, type B).

Each class below is one entry of the list: what the source is, what lowers it, which width it has
where nobody states one, and how the logarithm of the ratio depends on its parameters. Its
docstring describes its key in [systematics]. Settings, calibrations, budgets, plans, the virtual
rig and the texts about errors are made from the list.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # the command line knows the keys without numpy
    from erlif.core.arrays import Array

_OF_FIVE = 5**-0.5  # rms of each of five changes that have an rms of 1 together


@dataclass(frozen=True)
class Where:
    """Films in a run, with all that the effect of an error on them depends on.

    Light is that over the light per um of a very thin film in band 1.

    Attributes
    ----------
    film : Array
        [um]
    slope : Array
        Derivative of the logarithm of the ratio by film. [1/um]
    change : Array
        Logarithm of the ratio of this film after the run less that before it. [1]
    light : Array
        Of band 1 at median illumination. [um]
    illumination : Array | float
        Over that of the median light. [1]
    one, two : Array
        Light of both bands. [um]
    unit : tuple[float, float]
        Light of both bands that a share of 1 stands for. [um]
    level : tuple[float, float]
        Median light of both cameras over their full scale. [1]
    by_wall : Array
        Derivative of the logarithm of the ratio by the reflectance of the wall. [1]
    by_dye_2, light_by_dye_2 : Array
        Derivatives of the logarithm of the ratio and of the light by that of the concentration of
        dye 2: it gives the light of band 2, and by what band 1 is attenuated more than band 2. [1]
    light_by_share : Array
        Derivative of the logarithm of the light by that of the film, less 1: of a film that is
        thicker, or absorbs more, by a share. [1]
    light_by_wall : Array
        Derivative of the logarithm of the light by the reflectance of the wall. [1]
    passed : Array | float
        Share of the run that has passed. [1]
    place : tuple[Array, Array] | None
        x and y in the picture, from -1 to 1; None for films anywhere in it.
    """

    film: Array
    slope: Array
    change: Array
    light: Array
    illumination: Array | float
    one: Array
    two: Array
    unit: tuple[float, float]
    level: tuple[float, float]
    by_wall: Array
    by_dye_2: Array
    light_by_dye_2: Array
    light_by_share: Array
    light_by_wall: Array
    passed: Array | float
    place: tuple[Array, Array] | None = None


class Acts(Enum):
    """How a parameter acts during a run."""

    ALWAYS = auto()
    RISING = auto()  # from nothing at the first frame
    STEPPED = auto()  # from one frame on
    BETWEEN = auto()  # known at the first and at the last frame


@dataclass(frozen=True)
class Parameter:
    """A parameter of a term.

    Attributes
    ----------
    name : str
        In records of a calibration; no other parameter has it.
    of_ratio : callable
        Derivative of the logarithm of the ratio, at full size. [1; 1/um by a length]
    of_light : callable
        Derivative of the logarithm of the light of camera 1. What changes the light of all films
        alike, or is a background, is left out.
    acts : Acts
    placed : bool
        Whether it depends on the place in the picture: it has a mean square of 1 over it.
    """

    name: str
    of_ratio: Callable[[Where], Array | float]
    of_light: Callable[[Where], Array | float] = lambda at: 0.0
    acts: Acts = Acts.ALWAYS
    placed: bool = False

    def __reduce__(self) -> tuple[Any, ...]:
        return _parameter_named, (self.name,)  # formulas without a name are not pickled


class Source:
    """A source of error of a film.

    Attributes
    ----------
    what : str
    cure : str
        What lowers it.
    file : str
        Stem of the settings file that states its standard deviation; empty: none does.
    width : float | None
        Default of this key; None: it follows from the fixture, or there is no key.
    unit : str
        Of the key, "%" or "mm".
    """

    what: str
    cure: str
    file: str = ""
    width: float | None = None
    unit: str = "%"

    def __init_subclass__(cls, *, key: str = "") -> None:
        if key:
            SOURCES[key] = cls


class Term(Source):
    """A source of error that the frames do not show.

    Attributes
    ----------
    parameters : tuple[Parameter, ...]
        Each has the width of the term.
    added : tuple[Parameter, ...]
        What a run adds to them where it shows a change.
    correlation : float
        Of its parameters, until a run measures them. [1]
    between : bool
        Whether it lies between a fixture and a run: a fixture after the run shows it.
    of_two : bool
        Whether it exists with fixtures before and after the run alone.
    apart : float | None
        Standard deviation of its change from one run to another of the same rig and fixture, in the
        unit of its width: the rest of it they have in common. None: it is new in every run.
    """

    file = "run"
    parameters: tuple[Parameter, ...]
    added: tuple[Parameter, ...] = ()
    correlation = 0.0
    between = False
    of_two = False
    apart: float | None = None


# All sources of error by their keys.
SOURCES: dict[str, type[Source]] = {}

# Changes of the ratio of all films alike: in the whole run, growing during it, from one frame on.
CONSTANT = Parameter("constant", lambda at: 1.0)
RISE = Parameter("rising constant", lambda at: 1.0, acts=Acts.RISING)
STEP = Parameter("stepped constant", lambda at: 1.0, acts=Acts.STEPPED)


class _Noise(Source, key="noise"):
    what = "noise of the frames"
    cure = "Average more frames"


class _Marks(Source, key="marks"):
    what = "marks and waviness of the surfaces"
    cure = "Polish them, or average over more of the surface"


class _Form(Source, key="form"):
    what = "form of the gap, which no smooth one has"
    cure = "Narrow the region of interest to a part that is smooth"


class _Calibration(Source, key="calibration"):
    what = "frames and profile of the fixture"
    cure = "Photograph more frames of it, or measure its profile better"


class _Ratio(Term, key="ratio"):
    """Gain, exposure and filters of the cameras between fixture and run, as a share of the
    ratio.
    """

    what = "scale of the ratio between fixture and run"
    cure = "Photograph the fixture before and after the run"
    width = 1.0
    apart = 0.3
    parameters = (CONSTANT,)
    added = (RISE, STEP)
    between = True


class _Patch(Source, key="patch"):
    what = "film of the patch that sets the ratio"
    cure = (
        "Measure its film better, choose it among the films of the run, or photograph more frames"
    )


def _over_field(name: str, shape: Callable[[Array, Array], Array]) -> Parameter:
    """A change of the ratio over the picture, of which five make one of the width of the term."""

    def of_ratio(at: Where) -> Array | float:
        return _OF_FIVE * (1.0 if at.place is None else shape(*at.place))

    return Parameter(name, of_ratio, placed=True)


class _Field(Term, key="field"):
    """Smooth change of the ratio over the picture between fixture and run, by flats and windows:
    its root mean square.
    """

    what = "flats and windows over the field"
    cure = "Take flats of both cameras from one even lamp on the day of the run, clean the windows"
    width = 0.5
    apart = 0.1
    # polynomials of Legendre up to the second degree
    parameters = (
        _over_field("field x", lambda x, y: 3**0.5 * x),
        _over_field("field y", lambda x, y: 3**0.5 * y),
        _over_field("field xx", lambda x, y: 5**0.5 * (1.5 * x**2 - 0.5)),
        _over_field("field xy", lambda x, y: 3 * x * y),
        _over_field("field yy", lambda x, y: 5**0.5 * (1.5 * y**2 - 0.5)),
    )


class _Texture(Term, key="texture"):
    # a run alone shows it, and adds its parameter
    what = "what stands still in the image"
    cure = "Clean windows and flats; take a wall of even finish"
    file = ""
    # all three make the error of a pixel; each number of a region has its own share of them
    parameters = tuple(
        Parameter(name, lambda at: 3**-0.5)
        for name in ("texture", "texture_second", "texture_third")
    )


class _Lag(Term, key="lag"):
    """Light of the last frame that a camera keeps, as a share of the ratio."""

    what = "lag of the cameras"
    cure = "Measure it with a flat and the lamp switched off, and state it"
    width = 0.5
    apart = 0.0
    parameters = (CONSTANT,)


class _Temperature(Term, key="temperature"):
    """Change of the ratio by the temperature of the oil: between fixture and run, and again from
    the first frame of the run to the last.
    """

    what = "temperature of the oil"
    cure = "Hold it, and photograph the fixture at the temperature of the run"
    width = 0.5
    parameters = (CONSTANT, RISE)
    between = True


class _Followed(Source, key="followed"):
    what = "temperature of the oil, corrected by its log"
    cure = "State the change with temperature in [temperature] better, or hold the temperature"


class _Bleaching(Term, key="bleaching"):
    """Change of the ratio by bleaching from the first frame of the run to the last."""

    what = "bleaching"
    cure = "Photograph the fixture after the run, or a patch of known film"
    width = 1.0
    parameters = (
        RISE,
        Parameter(
            "rising absorption",
            lambda at: -at.film * at.slope,
            lambda at: -at.light_by_share,
            Acts.RISING,
        ),
    )
    between = True


class _Batch(Term, key="batch"):
    """Concentrations of the dyes in the oil of the run over those in the oil of the fixture, of
    both dyes together and of dye 2 alone. "0 %": one batch fills both.
    """

    what = "concentrations of the dyes"
    cure = "Fill fixture and joint from one batch, and state it"
    width = 0.5
    parameters = (
        Parameter("dye 2", lambda at: at.by_dye_2, lambda at: at.light_by_dye_2),
        Parameter("dyes", lambda at: at.film * at.slope, lambda at: at.light_by_share),
    )


class _Wall(Term, key="wall"):
    """Difference between the reflectance of the walls of fixture and joint."""

    what = "reflectance of the wall"
    cure = "Make fixture and joint of one material and finish, or state what both reflect"
    width = 2.0
    apart = 0.2
    parameters = (Parameter("wall", lambda at: at.by_wall, lambda at: at.light_by_wall),)


class _Linearity(Term, key="linearity"):
    """Light that each camera loses or gains at full scale in the run, against the fixture."""

    what = "linearity of the cameras"
    cure = "Photograph flats at several levels of light, and state it"
    width = 1.0
    apart = 0.0
    parameters = (
        Parameter(
            "light 1",
            lambda at: -at.level[0] * at.one / at.unit[0],
            lambda at: -at.level[0] * at.illumination * at.light / at.unit[0],
        ),
        Parameter("light 2", lambda at: at.level[1] * at.two / at.unit[1]),
    )


class _Background(Term, key="background"):
    """Light that is not film, as a share of the median light of the run, with a correlation of 0.9
    between the bands. With frames of the dry joint, what they leave counts.
    """

    what = "light that is not film"
    cure = "Photograph the dry joint (8 frames)"
    width = 1.5
    apart = 0.3
    parameters = (
        Parameter("background 1", lambda at: -at.unit[0] / at.one),
        Parameter("background 2", lambda at: at.unit[1] / at.two),
    )
    correlation = 0.9  # light of a window or through a filter changes little from 580 to 610 nm


class _DryJoint(Source, key="energy"):
    """Mean pulse energy of the frames of the dry joint, over that of the run."""

    what = "light of the dry joint"
    cure = "State how well the energy of its pulses is known: energy in [systematics]"
    file = "run"
    width = 5.0


class _Position(Term, key="position"):
    """Origin of the profile on the fixture, along the profile. Default: one pixel, and nothing
    where align determines it.
    """

    what = "position of the fixture"
    cure = "Make a mark on it and state its place, or choose a form that align finds"
    file = "fixture"
    unit = "mm"
    parameters = (Parameter("position", lambda at: at.slope),)


class _Size(Term, key="size"):
    """Scale of the thickness of the fixture, as a share of it."""

    what = "scale of the fixture"
    cure = "State the error of its thickness"
    file = "fixture"
    width = 0.5
    parameters = (Parameter("size", lambda at: at.film * at.slope, lambda at: at.light_by_share),)


class _Course(Term, key="course"):
    """Departure of the change between the fixtures before and after the run from a straight line,
    in the middle of the run, as a share of the change. At 7 % it begins 1.3 and ends 0.7 times as
    fast as its mean.
    """

    what = "course of the change between both fixtures"
    cure = "Photograph the fixture once more during the run, and process its parts"
    width = 7.0
    parameters = (Parameter("course", lambda at: at.change, acts=Acts.BETWEEN),)
    of_two = True


class _Later(Term, key="later"):
    # of the curve of that fixture, beyond the error of the one before it
    what = "frames of the fixture after the run"
    cure = "Photograph more frames of it"
    file = ""
    parameters = (RISE,)
    of_two = True


# Sources that the frames do not show, in the order in which a calibration has their parameters.
TERMS = {key: source for key, source in SOURCES.items() if issubclass(source, Term)}

# Parameters by the key of their term and their name, those included that a run adds.
PARAMETERS = {
    (key, parameter.name): parameter
    for key, term in TERMS.items()
    for parameter in (*term.parameters, *term.added)
}


# Keys in the order in which films have recorded them from the first version on; others follow.
_RECORDED = ("ratio", "background", "energy", "bleaching", "temperature", "wall", "linearity")


def keys_in(file: str) -> dict[str, type[Source]]:
    """Sources whose standard deviation is a key of [systematics].

    Parameters
    ----------
    file : str
        Stem of the settings file, "run" or "fixture".

    Returns
    -------
    dict of str to type of Source

    Examples
    --------
    >>> list(keys_in("fixture"))
    ['position', 'size']
    """
    return {key: SOURCES[key] for key in (*_RECORDED, *SOURCES) if SOURCES[key].file == file}


def _parameter_named(name: str) -> Parameter:
    return next(one for one in PARAMETERS.values() if one.name == name)
