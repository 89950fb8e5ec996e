"""Mechanism, encoder and joint of a run, from its settings."""

from __future__ import annotations

import xarray as xr

from erlif.core.errors import ConfigError
from erlif.ingest import Run
from erlif.kinematics import Encoder, Mechanism, entrained_stroke, locate_frames
from erlif.models.mechanism import CrankRocker, SliderCrank
from erlif.settings import MaterialSettings, OilSettings, RunSettings, SliderCrankSettings
from erlif.trend import Joint, Solid, VogelLaw


def build_mechanism(settings: RunSettings) -> Mechanism:
    """The linkage of the settings; raises ModelError where its crank cannot turn (Grashof)."""
    links = settings.mechanism
    if isinstance(links, SliderCrankSettings):
        return SliderCrank(links.crank, links.coupler)
    return CrankRocker(links.crank, links.coupler, links.rocker, links.ground)


def locate_run(run: Run) -> xr.Dataset:
    """Trigger, cycle, stroke, crank angle and speed of every frame of a run.

    Parameters
    ----------
    run : Run

    Returns
    -------
    xarray.Dataset
        As `erlif.kinematics.locate_frames`.

    Raises
    ------
    EncoderError
        If the linkage cannot reach a logged angle, or the log does not fold into cycles.
    ModelError
        If the links cannot turn.
    """
    settings, encoder = run.settings, run.settings.encoder
    return locate_frames(
        run.log,
        mechanism=build_mechanism(settings),
        crank_speed=settings.mechanism.crank_speed,
        pin_radius=settings.joint.pin_radius,
        encoder=Encoder(encoder.mounted_on, encoder.zero, encoder.triggers_per_cycle),
    )


def describe_joint(settings: RunSettings) -> Joint:
    """The joint of the settings, as the theory needs it.

    Parameters
    ----------
    settings : RunSettings

    Returns
    -------
    Joint
    """
    joint = settings.joint
    return Joint(
        pin_radius=joint.pin_radius,
        bushing_radius=joint.bushing_radius,
        length=joint.length,
        pin=_describe_solid(joint.pin),
        bushing=_describe_solid(joint.bushing),
        viscosity=_describe_viscosity(settings.oil),
        pressure_viscosity=settings.oil.pressure_viscosity,
        stroke=entrained_stroke(build_mechanism(settings), pin_radius=joint.pin_radius),
    )


def _describe_solid(material: MaterialSettings) -> Solid:
    return Solid(material.youngs_modulus, material.poissons_ratio, material.roughness)


def _describe_viscosity(oil: OilSettings) -> float | VogelLaw:
    if oil.vogel is not None:
        return VogelLaw(oil.vogel.a, oil.vogel.b, oil.vogel.c)
    if oil.viscosity is None:  # the settings refuse an oil with neither
        raise ConfigError('Expected viscosity = "0.12 Pa s" or a vogel law in [oil]; got neither.')
    return oil.viscosity
