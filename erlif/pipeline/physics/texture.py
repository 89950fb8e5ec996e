"""What stands still in the image: found, described, and counted in the errors of the films."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from erlif.calibration import RunCurve
from erlif.core.notes import Note, warn
from erlif.core.terms import CONSTANT, SOURCES
from erlif.io.files import MapStore
from erlif.pipeline.engines.results import FrameResult, TriggerResult
from erlif.pipeline.physics.gap import cells_of_region
from erlif.pipeline.plane import ObjectPlane
from erlif.trend import GapShape, Texture, find_texture

_FILMS = 400  # of the range, at which the error of a pixel is tabulated


def find_texture_of_run(
    lights: Mapping[int, FrameResult], calibration: RunCurve, plane: ObjectPlane
) -> Texture | None:
    """Find what stands still in the image of a run; None where nothing is significant.

    The lobes of a bore are no smooth gap.
    """
    cells = None if plane.bore is not None else cells_of_region(lights, plane)
    if cells is None or not calibration.systematics:
        return None
    return find_texture(*cells, calibration.at(0.5))


def with_texture(
    results: Sequence[TriggerResult],
    calibration: RunCurve,
    texture: Texture | None,
    plane: ObjectPlane,
    contact: GapShape,
) -> tuple[list[TriggerResult], RunCurve]:
    """Results and calibration with one more parameter, the last: what stands still in the image."""
    if texture is None:
        return list(results), calibration
    places = np.array([one.statistics.gap.place for one in results])
    patches, ratios = texture.over_mean(
        plane.region, places, contact, sliding_along_x=plane.sliding_along_x
    )
    systematics = calibration.systematics
    like = len(systematics.cross) + systematics.place("ratio", CONSTANT)
    found = replace(calibration, systematics=systematics.with_texture(texture.size, patches))
    return [
        result.with_parameter(like, 1.0, minimum=float(ratio))
        for result, ratio in zip(results, ratios, strict=True)
    ], found


def widen_maps(maps: MapStore, triggers: int, curve: RunCurve, texture: Texture | None) -> None:
    """Add the error by what stands still in the image to the maps of a finished film."""
    if texture is None:
        return
    films = np.linspace(*curve.thickness_range, _FILMS)
    added = texture.size / curve.slope(films)
    for trigger in range(triggers):
        film, std = (maps.read(trigger, name) for name in ("thickness", "thickness_std_shared"))
        maps.revise(trigger, "thickness_std_shared", np.hypot(std, np.interp(film, films, added)))


def describe_texture(texture: Texture | None, calibration: RunCurve, pitch: float) -> list[Note]:
    """A warning of what stands still in the image, with its size and likely cause."""
    if texture is None:
        return []
    slope = float(calibration.at(0.5).slope(texture.film))
    text = (
        "the ratio has a pattern that stands still in the image while the film moves: "
        f"{100 * texture.size:.1f} ± {100 * texture.std:.1f} %, "
        f"{1e3 * texture.size / slope:.0f} nm at {texture.film:.1f} um, correlated over "
        f"{texture.length * pitch:.1f} mm. Likely: dust or spots on a window, a flat that is off, "
        "or a wall that reflects unevenly. The standard deviations of maps, film_mean and "
        f"film_min include it. {SOURCES['texture'].cure}"
    )
    return [warn("texture", text)]
