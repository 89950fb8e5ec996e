"""What stands still in the image: found, described, and counted in the errors of the films."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from erlif.calibration import RunCurve
from erlif.core.notes import Note, warn
from erlif.core.terms import SOURCES, WALL
from erlif.io.files import MapStore
from erlif.pipeline.engines.results import FrameResult, TriggerResult
from erlif.pipeline.physics.gap import cells_of_region
from erlif.pipeline.plane import ObjectPlane
from erlif.trend import Texture, find_texture

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


def with_texture(calibration: RunCurve, texture: Texture | None, plane: ObjectPlane) -> RunCurve:
    """The calibration with the error by what stands still in the image, as its last parameter."""
    if texture is None:
        return calibration
    rows, columns = plane.region.rows, plane.region.columns
    patches = texture.patches(rows.stop - rows.start, columns.stop - columns.start)
    found = calibration.systematics.with_texture(texture.like, texture.size, patches)
    return replace(calibration, systematics=found)


def follow_texture(
    results: Sequence[TriggerResult], calibration: RunCurve, texture: Texture | None
) -> list[TriggerResult]:
    """Results of all triggers with the change of their films by the parameter of `with_texture`."""
    if texture is None:
        return list(results)
    like = calibration.systematics.number(texture.like)
    return [result.with_parameter(like, 1.0) for result in results]


def widen_maps(maps: MapStore, triggers: int, curve: RunCurve, texture: Texture | None) -> None:
    """Add the error by what stands still in the image to the maps of a finished film."""
    if texture is None:
        return
    films = np.linspace(*curve.thickness_range, _FILMS)
    added = texture.size * curve.film_gradient(films)[curve.systematics.number(texture.like)]
    for trigger in range(triggers):
        film, std = (maps.read(trigger, name) for name in ("thickness", "thickness_std_shared"))
        maps.revise(trigger, "thickness_std_shared", np.hypot(std, np.interp(film, films, added)))


def describe_texture(texture: Texture | None, calibration: RunCurve, pitch: float) -> list[Note]:
    """A warning of what stands still in the image, with its size and likely cause."""
    if texture is None:
        return []
    film = np.array(texture.film)
    number, middle = calibration.systematics.number(texture.like), calibration.at(0.5)
    acts = abs(float(middle.gradient(film)[number]))
    size, std, slope = acts * texture.size, acts * texture.std, float(middle.slope(film))
    cause = (
        "it may be uneven in window, flats or wall"
        if not texture.decided
        else "it changes with the film as a wall that reflects unevenly"
        if texture.like is WALL
        else "it is alike at all films, as by dust or spots on a window, or a flat that is off"
    )
    text = (
        f"the ratio has a pattern that stands still in the image while the film moves: "
        f"{100 * size:.1f} ± {100 * std:.1f} % over {texture.length * pitch:.1f} mm, "
        f"{1e3 * size / slope:.0f} nm at {texture.film:.1f} um; {cause}. Maps, film_mean and "
        f"film_min include it in their standard deviations. {SOURCES['texture'].cure}"
    )
    return [warn("texture", text)]
