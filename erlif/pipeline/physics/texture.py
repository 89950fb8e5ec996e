"""What stands still in the image, in the errors of numbers and maps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from erlif.calibration import RatioCurve, RunCurve
from erlif.core.arrays import AnyArray, Array
from erlif.core.notes import Note, warn
from erlif.core.terms import CONSTANT, TERMS
from erlif.correction.light import BLOCK
from erlif.io.files import MapStore
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.engines.engine import Threads
from erlif.pipeline.engines.results import FrameResult, TriggerResult
from erlif.pipeline.physics.findings import LightFindings
from erlif.pipeline.physics.gap import MeasuredCells, cells_of_region
from erlif.pipeline.physics.reference import flag_thick_films
from erlif.pipeline.plane import ObjectPlane
from erlif.ratio import LightCells, cell_centres, sample_cells
from erlif.trend import GapShape, Texture, find_texture
from erlif.trend.cells import FEWEST_FRAMES, FEWEST_VISITS, choosable_films

_FILMS = 400  # of the range, at which the error of a pixel is tabulated

_MOST_MAPS = 100  # in which a pattern is sought

# Rows and columns, at most, of the cells in which a pattern is mapped; where they are more than
# these, four are one in which the gap of the joint is fitted.
_SMALL_CELLS, _OF_GAP = (32, 40), 400

_ENOUGH_CELLS = 40  # of the 120 of a picture, with which it is sought in these: twice the fewest


def measure_pattern(
    chain: FrameChain,
    frames: Sequence[int],
    calibration: RunCurve,
    plane: ObjectPlane,
    coarse: Texture,
) -> tuple[Texture, MeasuredCells] | None:
    """What stands still in the image, from small cells of frames whose ratio is measured again.

    Parameters
    ----------
    chain : FrameChain
    frames : sequence of int
    calibration : RunCurve
    plane : ObjectPlane
    coarse : Texture
        What the cells of the lights show of it.

    Returns
    -------
    texture : Texture
    cells : MeasuredCells
        In which the gap of the joint is fitted, each a number of whole small cells.
    None
        In place of both, where nothing is significant.
    """
    down, along = (
        min(most, size // BLOCK) for most, size in zip(_SMALL_CELLS, plane.shape, strict=True)
    )
    counts = [(down, along)]
    if down * along > _OF_GAP:
        down, along = down // 2, along // 2
        counts = [(2 * down, 2 * along), (down, along)]
    found: dict[int, list[LightCells]] = {}

    def measure(frame: int) -> list[LightCells]:
        pair = chain.measure(frame)
        flag_thick_films(pair, calibration, plane.patch)
        images = pair.light_one, pair.log_ratio, pair.variance, pair.flags
        return [sample_cells(*images, cells=count) for count in counts]

    Threads(None).compute(measure, frames, found.__setitem__)
    cells = [
        cells_of_region([found[frame][n] for frame in frames], plane, count=count)
        for n, count in enumerate(counts)
    ]
    if cells[0] is None or cells[-1] is None:
        return None
    texture = find_texture(*cells[0], calibration.at(0.5), coarse)
    return None if texture is None else (texture, MeasuredCells(np.array(frames), *cells[-1]))


def take_out(
    chain: FrameChain, calibration: RunCurve, findings: LightFindings, plane: ObjectPlane
) -> tuple[FrameChain, LightFindings]:
    """Chain and findings whose texture, as `measure_pattern` gives it, is taken out of the ratio.

    Nothing is taken out on a patch of another film.
    """
    assert findings.texture is not None
    means = None if findings.errors is None else findings.errors.pattern
    texture = findings.texture.mapped(plane.shape, calibration.at(0.5), means)
    assert texture.pattern is not None
    if plane.patch is not None:
        patch = plane.patch.rows, plane.patch.columns
        texture.pattern.log_ratio[patch], texture.pattern.std[patch] = 0.0, texture.found.size
    return replace(chain, pattern=texture.pattern), replace(findings, texture=texture)


def with_texture(
    results: Sequence[TriggerResult],
    calibration: RunCurve,
    findings: LightFindings,
    plane: ObjectPlane,
    contact: GapShape,
) -> tuple[list[TriggerResult], RunCurve]:
    """Results and calibration with further parameters, the last: what stands still in the image.

    Their error is that of a pixel; numbers of a region depend on them less. The films of two
    triggers weigh its places differently, so that their errors are not the same share of the film:
    the parameters are the largest principal components of all numbers.
    """
    texture = findings.texture
    if texture is None:
        return list(results), calibration
    numbers = _changes_of_numbers(results, texture, calibration.at(0.5), plane, contact)
    numbers /= texture.left
    systematics, found = calibration.systematics, list(results)
    like = len(systematics.cross) + systematics.place("ratio", CONSTANT)
    parameters = TERMS["texture"].parameters
    for parameter, shares in zip(parameters, _components(numbers, len(parameters)), strict=True):
        systematics = systematics.with_parameter("texture", parameter, texture.left**2)
        found = [
            result.with_parameter(like, float(mean), minimum=float(minimum))
            for result, (mean, minimum) in zip(found, shares, strict=True)
        ]
    return found, replace(calibration, systematics=systematics)


def _changes_of_numbers(
    results: Sequence[TriggerResult],
    texture: Texture,
    curve: RunCurve,
    plane: ObjectPlane,
    contact: GapShape,
) -> Array:
    """Changes of mean and minimum of each trigger by the pattern, (trigger, number, part). [1]"""
    gaps, along_x = [one.statistics.gap for one in results], plane.sliding_along_x

    # a tilt below its error puts minima at either edge by chance: all at that of most triggers
    places, across = np.array([gap.place for gap in gaps]), int(along_x)
    known = np.isfinite(places[:, across]).sum()
    places[:, across] = np.sort(places[:, across])[known // 2]

    moved = [gap._replace(place=place) for gap, place in zip(gaps, places, strict=True)]
    parts = texture.parts_in(plane.region, along_x=along_x)
    numbers = np.array(
        [
            texture.in_numbers(parts, plane.region, gap, curve, contact, along_x=along_x)
            for gap in moved
        ]
    )
    if contact is GapShape.PLATEAU:  # the minimum is that of few blocks, with the error of a pixel
        norms = np.linalg.norm(numbers[:, 1], axis=-1, keepdims=True)
        numbers[:, 1] *= texture.left / norms
    return numbers


def _components(numbers: Array, count: int) -> Array:
    """Shares of the largest principal components in numbers, (component, trigger, number).

    `numbers` are their changes by the parts of the pattern, (trigger, number, part). The error of
    each number remains what it is by all components.
    """
    parts = numbers.reshape(-1, numbers.shape[-1])
    axes = np.linalg.eigh(parts.T @ parts)[1][:, : -count - 1 : -1]
    shares = parts @ axes
    shares *= np.copysign(1.0, shares.sum(axis=0))
    whole, kept = (np.linalg.norm(one, axis=1, keepdims=True) for one in (parts, shares))
    return np.asarray((shares * whole / kept).T.reshape(count, *numbers.shape[:2]))


def find_within(
    lights: Mapping[int, FrameResult],
    maps: MapStore,
    triggers: int,
    curve: RatioCurve,
    plane: ObjectPlane,
) -> Texture | None:
    """Find what stands still where the film is measured in a small part of the picture alone.

    Below a ball few cells of the whole picture hold a film within the range: as many are laid over
    this part, and filled from the finished maps.

    Parameters
    ----------
    lights : mapping of int to FrameResult
        By frame.
    maps : MapStore
    triggers : int
    curve : RatioCurve
        In the middle of the run.
    plane : ObjectPlane

    Returns
    -------
    Texture or None
        None where nothing is significant, and where the whole picture has enough cells.
    """
    known = [np.isfinite(one.cells.log_ratio) for one in lights.values()]
    if len(known) < FEWEST_FRAMES or np.sum(np.sum(known, axis=0) > 0) > _ENOUGH_CELLS:
        return None

    low, high = choosable_films(curve)
    steps = np.unique(np.linspace(0, triggers - 1, _MOST_MAPS).round().astype(int)).tolist()
    region = plane.region
    visits = np.zeros(
        (region.rows.stop - region.rows.start, region.columns.stop - region.columns.start), np.int64
    )
    for film in _read(maps, steps, "thickness", plane):
        visits += (low < film) & (film < high)
    rows, columns = np.nonzero(visits >= FEWEST_VISITS)
    if not rows.size:
        return None
    box = slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1)

    cells = []
    both = (_read(maps, steps, name, plane) for name in ("thickness", "thickness_std"))
    for film, std in zip(*both, strict=True):
        flags = np.isnan(film[box]).astype(np.uint16)
        film_known = np.where(flags, np.float32(low), film[box])
        noise = np.where(flags, 0, std[box] * curve.slope(film_known)) ** 2
        ratio = curve.predict_log(film_known)
        images = (film_known, ratio.astype(np.float32), noise.astype(np.float32))
        cells.append(sample_cells(*images, flags))
    record = LightCells(*(np.stack(part) for part in zip(*cells, strict=True)))
    return find_texture(record, cell_centres(visits[box].shape), curve)


def _read(
    maps: MapStore, triggers: Sequence[int], name: str, plane: ObjectPlane
) -> Iterator[AnyArray]:
    """One map of each trigger within the region of interest, NaN on a patch of another film."""
    for trigger in triggers:
        values = maps.read(trigger, name)
        if plane.patch is not None:
            values[plane.patch.rows, plane.patch.columns] = np.nan
        yield values[plane.region.rows, plane.region.columns]


def widen_maps(maps: MapStore, triggers: int, curve: RunCurve, texture: Texture | None) -> None:
    """Add the error by what stands still in the image to the maps of a film that is measured.

    Near the maximum of the ratio two standard deviations of it are more film than the slope gives:
    the error is half the film that they are, up to the end of the range.

    Parameters
    ----------
    maps : MapStore
    triggers : int
    curve : RunCurve
    texture : Texture or None
    """
    if texture is None:
        return
    films, name = np.linspace(*curve.thickness_range, _FILMS), "thickness_std_shared"
    ratio, slope = curve.predict_log(films), curve.slope(films)
    tables = ratio, slope, *texture.kind.acts(films, curve)

    def widen(trigger: int) -> dict[str, bytes]:
        film, std = maps.read(trigger, "thickness"), maps.read(trigger, name)
        at, rate, acts, off = (np.interp(film, films, table) for table in tables)
        if texture.pattern is None:
            left = texture.found.size * np.hypot(acts, off)
        else:
            left = np.hypot(texture.pattern.std * acts, texture.pattern.log_ratio * off)
        thicker = np.interp(np.minimum(at + 2 * left, ratio[-1]), ratio, films)
        return maps.encode({name: np.hypot(std, np.maximum(left / rate, (thicker - film) / 2))})

    Threads().compute(widen, range(triggers), maps.revise)


def describe_texture(texture: Texture | None, calibration: RunCurve) -> list[Note]:
    """Make the warning of what stands still in the image; none where nothing does."""
    if texture is None:
        return []
    film, (size, std, length, _) = texture.kind.film, texture.found
    shift = 1e3 * size / float(calibration.slope(film))
    taken = "The error bars include it"
    if texture.pattern is not None:
        left = 100 * texture.left
        taken = f"It is taken out of the maps to {left:.2g} %, and the error bars include the rest"
    text = (
        "while the film moves, a pattern of the ratio stands still in the image: "
        f"{100 * size:.2g} ± {100 * std:.1g} %, {shift:.0f} nm at {film:.1f} um, "
        f"correlated over {length:.0f} px. Likely: dust on a window, a flat that is off, "
        f"or a wall that reflects unevenly. {taken}. {TERMS['texture'].cure}"
    )
    return [warn("texture", text)]
