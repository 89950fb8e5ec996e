"""Mechanism, encoder and joint of a run, from its settings."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from erlif.core.errors import ConfigError
from erlif.io.ingest import Run
from erlif.io.settings import (
    CrankRockerSettings,
    EncoderSettings,
    JointSettings,
    MaterialSettings,
    OilSettings,
    RotationSettings,
    RunSettings,
    SinusoidalSettings,
    SliderCrankSettings,
)
from erlif.kinematics import (
    Encoder,
    Mechanism,
    Sinusoid,
    TurningDisc,
    entrained_stroke,
    locate_frames,
    locate_logged,
    locate_rotation,
    locate_slider,
)
from erlif.models.mechanism import CrankRocker, SliderCrank
from erlif.trend import LubricatedContact, LubricatedJoint, Solid, VogelLaw


def build_linkage(links: CrankRockerSettings | SliderCrankSettings) -> Mechanism:
    """The linkage of [mechanism]; raises ModelError where its crank cannot turn (Grashof)."""
    if isinstance(links, SliderCrankSettings):
        return SliderCrank(links.crank, links.coupler)
    return CrankRocker(links.crank, links.coupler, links.rocker, links.ground)


def locate_run(run: Run) -> xr.Dataset:
    """Trigger, cycle, position and speed of every frame of a run.

    Parameters
    ----------
    run : Run

    Returns
    -------
    xarray.Dataset
        As `erlif.kinematics.locate_frames` for a linkage, else as `locate_rotation`,
        `locate_slider` or `locate_logged`.

    Raises
    ------
    EncoderError
        If the linkage cannot reach a logged angle, the log does not fold into cycles, or lacks
        what the motion needs.
    ModelError
        If the links cannot turn.
    """
    settings, log = run.settings, run.log
    encoder = settings.encoder or EncoderSettings()
    per_cycle = encoder.triggers_per_cycle
    match settings.mechanism:
        case CrankRockerSettings() | SliderCrankSettings() as links:
            located = locate_frames(
                log,
                mechanism=build_linkage(links),
                crank_speed=links.crank_speed,
                pin_radius=None if settings.joint is None else settings.joint.pin_radius,
                encoder=describe_encoder_settings(settings),
            )
            linkage = build_linkage(links)
            if settings.contact is not None and isinstance(linkage, SliderCrank):
                crank = np.radians(located.crank_angle.values)
                speed = np.abs(linkage.slider_speed(crank, crank_speed=links.crank_speed))
                attrs = {"units": "m s-1", "long_name": "speed of the slider"}
                located["sliding_speed"] = ("frame", speed, attrs)
            # a logged speed stands in place of a computed one, for every kind of motion
            logged = locate_logged(log)
            names = [name for name in ("sliding_speed",) if name in logged]
            return located.assign({name: logged[name].assign_attrs(source="log") for name in names})
        case RotationSettings() as disc:
            return locate_rotation(
                log,
                rotation=TurningDisc(disc.radius, disc.speed),
                zero=encoder.zero or 0.0,
                triggers_per_cycle=per_cycle,
                bins=encoder.bins,
            )
        case SinusoidalSettings() as slider:
            return locate_slider(
                log,
                slider=Sinusoid(slider.stroke, slider.frequency),
                zero=encoder.zero,
                triggers_per_cycle=per_cycle,
                bins=encoder.bins,
            )
        case None:
            return locate_logged(log, triggers_per_cycle=per_cycle)


def describe_encoder_settings(settings: RunSettings, *, folded: bool = True) -> Encoder:
    """The encoder of the settings; unless `folded`, without the grouping of frames."""
    encoder = settings.encoder or EncoderSettings()
    return Encoder(
        encoder.mounted_on,
        encoder.zero,
        encoder.triggers_per_cycle if folded else None,
        direction=encoder.direction,
        bins=encoder.bins if folded else None,
    )


def describe_joint(settings: RunSettings) -> LubricatedJoint | None:
    """The joint of the settings, as the theory needs it.

    Parameters
    ----------
    settings : RunSettings

    Returns
    -------
    LubricatedJoint or None
        None where [joint] or [oil] is absent.
    """
    joint, oil = settings.joint, settings.oil
    if joint is None or oil is None:
        return None
    return LubricatedJoint(
        pin_radius=joint.pin_radius,
        bushing_radius=joint.bushing_radius,
        length=joint.length,
        pin=_describe_solid(joint.pin),
        bushing=_describe_solid(joint.bushing),
        viscosity=describe_viscosity(oil),
        pressure_viscosity=oil.pressure_viscosity,
        stroke=_entrained_travel(settings, joint.pin_radius),
    )


def describe_contact(settings: RunSettings) -> LubricatedContact | None:
    """The line or point contact of [joint] or [contact], as the theory needs it.

    Parameters
    ----------
    settings : RunSettings

    Returns
    -------
    LubricatedContact or None
        None where both are absent, or [oil] is.
    """
    joint, contact, oil = describe_joint(settings), settings.contact, settings.oil
    if joint is not None or contact is None or oil is None:
        return None if joint is None else joint.contact
    along, across = contact.radii
    entrainment = 1 / (1 + contact.slide_to_roll / 2)
    return LubricatedContact(
        radius=along,
        radius_across=None if contact.length is not None else across,
        length=contact.length,
        body=_describe_solid(contact.body),
        counterbody=_describe_solid(contact.counterbody),
        viscosity=describe_viscosity(oil),
        pressure_viscosity=oil.pressure_viscosity,
        stroke=2 * entrainment * _entrained_travel(settings, None),
        entrainment=entrainment,
    )


def joint_and_oil(settings: RunSettings) -> tuple[JointSettings, OilSettings]:
    """[joint] and [oil] of settings that have been found to have both, as by `swinging_joint`."""
    assert settings.joint is not None
    assert settings.oil is not None
    return settings.joint, settings.oil


def missing_load() -> ConfigError:
    """Make the error for a joint whose load is neither logged nor in the settings."""
    return ConfigError(
        "Expected the load: the encoder log has no load_N and [joint] no load. Add load = "
        '"50 lbf" to [joint] in run.toml.'
    )


def _entrained_travel(settings: RunSettings, pin_radius: float | None) -> float:
    """Travel of the entrained oil in half a cycle; infinite where the motion never turns back. [m]

    The oil moves at half the speed of the one moving surface: that of a pin of `pin_radius`, else
    that of the slider or disc.
    """
    match settings.mechanism:
        case SliderCrankSettings(crank=crank) if pin_radius is None:
            return crank
        case CrankRockerSettings() | SliderCrankSettings() as links if pin_radius is not None:
            return entrained_stroke(build_linkage(links), pin_radius=pin_radius)
        case SinusoidalSettings(stroke=stroke):
            return stroke / 2
        case _:
            return math.inf


def _describe_solid(material: MaterialSettings) -> Solid:
    return Solid(material.youngs_modulus, material.poissons_ratio, material.roughness)


def describe_viscosity(oil: OilSettings) -> float | VogelLaw:
    """Viscosity of [oil] [Pa s], or its law with temperature."""
    if oil.vogel is not None:
        return VogelLaw(oil.vogel.a, oil.vogel.b, oil.vogel.c)
    assert oil.viscosity is not None  # the settings refuse an oil with neither
    return oil.viscosity
