"""Pressure between a pin and a bushing of finite length: ends, lobes, undercuts, bending.

Pin and bushing are bodies of revolution of `erlif.joint.models.edges.cylinders`, so that their
curvature, the bending of the pin, the free ends and the lip of an undercut are part of their
compliance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product, starmap
from typing import TYPE_CHECKING

import numpy as np
import scipy.fft

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.joint.models.edges.active_set import solve_active_set
from erlif.joint.models.edges.cylinders import (
    HARMONICS,
    Compliance,
    HarmonicSolver,
    Section,
    compute_compliance,
)
from erlif.joint.models.edges.half_space import equivalent_stress
from erlif.models.arguments import check_fields, formula, require_increasing, require_positive
from erlif.models.reynolds.shapes import lobe_shape

if TYPE_CHECKING:
    import xarray as xr

_WORDS = read_table("erlif.joint.models", "variables.toml")


@dataclass(frozen=True)
class Undercut:
    """Annular groove in the end faces of a bushing. Farzaneh (2002), figure 3-6.

    Attributes
    ----------
    depth, width, lip : float
        D1 from the face along the axis, D2 along the radius, and D3, the thickness of the lip
        between bore and groove. [m]
    """

    depth: float
    width: float
    lip: float


@dataclass(frozen=True)
class EdgeJoint:
    """Pin in a bushing, both straight and symmetric about the middle of their lengths.

    Attributes
    ----------
    pin_radius, bushing_radius, outer_radius : float
        Radii of the pin, of the bore, and of the outside of the bushing, which is held. [m]
    length, pin_length : float
        Lengths of bushing and pin. [m]
    youngs_modulus, pin_youngs_modulus : float
        Young's moduli of bushing and pin. [Pa]
    poisson, pin_poisson : float
        Poisson's ratios of bushing and pin. [1]
    undercut : Undercut, optional
        Groove in both faces of the bushing.
    """

    pin_radius: float
    bushing_radius: float
    outer_radius: float
    length: float
    pin_length: float
    youngs_modulus: float = 200e9
    pin_youngs_modulus: float = 200e9
    poisson: float = 0.3
    pin_poisson: float = 0.3
    undercut: Undercut | None = None

    def __post_init__(self) -> None:
        """Refuse radii, lengths and moduli that are no joint."""
        radii = ["pin_radius", "bushing_radius", "outer_radius"]
        check_fields(self, **dict.fromkeys(radii, "number"))
        require_increasing(**{name: getattr(self, name) for name in radii})
        if not self.pin_length >= self.length:
            raise ModelError(
                f"pin_length, {self.pin_length:g} m, is below the length of the bushing, "
                f"{self.length:g} m; the pin ends outside."
            )
        cut = self.undercut
        if cut is None:
            return
        require_positive(depth=cut.depth, width=cut.width, lip=cut.lip)
        if not _fits(cut, self):
            wall = self.outer_radius - self.bushing_radius
            raise ModelError(
                f"The undercut (depth {cut.depth:g}, width {cut.width:g}, lip {cut.lip:g} m) does "
                f"not fit into a wall of {wall:g} m and half a length of {self.length / 2:g} m."
            )


@dataclass(frozen=True)
class ElasticJoint:
    """A joint with the compliance of its bodies, which holds for all loads and shapes of the gap.

    Attributes
    ----------
    joint : EdgeJoint
        Geometry and materials.
    cells : array, (cell + 1,)
        Ends of the axial cells: from the middle to the end of the bushing, or from end to end. [m]
    load_span : tuple of float
        Extent, from the middle, over which the load acts on either half of the pin. [m]
    sections : tuple of Section
        Meshes of pin and bushing.
    pin : Compliance
        Compliance of the pin.
    bushing : Compliance
        Compliance of the bushing.
    """

    joint: EdgeJoint
    cells: Array
    load_span: tuple[float, float]
    sections: tuple[Section, Section]
    pin: Compliance
    bushing: Compliance


def prepare_joint(
    joint: EdgeJoint,
    *,
    smallest_cell: float = 0.5e-3,
    growth: float = 1.3,
    largest_cell: float = 3e-3,
    refine: Sequence[float] = (),
    load_span: tuple[float, float] | None = None,
    whole: bool = False,
    harmonics: Sequence[int] = HARMONICS,
    pin: Compliance | None = None,
) -> ElasticJoint:
    """Compute the compliance of pin and bushing by finite elements.

    Parameters
    ----------
    joint : EdgeJoint
        Geometry and materials.
    smallest_cell, largest_cell : float
        Length of the axial cells at the end of the bushing, and at most in its middle. [m]
    growth : float
        Ratio of neighbouring cells. [1]
    refine : sequence of float
        Distances from the middle at which cells are as small as at the end: crests of lobes. [m]
    load_span : tuple of float, optional
        Extent over which the load acts on either half of the pin, from the middle. Default: from
        the end of the bushing to that of the pin. [m]
    whole : bool
        Whether both halves are computed, for loads that tilt the pin.
    harmonics : sequence of int
        Harmonics round the axis that are computed.
    pin : Compliance, optional
        Compliance of the pin from a joint that differs in its bushing alone.

    Returns
    -------
    ElasticJoint
        What `solve_joint` takes.

    Raises
    ------
    ModelError
        scikit-fem is not installed, or cells that are not positive.

    Examples
    --------
    >>> from erlif.joint.models.edges import EdgeJoint
    >>> joint = EdgeJoint(0.03336, 0.03359, 0.0533, length=0.06, pin_length=0.1)
    >>> elastic = prepare_joint(joint, smallest_cell=4e-3, harmonics=[0, 1, 2, 8, 32, 128])
    >>> elastic.cells.size - 1
    10
    """
    require_positive(smallest_cell=smallest_cell, largest_cell=largest_cell)
    if growth < 1:
        raise ModelError(f"growth must be at least 1, got {growth}.")
    half, end = joint.length / 2, joint.pin_length / 2
    span = load_span if load_span is not None else (half, end)
    if not 0 <= span[0] < span[1] <= end + 1e-12:
        raise ModelError(
            f"The load cannot act from {span[0]:g} to {span[1]:g} m on half a pin of {end:g} m; "
            "give load_span where no pin goes beyond the bushing."
        )
    fine = {"first": smallest_cell, "growth": growth, "largest": largest_cell}
    if any(not 0 < place < half for place in refine):
        raise ModelError(f"refine must lie between 0 and {half:g} m, got {list(refine)}.")
    parts, before = [np.array([0.0])], 0.0
    for place in sorted([*refine, half]):
        # from the middle between two fine places, or from that of the bushing, to the next one
        between = (before + place) / 2 if before else 0.0
        if before:
            parts.append(before + graded_lines(between - before, **fine)[1:])
        parts.append(place - graded_lines(place - between, **fine)[-2::-1])
        before = place
    cells = np.concatenate(parts)
    beyond = half + graded_lines(end - half, **fine) if end > half else np.array([half])
    places = _with_lines(np.union1d(cells, beyond), span)

    # sections: the bushing has lines at the sides of its undercut
    pin_radii = joint.pin_radius - _radial_lines(joint.pin_radius, smallest_cell)[::-1]
    pin_radii[0] = 0.0
    radii = joint.bushing_radius + _radial_lines(
        joint.outer_radius - joint.bushing_radius, smallest_cell
    )
    lines, cut = cells, None
    if joint.undercut is not None:
        groove = joint.undercut
        inner = joint.bushing_radius + groove.lip
        cut = (inner, inner + groove.width, half - groove.depth, half)
        radii, lines = _with_lines(radii, cut[:2]), _with_lines(cells, cut[2:3])
    spans = [span]
    if whole:
        cells, places, lines = (_mirrored(each) for each in (cells, places, lines))
        spans = [(-span[1], -span[0]), span]
    section = partial(Section, symmetric=not whole)
    pin_material = joint.pin_youngs_modulus, joint.pin_poisson
    body = section(pin_radii, places, joint.pin_radius, *pin_material, clamped=False)
    material = joint.youngs_modulus, joint.poisson
    ring = section(radii, lines, joint.bushing_radius, *material, clamped=True, cut=cut)
    if pin is None:
        pin = compute_compliance(body, cells, harmonics=harmonics, load_spans=spans)
    bushing = compute_compliance(ring, cells, harmonics=harmonics)
    return ElasticJoint(joint, cells, span, (body, ring), pin, bushing)


@formula(tolerance="number")
def solve_joint(
    elastic: ElasticJoint,
    *,
    load: float,
    lobes: Sequence[float] = (),
    lobe_radius: float = 0.2,
    lobe_height: float = 0.0,
    load_position: float = 0.0,
    patch: float = 4e-3,
    around: int = 512,
    tolerance: float = 1e-4,
) -> "xr.Dataset":
    """Find the pressure between a pin and a bushing.

    Parameters
    ----------
    elastic : ElasticJoint
        The joint, from `prepare_joint`.
    load : float
        Load on the whole pin. [N]
    lobes : sequence of float
        Distances of crowned lobes on either side of the middle; 0 is one lobe in the middle. [m]
    lobe_radius, lobe_height : float
        Radius along the axis, and height above the bore. [m]
    load_position : float
        Distance of the load from the middle, for joints that were prepared as a whole; the pin then
        tilts. [m]
    patch : float
        Axial length of the means of `patch_pressure`. The default is the length of the elements of
        Farzaneh (2002). [m]
    around : int
        Cells round the circumference, an even number.
    tolerance : float
        Largest error of the gap, over the deflection of a cell under its own largest pressure. [1]

    Returns
    -------
    xarray.Dataset
        Over angle [rad, from the line of load] and z [m, from the middle; one half, or the whole
        bushing]: `pressure` [Pa] and the `gap` that remains [m]. Over z: `cell_length` [m],
        `line_load` [N/m] and `bending` [m], the deflection of the pin's surface on the line of load
        by bending, tilt and indentation, less its mean. `force` on the whole pin [N],
        `peak_pressure` [Pa] at `peak_z` [m], `patch_pressure` [Pa], the largest mean over an axial
        length, `displacement` of the line of load [m], `tilt` of the pin against its ends [rad],
        `iterations`, `residual`. Pressures are averages over cells: at a sharp edge they grow
        without limit as cells become smaller, and `patch_pressure` does not.

    Raises
    ------
    ModelError
        A load or patch that is not positive, an odd number of cells, a lobe or a load beyond the
        bushing.

    Examples
    --------
    >>> from erlif.joint.models.edges import EdgeJoint, prepare_joint
    >>> joint = EdgeJoint(0.03336, 0.03359, 0.0533, length=0.06, pin_length=0.1)
    >>> elastic = prepare_joint(joint, smallest_cell=4e-3, harmonics=[0, 1, 2, 8, 32, 128])
    >>> found = solve_joint(elastic, load=44.48e3, around=256)
    >>> print(f"{float(found.peak_z) * 1e3:.0f} of {joint.length / 2 * 1e3:.0f} mm")
    28 of 30 mm
    """
    joint, cells = elastic.joint, elastic.cells
    if around % 2 or around < 16:
        raise ModelError(f"around must be an even number of at least 16, got {around}.")
    middles, lengths = (cells[1:] + cells[:-1]) / 2, np.diff(cells)
    angle = 2 * np.pi * (np.arange(around) - around // 2) / around

    # gap of the undeformed bodies, and the bending of the pin by its load
    half = joint.length / 2
    forces, targets = _share(elastic, load, load_position)
    bent = -elastic.pin.loaded @ forces
    shape = _lobe_shape(np.abs(middles), lobes, lobe_radius, lobe_height, half)
    round_pin = np.cos(angle)[:, None]
    gap = joint.bushing_radius - joint.pin_radius + shape - round_pin * bent

    # pressure to deflection, harmonic by harmonic
    count = around // 2 + 1
    pin_matrices = elastic.pin.between(count)
    matrices = pin_matrices + elastic.bushing.between(count)
    weights = np.where((np.arange(count) == 0) | (np.arange(count) == count - 1), 1, 2)
    diagonal = np.einsum("n,nii->i", weights, matrices) / around
    area = np.broadcast_to(lengths * joint.pin_radius * 2 * np.pi / around, gap.shape)
    modes = np.array([round_pin + 0 * middles, round_pin * middles])[: targets.size]
    balance = solve_active_set(
        lambda pressure: _multiply(matrices, pressure),
        gap,
        diagonal=diagonal,
        modes=modes,
        area=area,
        targets=targets,
        start=np.where(round_pin > 0.8, 1.0, 0.0) + np.zeros(gap.shape),
        tolerance=tolerance,
    )
    motion = np.pad(balance.motion, (0, 2 - targets.size))

    # what a reader asks for
    pressure = balance.pressure
    row, column = np.unravel_index(int(pressure.argmax()), gap.shape)
    line = around // 2
    bending = bent - _multiply(pin_matrices, pressure)[line] + motion[1] * middles
    mean_bending = float(bending @ lengths) / lengths.sum()
    vertical = (pressure * round_pin * area).sum(axis=0)
    return describe_by(
        _WORDS["contact"] | _WORDS["joint"],
        {
            "pressure": (("angle", "z"), pressure),
            "gap": (("angle", "z"), balance.gap),
            "cell_length": ("z", lengths),
            "line_load": ("z", vertical / lengths),
            "bending": ("z", bending - mean_bending),
            "force": ((), float(vertical.sum()) * load / targets[0]),
            "peak_pressure": ((), float(pressure[row, column])),
            "peak_z": ((), float(middles[column])),
            "patch_pressure": ((), _largest_mean(pressure, lengths, patch)),
            "displacement": ((), float(motion[0] + mean_bending)),
            "tilt": ((), float(motion[1])),
            "iterations": ((), balance.iterations),
            "residual": ((), balance.residual),
        },
        {"angle": ("angle", angle), "z": ("z", middles)},
    )


def section_stress(
    elastic: ElasticJoint, contact: "xr.Dataset", *, harmonics: int = 96
) -> "xr.Dataset":
    """Compute the stresses of a bushing in the plane of the load.

    Farzaneh (2002) asks for them at the root of an undercut. The pressure is summed harmonic by
    harmonic; what varies faster round the axis than the last of them is left out, so that stresses
    within a few of its wavelengths below the contact are those of a smoothed pressure. Use
    `subsurface_stress` there.

    Parameters
    ----------
    elastic : ElasticJoint
        The joint, from `prepare_joint`.
    contact : xarray.Dataset
        Its pressure, from `solve_joint`.
    harmonics : int
        Number of harmonics.

    Returns
    -------
    xarray.Dataset
        Over point, the elements at radius r and place z with `width_r` and `width_z` [m]:
        `von_mises`, `stress_rr`, `stress_tt`, `stress_zz`, `stress_rz` [Pa], tension positive.
        `peak_von_mises` [Pa] at `peak_r` and `peak_z` [m].

    Raises
    ------
    ModelError
        Fewer than one harmonic.

    Examples
    --------
    >>> from erlif.joint.models.edges import EdgeJoint, prepare_joint, solve_joint
    >>> joint = EdgeJoint(0.03336, 0.03359, 0.0533, length=0.06, pin_length=0.1)
    >>> elastic = prepare_joint(joint, smallest_cell=4e-3, harmonics=[0, 1, 2, 8, 32, 128])
    >>> contact = solve_joint(elastic, load=1e5, around=256)
    >>> stress = section_stress(elastic, contact, harmonics=8)
    >>> bool(stress.stress_rr.min() < 0)
    True
    """
    require_positive(harmonics=harmonics)
    solver = HarmonicSolver.of(elastic.sections[1])
    loads = solver.pressure_vectors(elastic.cells)
    pressure = contact["pressure"].to_numpy()
    around = len(pressure)
    angle = contact["angle"].to_numpy()
    total = np.zeros((4, solver.basis.mesh.nelements))
    for n in range(min(harmonics, around // 2)):
        # amplitude of cos(n angle); the pressure is even
        amplitude = (2 - (n == 0)) / around * (np.cos(n * angle) @ pressure)
        total += solver.stress(n, solver.solve(n, loads @ amplitude[:, None])[:, 0])
    rr, tt, zz, rz = total
    mises = equivalent_stress(xx=rr, yy=tt, zz=zz, xz=rz)
    (r, z), (width_r, width_z) = solver.points, solver.sizes
    top = int(mises.argmax())
    stresses = {"von_mises": mises, "stress_rr": rr, "stress_tt": tt, "stress_zz": zz}
    peak = {"peak_von_mises": mises[top], "peak_r": r[top], "peak_z": z[top]}
    places = {"r": r, "z": z, "width_r": width_r, "width_z": width_z}
    return describe_by(
        _WORDS["section"],
        {name: ("point", values) for name, values in (stresses | {"stress_rz": rz}).items()}
        | {name: ((), float(value)) for name, value in peak.items()},
        {name: ("point", values) for name, values in places.items()},
    )


def search_undercut(
    joint: EdgeJoint,
    *,
    load: float,
    depths: Sequence[float],
    widths: Sequence[float],
    lips: Sequence[float],
    smallest_cell: float = 0.5e-3,
    patch: float = 4e-3,
    load_span: tuple[float, float] | None = None,
    harmonics: Sequence[int] = HARMONICS,
) -> "xr.Dataset":
    """Compute the pressure in a joint for undercuts of all combinations of three lengths.

    Parameters
    ----------
    joint : EdgeJoint
        Geometry and materials; its own undercut does not count.
    load : float
        Load on the whole pin. [N]
    depths, widths, lips : sequence of float
        D1, D2 and D3, see `Undercut`. [m]
    smallest_cell : float
        Length of the axial cells at the end of the bushing. [m]
    patch : float
        Axial length of the means of `patch_pressure`. [m]
    load_span : (float, float), optional
        Extent over which the load acts on either half of the pin, from the middle. [m]
    harmonics : sequence of int
        Harmonics round the axis that are computed.

    Returns
    -------
    xarray.Dataset
        Over depth, width and lip [m]: `peak_pressure` and `patch_pressure` [Pa]; NaN where the
        groove does not fit into the wall. Without a cut: `peak_uncut`, `patch_uncut` [Pa]. The
        undercut with the lowest `patch_pressure`: `best_depth`, `best_width`, `best_lip` [m].

    Raises
    ------
    ModelError
        No combination fits, or as for `solve_joint`.

    Examples
    --------
    >>> from erlif.joint.models.edges import EdgeJoint
    >>> joint = EdgeJoint(0.03336, 0.03359, 0.0533, length=0.06, pin_length=0.1)
    >>> found = search_undercut(
    ...     joint, load=1e5, depths=[0.01], widths=[5e-3], lips=[5e-3], smallest_cell=4e-3,
    ...     harmonics=[0, 1, 2, 8, 32, 128],
    ... )
    >>> bool(found.patch_pressure.min() < found.patch_uncut)
    True
    """

    prepare = partial(
        prepare_joint, smallest_cell=smallest_cell, load_span=load_span, harmonics=harmonics
    )
    shape = (len(depths), len(widths), len(lips))
    cuts = zip(np.ndindex(shape), starmap(Undercut, product(depths, widths, lips)), strict=True)
    fitting = {place: cut for place, cut in cuts if _fits(cut, joint)}
    if not fitting:
        raise ModelError(
            "No undercut of these depths, widths and lips fits into the wall of "
            f"{joint.outer_radius - joint.bushing_radius:g} m."
        )

    straight = prepare(replace(joint, undercut=None))
    uncut = solve_joint(straight, load=load, patch=patch)
    peak, mean = np.full(shape, np.nan), np.full(shape, np.nan)
    for place, cut in fitting.items():
        elastic = prepare(replace(joint, undercut=cut), pin=straight.pin)
        solved = solve_joint(elastic, load=load, patch=patch)
        peak[place], mean[place] = solved["peak_pressure"], solved["patch_pressure"]
    best = np.unravel_index(int(np.nanargmin(mean)), shape)
    names = {"depth": depths, "width": widths, "lip": lips}
    chosen = {
        f"best_{name}": ((), float(values[int(place)]))
        for (name, values), place in zip(names.items(), best, strict=True)
    }
    searched = describe_by(
        _WORDS["search"],
        {
            "peak_pressure": (tuple(names), peak),
            "patch_pressure": (tuple(names), mean),
            "peak_uncut": ((), float(uncut["peak_pressure"])),
            "patch_uncut": ((), float(uncut["patch_pressure"])),
            **chosen,
        },
        {name: (name, np.asarray(values, float)) for name, values in names.items()},
    )
    for name in ("patch_pressure", "patch_uncut"):
        searched[name].attrs["patch"] = patch
    return searched


def _multiply(matrices: Array, pressure: Array) -> Array:
    """Deflection of a pressure (angle, cell) by matrices (harmonic, cell, cell)."""
    spectrum = scipy.fft.rfft(pressure, axis=0)
    moved = matrices @ np.stack([spectrum.real, spectrum.imag], axis=-1)
    total: Array = scipy.fft.irfft(moved[..., 0] + 1j * moved[..., 1], len(pressure), axis=0)
    return total


def _share(elastic: ElasticJoint, load: float, position: float) -> tuple[Array, Array]:
    """Forces on the loaded parts of the pin, and force and moment that the pressure balances."""
    if elastic.pin.loaded.shape[1] == 1:
        if position:
            raise ModelError(
                "A load beside the middle tilts the pin; prepare the joint with whole=True."
            )
        return np.array([load / 2]), np.array([load / 2])
    middle = sum(elastic.load_span) / 2
    if abs(position) >= elastic.joint.length / 2:
        raise ModelError(
            f"The load at {position:g} m lies beyond the bushing, which ends at "
            f"{elastic.joint.length / 2:g} m; no contact carries it."
        )
    forces = load / 2 * (1 + np.array([-1, 1]) * position / middle)
    return forces, load * np.array([1.0, position])


def _largest_mean(pressure: Array, lengths: Array, patch: float) -> float:
    """Largest mean over an axial length at any angle; windows begin or end at ends of cells."""
    lines = np.concatenate([[0.0], np.cumsum(lengths)])
    total = np.zeros((len(pressure), lines.size))
    np.cumsum(pressure * lengths, axis=1, out=total[:, 1:])
    size = min(patch, lines[-1])
    starts = np.clip(np.concatenate([lines, lines - size]), 0.0, lines[-1] - size)

    def carried(places: Array) -> Array:
        cell = np.clip(np.searchsorted(lines, places) - 1, 0, lengths.size - 1)
        part: Array = total[:, cell] + pressure[:, cell] * (places - lines[cell])
        return part

    return float((carried(starts + size) - carried(starts)).max() / size)


def _fits(cut: Undercut, joint: EdgeJoint) -> bool:
    """Whether a groove leaves some wall and some length."""
    wall = joint.outer_radius - joint.bushing_radius
    return cut.lip + cut.width < wall and cut.depth < joint.length / 2


def _mirrored(lines: Array) -> Array:
    """Lines of both halves."""
    return np.concatenate([-lines[:0:-1], lines])


def graded_lines(extent: float, *, first: float, growth: float, largest: float) -> Array:
    """Lines from 0 to an extent: the first cell as given, the others growing to the largest."""
    steps = [min(first, extent)]
    while sum(steps) < extent:
        steps.append(min(steps[-1] * growth, largest))
    if len(steps) > 1:  # the surplus is taken off the cells in proportion to their growth
        grown = np.array(steps) - steps[0]
        surplus = sum(steps) - extent
        share = grown if grown.sum() > surplus else np.array(steps)
        steps = list(np.array(steps) - surplus * share / share.sum())
    lines = np.concatenate([[0.0], np.cumsum(steps)])
    lines[-1] = extent
    return lines


def _radial_lines(extent: float, smallest: float) -> Array:
    """Lines below a surface: cells of a fifth of the axial ones at it, growing fast below."""
    return graded_lines(extent, first=smallest / 5, growth=1.7, largest=extent / 4)


def _with_lines(lines: Array, more: Sequence[float]) -> Array:
    """Grid lines with given ones among them."""
    near = 1e-9 * lines[-1]
    missing = [place for place in more if np.abs(lines - place).min() > near]
    return np.sort(np.concatenate([lines, missing]))


def _lobe_shape(
    places: Array, centres: Sequence[float], radius: float, height: float, half: float
) -> Array:
    """Height that lobes add to the gap: negative on a lobe."""
    if not len(centres) or height == 0:
        return np.zeros(places.size)
    if max(centres) >= half or min(centres) < 0:
        raise ModelError(
            f"Lobes lie from 0 to the end of the bushing at {half:g} m, got {list(centres)}; those "
            "of the other half are the same."
        )
    return np.asarray(lobe_shape(places, centres=centres, radius=radius, height=height))
