"""From plan.toml to what a rig would measure: light, ratio, uncertainty, range, optimum."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.described import Columns, describe
from erlif.core.errors import ConfigError
from erlif.core.tables import read_table
from erlif.core.units import Quantity
from erlif.io.settings import (
    DyeSettings,
    PlanSettings,
    read_plan_settings,
    settings_of,
    to_toml,
    write_example,
)
from erlif.planning import (
    Design,
    Dye,
    FilteredCamera,
    Optimum,
    Spectrum,
    WantedFilm,
    band_of,
    calibrated_range,
    find_optimum,
    frames_needed,
    largest_error,
    log_ratio,
    log_ratio_slope,
    mean_attenuation,
    measurable_range,
    normalise_emission,
    optical_thickness,
    read_spectrum,
    saturation_fluence,
    scale_of_optics,
    scaled_to,
    signal,
    synthetic_spectra,
    thickness_std,
    vary_tolerances,
)
from erlif.planning.limit import attainable_errors
from erlif.planning.target import shortest_list
from erlif.rig import DyeSpectra, RigSettings
from erlif.rig.settings import LIMITS

# Films at which a plan is tabulated.
FILMS = 161

_BEYOND = (0.4, 1.6)  # of the thinnest and the thickest wanted film: ends of the table
_PLACES = 10001  # along the axis of a bore
_MICRO, _MILLI = 1e6, 1e3
_DIGITS = 3  # significant digits of a proposed concentration
_RIG_STEP = 0.25  # nm: spectra that the virtual rig is given


def example_plan() -> str:
    """Write a commented plan.toml that works as it is.

    Returns
    -------
    str
        TOML.

    Examples
    --------
    >>> example_plan().count("[dye1]")
    1
    """
    return write_example(PlanSettings, "erlif.planning", "plan.toml", leave_out=["optics"])


def plan(source: Path | str | PlanSettings, *, folder: Path | None = None) -> xr.Dataset:
    """Predict what a rig would measure.

    Parameters
    ----------
    source : Path or PlanSettings
        The file plan.toml, or its tables.
    folder : Path, optional
        Directory of the files of spectra. Default: that of plan.toml.

    Returns
    -------
    xarray.Dataset
        Over ``thickness``: ratio, signal of each ``camera``, standard deviation of a pixel for one
        frame and for the frames of the plan, frames needed. Over ``dye``: concentrations as
        planned and the best ones, whose variables begin with ``optimum``. Over ``bound``: ranges.
        Over ``tolerance``: the effect of each tolerance, the largest first. Over ``limit`` and
        ``limit_film``: errors that no frame shows, by their widths and with the gap of the joint.
        With a bore in [joint], ``bore_length`` and ``bore_thickest`` of the films over it.
        Over ``remedy`` and ``target_film``: what the shortest list of remedies leaves of them.

    Raises
    ------
    ConfigError
        If the plan or a spectrum cannot be used.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as directory:
    ...     path = Path(directory, "plan.toml")
    ...     _ = path.write_text(example_plan(), encoding="utf-8")
    ...     planned = plan(path)
    >>> planned.measurable_range.values.round(1)
    array([ 0.8, 12.7])
    """
    settings, folder = settings_of(source, read_plan_settings, folder)
    design, film = design_of(settings, folder), film_of(settings)
    largest = float(settings.optimum.largest_concentration)
    best = find_optimum(design, film, largest=largest, fill=settings.optimum.fill)

    low, high = film.thinnest * _BEYOND[0], film.thickest * _BEYOND[1]
    films = np.geomspace(low, high, FILMS)
    planned = _describe_design(design, film, films, settings.film.uncertainty)
    improved = _describe_design(best.design, film, films, settings.film.uncertainty)
    for name, variable in improved.items():
        planned[f"optimum_{name}"] = variable.assign_attrs(
            long_name=f"{variable.attrs['long_name']}, best concentrations"
        )
    planned = planned.merge(_describe_tolerances(design, film, settings))
    planned = planned.merge(_describe_limit(design, film, settings))
    planned = planned.merge(_describe_bore(planned.measurable_range_frames.values, settings))
    planned.attrs = {
        "title": settings.name,
        "uncertainty": settings.film.uncertainty,
        "frames": film.frames,
        "average": film.average,
        "corner": design.corner,
        "synthetic": int(any(dye.spectra for dye in (settings.dye1, settings.dye2))),
        "optimum_limited_by_solubility": [int(limit) for limit in best.at_limit],
        "settings": to_toml(settings),
        "optimum_settings": to_toml(best_settings(settings, best)),
        **_describe_pulse(settings, design),
    }
    return planned


# settings to design


def design_of(settings: PlanSettings, folder: Path) -> Design:
    """Read the spectra of a plan and bring its light to one scale.

    Parameters
    ----------
    settings : PlanSettings
    folder : Path
        Directory of the files of spectra.

    Returns
    -------
    Design

    Raises
    ------
    ConfigError
        If a spectrum cannot be read or does not cover laser and filters, or if the ratio of the
        design does not rise with thickness.

    Examples
    --------
    >>> import tomllib
    >>> settings = PlanSettings.model_validate(tomllib.loads(example_plan()))
    >>> design_of(settings, Path()).concentrations
    array([0.008, 0.024])
    """
    bands = (float(settings.camera1.band), float(settings.camera2.band))
    wavelengths = (float(settings.laser.wavelength), *bands)
    cameras = tuple(
        FilteredCamera(
            band=float(camera.band),
            bandwidth=float(camera.bandwidth),
            gain=float(camera.gain),
            read_noise=float(camera.read_noise),
            full_well=float(camera.full_well or math.inf),
            counts=(1 << camera.bit_depth) - 1 - float(camera.offset),
        )
        for camera in (settings.camera1, settings.camera2)
    )

    # what cannot be planned is refused before the scale of the light is looked for
    design = Design(
        dyes=(
            _dye_of(settings.dye1, 1, folder, wavelengths),
            _dye_of(settings.dye2, 2, folder, wavelengths),
        ),
        cameras=cameras,
        laser=wavelengths[0],
        references=settings.references,
        corner=settings.laser.corner,
    )
    _refuse_useless(design)
    return _with_scales(design, settings)


def _dye_of(
    dye: DyeSettings, number: int, folder: Path, wavelengths: tuple[float, float, float]
) -> Dye:
    """Spectra of one dye, from wherever the plan has them."""
    which = f"dye {number}"
    if dye.spectra is not None:
        absorption, emission = synthetic_spectra(dye.spectra)
    elif dye.coefficients is not None:
        given = dye.coefficients
        absorption = Spectrum(
            np.array(wavelengths),
            np.array([given.laser, given.camera1, given.camera2], float),
            f"absorption of {which}",
            narrow=True,
        )
        emission = Spectrum(
            np.array(wavelengths[1:]),
            np.array([given.emission1, given.emission2], float),
            f"emission of {which}",
            narrow=True,
        )
    else:
        assert dye.absorption is not None
        assert dye.emission is not None
        absorption = read_spectrum(folder / dye.absorption, f"absorption of {which}")
        emission = normalise_emission(read_spectrum(folder / dye.emission, f"emission of {which}"))
    return Dye(float(dye.concentration), dye.quantum_yield, absorption, emission)


def _refuse_useless(design: Design) -> None:
    """Refuse dyes without light or reabsorption, and exchanged cameras."""
    for number in (1, 2):
        if band_of(design, number).weight.sum() <= 0:
            raise ConfigError(
                f"Expected light of the dyes in the band of camera {number}, "
                f"{design.cameras[number - 1].band:g} nm; there is none. Choose another filter, or "
                "correct the emission of the dyes."
            )
    p, q = (mean_attenuation(design, number) for number in (1, 2))
    if p <= q:
        raise ConfigError(
            "Expected the light of camera 1 to be reabsorbed more than that of camera 2; their "
            f"attenuations are {p:.4g} and {q:.4g} 1/um, so that the ratio would not rise with "
            "thickness. Exchange the filters, or choose others."
        )


def _with_scales(design: Design, settings: PlanSettings) -> Design:
    """The design with the scale of each camera, measured or from optics."""
    known = scaled_to(
        design,
        (float(settings.camera1.thick_film or 1.0), float(settings.camera2.thick_film or 1.0)),
    )
    cameras = list(known.cameras)
    for n, camera in enumerate((settings.camera1, settings.camera2)):
        if camera.thick_film is None:
            assert settings.optics is not None
            assert settings.laser.beam_diameter is not None
            assert camera.efficiency is not None
            scale = scale_of_optics(
                pulse_energy=float(settings.laser.pulse_energy),
                wavelength=float(settings.laser.wavelength),
                beam_diameter=float(settings.laser.beam_diameter),
                pixel_pitch=float(settings.optics.pixel_pitch),
                numerical_aperture=settings.optics.numerical_aperture,
                refractive_index=settings.optics.refractive_index,
                efficiency=camera.efficiency,
            )
            cameras[n] = replace(cameras[n], scale=scale)
    return replace(known, cameras=tuple(cameras))


def film_of(settings: PlanSettings) -> WantedFilm:
    """Return the films of a plan in um.

    >>> import tomllib
    >>> film_of(PlanSettings.model_validate(tomllib.loads(example_plan()))).covered
    (0.1, 18.0)
    """
    film = settings.film
    low, high = settings.covered
    return WantedFilm(
        _um(film.thinnest), _um(film.thickest), (_um(low), _um(high)), film.frames, film.average
    )


def _um(length: float) -> float:
    """A length in um without the rounding of the conversion."""
    return round(float(length) * 1e6, 9)


def best_settings(settings: PlanSettings, best: Optimum) -> PlanSettings:
    """Return a plan with the best concentrations, rounded, and the light that belongs to them.

    >>> import tomllib
    >>> settings = PlanSettings.model_validate(tomllib.loads(example_plan()))
    >>> design = design_of(settings, Path()).with_concentrations((0.00517, 0.0476))
    >>> better = best_settings(settings, Optimum(design, 0.10, at_limit=(False, False)))
    >>> better.dye2.concentration.text
    '0.0476 mol/L'
    """
    design = best.design

    def quantity(value: float, unit: str, digits: int = _DIGITS, of_si: float = 1.0) -> Quantity:
        text = f"{of_si * value:.{digits}g}"
        return Quantity(float(text) / of_si, f"{text} {unit}")

    energy = quantity(float(settings.laser.pulse_energy) * design.energy, "mJ", 4, of_si=1e3)
    changed: dict[str, Any] = {"laser": settings.laser.model_copy(update={"pulse_energy": energy})}
    for number, dye in enumerate((settings.dye1, settings.dye2), start=1):
        value = float(design.concentrations[number - 1])
        changed[f"dye{number}"] = dye.model_copy(update={"concentration": quantity(value, "mol/L")})
    for number, camera in enumerate((settings.camera1, settings.camera2), start=1):
        if camera.thick_film is not None:
            thick = _thick_film(design, number)
            changed[f"camera{number}"] = camera.model_copy(
                update={"thick_film": quantity(thick, "electron", 5)}
            )
    return settings.model_copy(update=changed)


def _thick_film(design: Design, number: int) -> float:
    """Signal of a very thick film. [electron]"""
    return float(signal(design, number, _very_thick(design, number)))


def _very_thick(design: Design, number: int) -> float:
    """A film whose light in the band of a camera no longer changes. [um]"""
    return 50 / float(band_of(design, number).attenuation.min())


# design to dataset


def _describe_design(
    design: Design, film: WantedFilm, films: Array, uncertainty: float
) -> xr.Dataset:
    """Curves over the thickness, ranges and numbers of one design."""
    average, wanted = film.average, uncertainty * films
    reabsorption, absorption = optical_thickness(design)
    described = _as_variables(
        ratio=np.exp(log_ratio(design, films)),
        log_ratio_slope=log_ratio_slope(design, films),
        signal=np.stack([signal(design, number, films) for number in (1, 2)]),
        full_scale=[camera.full_scale for camera in design.cameras],
        thickness_std=thickness_std(design, films),
        thickness_std_frames=thickness_std(design, films, frames=film.frames, average=average),
        frames_needed=frames_needed(design, films, wanted, average=average),
        # ranges and numbers
        measurable_range=measurable_range(design, replace(film, frames=1)),
        measurable_range_frames=measurable_range(design, film),
        calibrated_range=calibrated_range(design, film),
        concentration=design.concentrations,
        pulse_energy=design.energy,
        attenuation_camera1=mean_attenuation(design, 1),
        attenuation_camera2=mean_attenuation(design, 2),
        ratio_at_zero=np.exp(log_ratio(design, 1e-6)),
        ratio_thick=np.exp(log_ratio(design, _very_thick(design, 2))),
        reabsorption=reabsorption,
        absorption=absorption,
        largest_error=largest_error(design, film),
    )
    return described.assign_coords(
        thickness=("thickness", films, {"units": "um", "long_name": "film thickness"}),
        camera=("camera", [1, 2], {"long_name": "camera"}),
        dye=("dye", [1, 2], {"long_name": "dye"}),
        bound=("bound", ["thinnest", "thickest"]),
    )


def _as_variables(**values: Any) -> xr.Dataset:
    """Values by name, with the dimensions, unit and meaning that the table gives them."""
    table = read_table("erlif.planning", "plan.toml")["variables"]
    columns: Columns = {}
    for name, value in values.items():
        dims, unit, meaning = table[name]
        columns[name] = (tuple(dims.split()), np.asarray(value, float), unit, meaning)
    return describe(columns, {})


def _describe_tolerances(design: Design, film: WantedFilm, settings: PlanSettings) -> xr.Dataset:
    """The effect of each tolerance, the largest first; and the two ranges of the plan."""
    sizes = {name: float(value) for name, value in settings.tolerances}
    changes = vary_tolerances(design, film, sizes)
    described = _as_variables(
        **{
            f"tolerance_{part}": [getattr(change, part) for change in changes]
            for part in ("std", "thinnest", "thickest", "film")
        }
    ).assign_coords(tolerance=[change.what for change in changes])

    # the size is text with its unit, as the unit differs from part to part
    of_parts = [change.tolerance for change in changes]
    described["tolerance_size"] = ("tolerance", of_parts, {"long_name": "tolerance"})
    ranges = _as_variables(film_range=(film.thinnest, film.thickest), covered_range=film.covered)
    return described.merge(ranges)


def _describe_limit(design: Design, film: WantedFilm, settings: PlanSettings) -> xr.Dataset:
    """Dataset of the systematic errors, without and with the known gap of a joint."""
    widths = {key: width / 100 for key, width in settings.systematics}
    had = frozenset(key for key, has in settings.remedies if has)
    systematics, covariance, errors = attainable_errors(design, film, widths, settings.joint)
    errors = replace(errors, covariance=errors.lowered(had), had=had)
    terms = list(dict.fromkeys(systematics.terms))
    values = {"limit_std": systematics.covariance, "limit_std_gap": covariance}
    variables: dict[str, Array] = {
        name: np.array([np.sqrt(np.diag(each)[systematics.places(term)].max()) for term in terms])
        for name, each in values.items()
    }
    without = replace(errors, information=None)
    variables |= {"limit_film_std": without.std()[:-1], "limit_film_std_gap": errors.std()[:-1]}
    if settings.joint is None:
        variables = {name: each for name, each in variables.items() if not name.endswith("gap")}
    films = ("limit_film", errors.films[:-2], {"units": "um", "long_name": "film thickness"})
    described = _as_variables(**variables).assign_coords(limit=terms, limit_film=films)
    return described.assign(target_std=shortest_list(errors, (settings.film.uncertainty, 0.0)))


def _describe_bore(measurable: Array, settings: PlanSettings) -> xr.Dataset:
    """The films along the load line over a bore that is not straight; the pin is parallel."""
    joint = settings.joint
    if joint is None or joint.bore is None or joint.length is None:
        return xr.Dataset()
    whole = np.linspace(-0.5, 0.5, _PLACES) * joint.length
    crest = joint.bore.shape(whole, joint.length).min()
    start, end = joint.field
    above = _MICRO * (joint.bore.shape(np.linspace(start, end, _PLACES), joint.length) - crest)
    films = _MICRO * np.array([[settings.film.thinnest], [settings.film.thickest]]) + above
    field = _MILLI * (end - start)
    inside = (films >= measurable[0]) & (films <= measurable[1])
    return _as_variables(
        bore_thickest=films.max(axis=1),
        bore_length=field * inside.mean(axis=1),
        field_length=field,
    )


def _describe_pulse(settings: PlanSettings, design: Design) -> dict[str, float]:
    """Fluence of a pulse and that at which the dyes saturate, where the beam is known. [J/cm2]"""
    diameter = settings.laser.beam_diameter
    if diameter is None:
        return {}
    area = math.pi / 4 * (100 * float(diameter)) ** 2
    return {
        "pulse_fluence": float(settings.laser.pulse_energy) / area,
        "saturation_fluence": saturation_fluence(design),
    }


# to the virtual rig


def rig_of(source: Path | str | PlanSettings, *, folder: Path | None = None) -> RigSettings:
    """Return the virtual rig of a plan: its dyes, filters, light, cameras and films at rest.

    The film rises over the height of the picture through the wanted range; the wedge covers the
    films of the fixture. The virtual rig shares no code with the prediction.

    Arguments as in `plan`.

    Returns
    -------
    RigSettings

    Raises
    ------
    ConfigError
        If the plan cannot be used, or has cameras that the virtual rig does not have.

    Examples
    --------
    >>> import tomllib
    >>> rig = rig_of(PlanSettings.model_validate(tomllib.loads(example_plan())))
    >>> rig.mechanism, rig.wedge, [round(light) for light in rig.thick_film_signal]
    ('static', (0.1, 18.0), [11000, 11500])
    """
    settings, folder = settings_of(source, read_plan_settings, folder)
    design, film = design_of(settings, folder), film_of(settings)
    one, two = settings.camera1, settings.camera2
    alike = ("gain", "read_noise", "offset", "bit_depth", "full_well")
    other = [key for key in alike if getattr(one, key) != getattr(two, key)]
    if other or one.bit_depth != 12:
        fault = f"{', '.join(other)} differ" if other else f"bit_depth is {one.bit_depth}"
        raise ConfigError(
            "Expected two cameras of one kind with 12 bits, as the virtual rig has; in the plan "
            f"{fault}. Make [camera1] and [camera2] alike for the rehearsal."
        )

    standard = RigSettings()
    height = standard.height * standard.pitch
    (_, (top, bottom)) = standard.region
    span = film.thickest - film.thinnest
    largest = LIMITS["tilt"][1] * (bottom - top) / height
    if span > largest:
        raise ConfigError(
            f"Expected films that differ by at most {largest:.0f} um, as far as the virtual rig "
            f"can tilt; those of the plan differ by {span:.4g} um. Choose a part of the range."
        )
    # a pin that leaves the film nearly even along x: 0.2 of the range at the edges
    radius = (1e3 * (standard.field_width / 2) ** 2) / (2 * 0.2 * span)
    pages = settings.references
    return replace(
        standard,
        mechanism="static",
        pictures=1,
        cycles=film.frames,
        dyes=_spectra_of(design),
        thick_film_signal=(_thick_film(design, 1), _thick_film(design, 2)),
        gain=float(one.gain),
        read_noise=float(one.read_noise),
        offset=float(one.offset),
        full_well=None if one.full_well is None else float(one.full_well),
        film_reference=film.thinnest,
        film_floor=min(standard.film_floor, film.thinnest),
        tilt=span * height / (bottom - top),
        bushing_radius=standard.pin_radius / (1 - standard.pin_radius / radius),
        wedge=film.covered,
        beam_corner=design.corner,
        vignetting=(1.0, 1.0),  # the light at the corners is that of beam and lens
        bubbles=0,
        dark_pages=pages.dark_pages,
        flat_pages=max(1, round(pages.flat_pages / len(standard.flat_levels))),
    )


def _spectra_of(design: Design) -> DyeSpectra:
    """Spectra at the laser and around both filters, as the virtual rig takes them."""
    pieces = [np.array([design.laser])]
    for camera in design.cameras:
        reach = camera.bandwidth / 2 + 7.0  # nm: the rig's filters have soft edges
        pieces.append(np.arange(camera.band - reach, camera.band + reach + _RIG_STEP, _RIG_STEP))
    wavelength = np.unique(np.concatenate(pieces))

    attenuation, emission = [], []
    for dye in design.dyes:
        inside = [
            np.clip(wavelength, *(spectrum.wavelength[[0, -1]]))
            if not spectrum.narrow
            else wavelength
            for spectrum in (dye.absorption, dye.emission)
        ]
        attenuation.append(tuple(dye.attenuation(inside[0]).tolist()))
        light = float(dye.attenuation(design.laser)) * dye.quantum_yield
        emission.append(tuple((light * dye.emission.at(inside[1])).tolist()))
    return DyeSpectra(
        laser=design.laser,
        bands=(design.cameras[0].band, design.cameras[1].band),
        bandwidth=(design.cameras[0].bandwidth, design.cameras[1].bandwidth),
        wavelength=tuple(wavelength.tolist()),
        attenuation=(attenuation[0], attenuation[1]),
        emission=(emission[0], emission[1]),
    )


def moved_settings(text: PlanSettings, source: Path, output: Path) -> PlanSettings:
    """Return a plan whose files of spectra and bore, named from `source`, are named from `output`.

    >>> import tomllib
    >>> settings = PlanSettings.model_validate(tomllib.loads(example_plan()))
    >>> moved_settings(settings, Path("a"), Path("a/results")) == settings
    True
    """

    def moved_to(name: str) -> str:
        return Path(os.path.relpath(source / name, output)).as_posix()

    changed: dict[str, Any] = {}
    for name in ("dye1", "dye2"):
        dye: DyeSettings = getattr(text, name)
        if dye.absorption is not None and dye.emission is not None:
            moved = {key: moved_to(getattr(dye, key)) for key in ("absorption", "emission")}
            changed[name] = dye.model_copy(update=moved)
    joint = text.joint
    if joint is not None and joint.bore is not None and joint.bore.profile is not None:
        bore = joint.bore.model_copy(update={"profile": moved_to(joint.bore.profile)})
        changed["joint"] = joint.model_copy(update={"bore": bore})
    return text.model_copy(update=changed)
