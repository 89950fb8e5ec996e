"""Kinds of values of a settings file, and the base of its tables.

A quantity is written as text with a unit and kept as a float in the unit of its type (`Form.unit`):
SI, but nm for a band, electrons and DN for a camera, degC for Vogel's temperature. Its text is kept
with it (`Quantity`), so that settings are stored as the user wrote them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le, MinLen
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    StrictFloat,
    ValidationError,
    WithJsonSchema,
    WrapValidator,
    model_validator,
)

from erlif.core.units import Quantity, parse_quantity


@dataclass(frozen=True)
class Form:
    """Form of a value in a settings file; part of the type of a field.

    Attributes
    ----------
    name : str
        Kind of value, "length" or "file name".
    example : Any
        Value as a user writes it.
    unit : str
        Unit in which a quantity is kept, in pint's spelling; empty for other values.
    """

    name: str
    example: Any
    unit: str = ""


# A number and a unit, for the JSON schema; `erlif.core.units.parse_quantity` checks the unit.
QUANTITY_PATTERN = (
    r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?"  # the number
    r"\s*(1\s*/\s*)?[^0-9\s.,?].*$"  # the unit, as in "mm" or "1/GPa"
)


def _write_quantity(value: float, unit: str) -> str:
    """A quantity as the user wrote it, or the shortest decimal number in its unit."""
    return (
        value.text if isinstance(value, Quantity) else f"{value!r}".removesuffix(".0") + f" {unit}"
    )


def quantity(
    name: str,
    example: str,
    unit: str,
    *bounds: Gt | Ge | Le,
    between: tuple[str, ...] = (),
    words: tuple[str, ...] = (),
    positive: bool = False,
) -> Any:
    """Annotations of a field that is written with its unit and kept as a float in `unit`.

    A value beyond the range `between` is refused with both ends as they are written here. With
    `words` the field may hold one of these in place of a quantity; `positive` then stands for a
    bound, and its refusal names them.
    """
    listed = ", ".join(f'"{word}"' for word in words)
    form = f"{name} from {' to '.join(between)}" if between else name

    def read(text: object) -> float:
        value = parse_quantity(text, unit)
        ends = [parse_quantity(end, unit) for end in between]
        if ends and not ends[0] <= value <= ends[1]:
            raise ValueError(f"expected {' to '.join(between)}; got {text!r}")
        if positive and value <= 0:
            raise ValueError(f"expected {listed} or a {name} above 0; got {text!r}")
        return value

    def keep(text: Any, check: Any) -> Any:
        if words and isinstance(text, str) and not any(sign.isdigit() for sign in text):
            if text in words:
                return text
            raise ValueError(f"expected {listed} or a {name} such as {example!r}; got {text!r}")
        return Quantity(check(text), " ".join(text.split()))

    pattern = f"^({'|'.join(words)})$|{QUANTITY_PATTERN}" if words else QUANTITY_PATTERN
    # Bounds are checked on the converted float. The schema is last: it replaces what pydantic would
    # derive from the float, since the file holds text.
    return (
        BeforeValidator(read),
        *bounds,
        WrapValidator(keep),
        PlainSerializer(
            lambda value: value if isinstance(value, str) else _write_quantity(value, unit),
            return_type=str,
        ),
        WithJsonSchema({"type": "string", "pattern": pattern, "examples": [example]}),
        Form(f"{name}, or {listed}" if words else form, example, unit),
    )


Length = Annotated[float, *quantity("length", "5.5 cm", "m", Gt(0))]
CurvatureRadius = Annotated[
    float, *quantity("radius, negative where the body is hollow", "9.5 mm", "m")
]
Distance = Annotated[float, *quantity("length, or 0 mm", "0.06 mm", "m", Ge(0))]
Angle = Annotated[float, *quantity("angle", "0 deg", "rad")]
Speed = Annotated[float, *quantity("speed of rotation", "114 rpm", "rad/s", Gt(0))]
Frequency = Annotated[float, *quantity("frequency", "5 Hz", "Hz", Gt(0))]
Force = Annotated[float, *quantity("force", "50 lbf", "N", Gt(0))]
Pressure = Annotated[float, *quantity("pressure", "2.7 GPa", "Pa", Gt(0))]
Viscosity = Annotated[float, *quantity("dynamic viscosity", "0.12 Pa s", "Pa s", Gt(0))]
PressureViscosity = Annotated[
    float, *quantity("pressure-viscosity coefficient", "20 1/GPa", "1/Pa", Ge(0))
]
Wavelength = Annotated[float, *quantity("wavelength", "580 nm", "nm", Gt(0))]
# wavelengths that cameras and filters cover: a band in um in place of nm is no light
Band = Annotated[float, *quantity("wavelength", "580 nm", "nm", between=("200 nm", "2000 nm"))]
# pixels in the object plane, from those of a microscope to an image of metres
PixelPitch = Annotated[float, *quantity("length", "60 um", "m", between=("50 nm", "5 mm"))]
Counts = Annotated[float, *quantity("counts", "64 DN", "DN", Ge(0))]
Gain = Annotated[float, *quantity("gain", "4.4 electron/DN", "electron/DN", Gt(0))]
Electrons = Annotated[float, *quantity("electrons", "9 electron", "electron", Gt(0))]
Temperature = Annotated[float, *quantity("temperature", "-115 degC", "degC")]
TemperatureDifference = Annotated[
    float, *quantity("temperature difference", "1100 K", "delta_degC", Gt(0))
]


# a standard deviation as a share, kept in per cent
Share = Annotated[float, *quantity("share", "1 %", "%", between=("0 %", "50 %"))]
TemperatureCoefficient = Annotated[
    float, *quantity("relative change with temperature", "-0.2 %/K", "%/K")
]
TemperatureCoefficientStd = Annotated[
    float, *quantity("relative change with temperature", "0.02 %/K", "%/K", Ge(0))
]
TemperatureStd = Annotated[float, *quantity("temperature difference", "1 K", "delta_degC", Ge(0))]
Reflectance = Annotated[float, *quantity("share", "30 %", "%", between=("0 %", "100 %"))]
Start = Annotated[float | Literal["fit"], *quantity("time", "0.25 s", "s", words=("fit",))]
StartFilm = Annotated[
    float | Literal["fit"], *quantity("length", "20 um", "m", words=("fit",), positive=True)
]
Sideways = Annotated[
    float | Literal["free", "guided"],
    *quantity("stiffness", "12 N/mm", "N/m", words=("free", "guided"), positive=True),
]
Place = Annotated[float, *quantity("position", "9.6 mm", "m")]
Places = Annotated[tuple[Place, ...], Form("list of positions", ["-50 mm", "50 mm"])]
Points = Annotated[
    tuple[tuple[float, float], ...], Form("list of points [mm, um]", [[-15, 0], [15, 2.5]])
]
CavitationPressure = Annotated[
    float, *quantity("pressure below ambient", "-100 kPa", "Pa", Ge(-101325), Le(0))
]

Interval = Annotated[tuple[float, float], Form("interval [low, high] in mm", [4, 15])]

NO_CONTROL_CHARACTERS = r"^[^\x00-\x1f\x7f]*$"

Text = Annotated[str, Field(pattern=NO_CONTROL_CHARACTERS), Form("text", "straight bushing 1")]
FileName = Annotated[
    str,
    Field(min_length=1, pattern=NO_CONTROL_CHARACTERS),
    Form("file name or pattern", "camera1/*.tif"),
]


def _read_exclusions(entries: Any, check: Any) -> Any:
    """One message for all that is neither a name nor a polygon."""
    try:
        return check(entries)
    except ValidationError:
        raise ValueError(
            "expected a list of mask images and polygons, each of three or more corners [x, y] in "
            f'mm, such as ["mask.png", [[4, 2], [6, 2], [5, 4]]]; got {entries!r}'
        ) from None


Polygon = Annotated[tuple[tuple[StrictFloat, StrictFloat], ...], MinLen(3)]
Exclusions = Annotated[
    tuple[FileName | Polygon, ...],
    WrapValidator(_read_exclusions),
    Form("list of mask images and polygons in mm", ["mask.png", [[4, 2], [6, 2], [5, 4]]]),
]

CalibrationNames = Annotated[
    FileName | tuple[FileName, FileName],
    Form("file name, or two of them", "../fixture/calibration.nc"),
]

ColumnName = Annotated[
    str, Field(min_length=1, pattern=NO_CONTROL_CHARACTERS), Form("column", "Encoder [deg]")
]

# Units of the columns of a log; the first of a quantity is that of films.
AngleUnit = Literal["deg", "rad", "mrad", "turn", "tick"]
TimeUnit = Literal["s", "ms", "us", "ns", "min", "h"]
ForceUnit = Literal["N", "kN", "mN", "lbf", "kgf", "gf"]
TemperatureUnit = Literal["degC", "K", "degF"]
TorqueUnit = Literal["N m", "kN m", "N mm", "lbf ft", "lbf in"]
SpeedUnit = Literal["rad/s", "rpm", "deg/s", "rev/s", "m/s", "mm/s"]
PulseEnergyUnit = Literal["mJ", "J", "uJ", "V", "1"]


class Settings(BaseModel):
    """A table of a settings file: frozen, and closed to keys it does not know."""

    # a misspelt key must not pass unnoticed, and NaN must not reach the physics
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def faults(self) -> Iterator[str]:
        """Yield contradictions between the keys of the table, each as a complete message."""
        yield from ()

    @model_validator(mode="after")
    def _has_no_fault(self) -> Self:
        fault = next(self.faults(), None)
        if fault is not None:
            raise ValueError(fault)
        return self
