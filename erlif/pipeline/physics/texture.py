"""What stands still in the image, in the errors of numbers and maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from erlif.calibration import RunCurve
from erlif.core.notes import Note, warn
from erlif.core.terms import CONSTANT, TERMS
from erlif.io.files import MapStore
from erlif.pipeline.engines.results import TriggerResult
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.plane import ObjectPlane
from erlif.trend import GapMinimum, GapShape, Texture

_FILMS = 400  # of the range, at which the error of a pixel is tabulated


def with_texture(
    results: Sequence[TriggerResult],
    calibration: RunCurve,
    findings: LightFindings,
    plane: ObjectPlane,
    contact: GapShape,
) -> tuple[list[TriggerResult], RunCurve]:
    """Results and calibration with one more parameter, the last: what stands still in the image.

    Its error is that of a pixel; numbers of a region depend on it less. Where the film of a patch
    has set the ratio, what stands still on the patch moves all films alike.
    """
    texture = findings.texture
    if texture is None:
        return list(results), calibration
    curve, along_x, size = calibration.at(0.5), plane.sliding_along_x, texture.size
    gaps = [one.statistics.gap for one in results]
    shares = np.array(
        [texture.in_numbers(plane.region, gap, curve, contact, along_x=along_x) for gap in gaps]
    )
    if contact is GapShape.PLATEAU:
        shares[:, 1] = 1.0  # numbers of few blocks
    if findings.scale is not None and plane.patch is not None:
        even = GapMinimum.unknown(0)
        of_patch, _ = texture.in_numbers(plane.patch, even, curve, contact, along_x=along_x)
        shares = np.hypot(shares, of_patch) / np.hypot(1.0, of_patch)
        size *= float(np.hypot(1.0, of_patch))
    systematics, (added,) = calibration.systematics, TERMS["texture"].parameters
    like = len(systematics.cross) + systematics.place("ratio", CONSTANT)
    found = systematics.with_parameter("texture", added, size**2)
    return [
        result.with_parameter(like, float(mean), minimum=float(minimum))
        for result, (mean, minimum) in zip(results, shares, strict=True)
    ], replace(calibration, systematics=found)


def widen_maps(maps: MapStore, triggers: int, curve: RunCurve) -> None:
    """Add the error by what stands still in the image to the maps of a film that is measured.

    Parameters
    ----------
    maps : MapStore
    triggers : int
    curve : RunCurve
        As `with_texture` returns it.
    """
    if not (size := curve.systematics.widths.get("texture", 0.0)):
        return
    films, name = np.linspace(*curve.thickness_range, _FILMS), "thickness_std_shared"
    added = size / curve.slope(films)
    for trigger in range(triggers):
        film, std = maps.read(trigger, "thickness"), maps.read(trigger, name)
        maps.revise(trigger, name, np.hypot(std, np.interp(film, films, added)))


def describe_texture(texture: Texture | None, calibration: RunCurve) -> list[Note]:
    """Make the warning of what stands still in the image; none where nothing does."""
    if texture is None:
        return []
    size, shift = 100 * texture.size, texture.size / float(calibration.slope(texture.film))
    text = (
        "while the film moves, a pattern of the ratio stands still in the image: "
        f"{size:.2g} ± {100 * texture.std:.1g} %, {1e3 * shift:.0f} nm at {texture.film:.1f} um, "
        f"correlated over {texture.length:.0f} px. Likely: dust on a window, a flat that is off, "
        f"or a wall that reflects unevenly. The error bars include it. {TERMS['texture'].cure}"
    )
    return [warn("texture", text)]
