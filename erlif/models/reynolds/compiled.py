"""The steps of `erlif.models.reynolds.balance` for the joint, compiled: many cycles, many fits.

The half-angle frame, rigid walls and axes round the joint alone; everything else takes the plain
form, to which tests hold this one. A step that does not converge is given back to the plain form.
The tolerances of `balance` are compiled in: after a change of one, numba's cache must be cleared.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.core.speed.kernels import njit
from erlif.models.reynolds.balance import (
    LARGEST_APPROACH,
    MOST_ITERATIONS,
    RESIDUAL_TOLERANCE,
    SWITCH_TOLERANCE,
    THINNEST_FILM,
)
from erlif.models.reynolds.flow import SMALLEST_FLUIDITY, mobility_of

# parts of `march`: laid in line by numba, they would take a twentieth off a step, and a third more
# time and 230 MB more memory to compile
_part = njit(error_model="numpy")


class CompiledJoint(NamedTuple):
    """Data of the joint that are the same in all steps.

    Attributes
    ----------
    gap_cells : Array
        Gap of a centred pin at the cells, (axial,). [m]
    gap_faces : Array
        And at their faces, (axial + 1,). [m]
    dx : float
        Size of a cell along. [m]
    dz : Array
        Sizes of the cells across, (axial,). [m]
    images : int
        As `Medium.images`.
    radius : float
        Radius at which the film lies. [m]
    ways_across : Array
        Width over length of the flow across, (axial + 1,). [1]
    end_weights : Array
        As `Grid.end_weights`, (2, 2); the second is zero at a closed end.
    viscosity : float
        As of `Fluid`. [Pa s]
    pressure_viscosity : float
        As of `Fluid`. [1/Pa]
    roughness : float
        As of `Fluid`. [m]
    floor : float
        Reduced cavitation pressure. [Pa]
    guided : bool
        Whether the pin moves along one line alone.
    stiffness : float
        Spring aside of that line. [N/m]
    rest : float
        Where that spring is without force. [m]
    toward : float
        Direction of the line. [rad]
    grooves : Array
        Angles and widths, (groove, 2). [rad]
    """

    gap_cells: Array
    gap_faces: Array
    dx: float
    dz: Array
    images: int
    radius: float
    ways_across: Array
    end_weights: Array
    viscosity: float
    pressure_viscosity: float
    roughness: float
    floor: float
    guided: bool
    stiffness: float
    rest: float
    toward: float
    grooves: Array


class Drive(NamedTuple):
    """Motion and load of the joint at each step.

    Attributes
    ----------
    time : Array
        (step,). [s]
    turned : Array
        Angles of the cells, (step,). [rad]
    speeds : Array
        Speeds of the moving surface, (step,). [m/s]
    loads : Array
        Load along and across the direction of the mount, (2, step). [N]
    """

    time: Array
    turned: Array
    speeds: Array
    loads: Array


class Film(NamedTuple):
    """The film after the last step, changed in place.

    Attributes
    ----------
    position : Array
        Displacement, (2,). [m]
    earlier : Array
        That of the step before, and the time of that step, (3,). [m, m, s]
    pressure : Array
        Reduced pressure, (along, across). [Pa]
    full : Mask
        Cells without void.
    content : Array
        Height of the oil. [m]
    void : Array
        Height of the void. [m]
    """

    position: Array
    earlier: Array
    pressure: Array
    full: Mask
    content: Array
    void: Array


class _Work(NamedTuple):
    """The iterate of one step: directions of cells and faces, film, flow, and linear equations."""

    place: Array  # displacement, (2,)
    pressure: Array
    full: Mask
    supplied: Mask  # columns, (along,)
    cells: Array  # cosine and sine of the cells, (2, along)
    faces: Array
    pulls: Array  # of the cells in the middle of the step
    taken: Array  # film that the displacement before the step took at cells and faces, (2, along)
    film: Array
    along: Array  # conductance of the face before each cell
    along_slope: Array  # and its change with the film
    across: Array
    across_slope: Array
    steps_along: Array  # steps of the reduced pressure over the faces
    steps_across: Array
    inflow: Array
    oil: Array  # content that this inflow leaves
    force: Array  # (2,)
    missing: Array  # (2,)
    band: Array
    sides: Array  # right sides: the error, then its change with each displacement


# the cache of compiled code follows this file alone: touch it where `mobility_of` has changed
_mobility = _part(mobility_of)


@_part
def _solve(band, sides, width):  # type: ignore[no-untyped-def]
    """Solve a band in place, without exchange of rows: every column has its largest term first."""
    rows, count = sides.shape
    for r in range(rows):
        pivot, links, own = 1.0 / band[r, width], band[r, width + 1 :], sides[r]
        for i in range(1, min(width, rows - 1 - r) + 1):
            factor = band[r + i, width - i] * pivot
            if factor == 0.0:
                continue
            row, other = band[r + i, width - i + 1 :], sides[r + i]
            for j in range(width):
                row[j] -= factor * links[j]
            for s in range(count):
                other[s] -= factor * own[s]
    for r in range(rows - 1, -1, -1):
        links, own = band[r, width + 1 :], sides[r]
        for j in range(min(width, rows - 1 - r)):
            if links[j] == 0.0:
                continue
            other = sides[r + 1 + j]
            for s in range(count):
                own[s] -= links[j] * other[s]
        for s in range(count):
            own[s] /= band[r, width]


@_part
def _supply(supplied, grooves, turned):  # type: ignore[no-untyped-def]
    """As `covered`, for cells that have turned."""
    n = supplied.size
    size = 2 * np.pi / n
    supplied[:] = False
    for g in range(grooves.shape[0]):
        nearest, best = 0, 10.0
        for i in range(n):
            off = abs((i * size + turned - grooves[g, 0] + np.pi) % (2 * np.pi) - np.pi)
            if off < best:
                nearest, best = i, off
            if grooves[g, 1] > 0 and off < grooves[g, 1] / 2:
                supplied[i] = True
        supplied[nearest] = True


@_part
def _compass(number, shift):  # type: ignore[no-untyped-def]
    """Cosine and sine of cells at rest, or of their faces with a shift of half a cell."""
    found = np.empty((2, number))
    step = 2 * np.pi / number
    for i in range(number):
        angle = i * step - shift * step
        found[0, i], found[1, i] = np.cos(angle), np.sin(angle)
    return found


@_part
def _turn(directions, angle, turned):  # type: ignore[no-untyped-def]
    """Cosine and sine of directions after a rotation, in place."""
    c, s = np.cos(angle), np.sin(angle)
    for i in range(turned.shape[1]):
        turned[0, i] = directions[0, i] * c - directions[1, i] * s
        turned[1, i] = directions[1, i] * c + directions[0, i] * s


@_part
def _begin(joint, drive, film, work, compass, k):  # type: ignore[no-untyped-def]
    """Directions and supply of a step, and the last film as its first guess."""
    n, nz = film.pressure.shape
    cells, faces = compass
    position = film.position
    _turn(cells, drive.turned[k - 1] - joint.toward, work.cells)
    _turn(faces, drive.turned[k - 1] - joint.toward, work.faces)
    for i in range(n):
        work.taken[0, i] = position[0] * work.cells[0, i] + position[1] * work.cells[1, i]
        work.taken[1, i] = position[0] * work.faces[0, i] + position[1] * work.faces[1, i]
    middle = 0.5 * (drive.turned[k] + drive.turned[k - 1])
    _turn(cells, middle - joint.toward, work.pulls)
    _turn(cells, drive.turned[k] - joint.toward, work.cells)
    _turn(faces, drive.turned[k] - joint.toward, work.faces)
    _supply(work.supplied, joint.grooves, drive.turned[k])

    # the last film, moved on as it moved before where enough of it remains
    dt = drive.time[k] - drive.time[k - 1]
    ex, ey = position[0], position[1]
    work.place[0], work.place[1] = ex, ey
    if film.earlier[2] > 0:
        ahead_x = ex + (ex - film.earlier[0]) * dt / film.earlier[2]
        ahead_y = ey
        if not joint.guided:
            ahead_y = ey + (ey - film.earlier[1]) * dt / film.earlier[2]
        now, then = np.inf, np.inf
        for i in range(n):
            now = min(now, -ex * work.cells[0, i] - ey * work.cells[1, i])
            then = min(then, -ahead_x * work.cells[0, i] - ahead_y * work.cells[1, i])
        least = joint.gap_cells.min()
        if least + then >= 0.3 * (least + now):
            work.place[0], work.place[1] = ahead_x, ahead_y
    for i in range(n):
        for j in range(nz):
            work.pressure[i, j], work.full[i, j] = film.pressure[i, j], film.full[i, j]
            if work.supplied[i]:
                work.pressure[i, j], work.full[i, j] = 0.0, True


@_part
def _conduct(joint, work, single):  # type: ignore[no-untyped-def]
    """Film, and conductances of the film in the middle of the step; the smallest film."""
    n, nz = work.film.shape
    ex, ey = work.place[0], work.place[1]
    way_along = joint.dz / joint.dx
    gap_cells, gap_faces, film = joint.gap_cells, joint.gap_faces, work.film
    viscosity, roughness, ways_across = joint.viscosity, joint.roughness, joint.ways_across
    cosine, sine = work.cells[0], work.cells[1]
    face_cosine, face_sine = work.faces[0], work.faces[1]
    taken_before, taken_face_before = work.taken[0], work.taken[1]
    along, along_slope = work.along, work.along_slope
    across, across_slope = work.across, work.across_slope

    # the walls are rigid: each column has lost one height to the displacement
    thinnest = np.inf
    for i in range(n):
        taken = ex * cosine[i] + ey * sine[i]
        taken_face = ex * face_cosine[i] + ey * face_sine[i]
        for j in range(nz):
            film[i, j] = gap_cells[j] - taken
            face = gap_cells[j] - taken_face
            thinnest = min(thinnest, film[i, j], face)
            face = gap_cells[j] - 0.5 * (taken_face + taken_face_before[i])
            a, b = _mobility(face, viscosity, roughness)
            along[i, j], along_slope[i, j] = a * way_along[j], b * way_along[j]
        if single:
            continue
        for j in range(nz + 1):
            face = gap_faces[j] - 0.5 * (taken + taken_before[i])
            a, b = _mobility(face, viscosity, roughness)
            across[i, j] = a * ways_across[j]
            across_slope[i, j] = b * ways_across[j]
    return thinnest


@_part
def _flow(joint, work, content, storage, single):  # type: ignore[no-untyped-def]
    """Compute the flow into each cell, and the oil content after it."""
    n, nz = work.film.shape
    p, steps_along, steps_across = work.pressure, work.steps_along, work.steps_across
    weights = joint.end_weights
    full, along, across = work.full, work.along, work.across
    inflow, oil = work.inflow, work.oil

    # ambient pressure lies half a cell beyond an end, where a full film is a parabola
    for i in range(n):
        before = i - 1 if i > 0 else n - 1
        for j in range(nz):
            steps_along[i, j] = p[i, j] - p[before, j]
        if single:
            continue
        for j in range(1, nz):
            steps_across[i, j] = p[i, j] - p[i, j - 1]
        steps_across[i, 0] = p[i, 0]
        if weights[0, 1] != 0.0 and full[i, 0]:
            steps_across[i, 0] = weights[0, 0] * p[i, 0] - weights[0, 1] * p[i, 1]
        steps_across[i, nz] = -p[i, nz - 1]
        if weights[1, 1] != 0.0 and full[i, nz - 1]:
            steps_across[i, nz] = -(weights[1, 0] * p[i, nz - 1] - weights[1, 1] * p[i, nz - 2])

    # what stays in a cell is its oil of before and what has flown in
    for i in range(n):
        behind = i + 1 if i < n - 1 else 0
        for j in range(nz):
            flow = along[behind, j] * steps_along[behind, j]
            flow -= along[i, j] * steps_along[i, j]
            if not single:
                flow += across[i, j + 1] * steps_across[i, j + 1]
                flow -= across[i, j] * steps_across[i, j]
            inflow[i, j] = flow
            oil[i, j] = content[i, j] + flow / storage[j]


@_part
def _switch(work, floor):  # type: ignore[no-untyped-def]
    """Exchange cells with a negative pressure or void; whether any were."""
    n, nz = work.film.shape
    highest, changed = 1.0, False
    pressure, full, film, oil = work.pressure, work.full, work.film, work.oil
    for i in range(n):
        for j in range(nz):
            highest = max(highest, abs(pressure[i, j]))
    for i in range(n):
        for j in range(nz):
            if full[i, j]:
                if pressure[i, j] < floor - SWITCH_TOLERANCE * highest:
                    full[i, j], pressure[i, j], changed = False, floor, True
            elif film[i, j] - oil[i, j] < -SWITCH_TOLERANCE * film[i, j]:
                full[i, j], changed = True, True
    return changed


@_part
def _unbalanced(joint, drive, film, work, storage, k):  # type: ignore[no-untyped-def]
    """Largest error of the balance of a full cell or of the forces, relative."""
    n, nz = work.film.shape
    alpha, area = joint.pressure_viscosity, joint.dx * joint.dz
    force, missing = work.force, work.missing
    worst = 0.0
    pressure, pulls, full, inflow = work.pressure, work.pulls, work.full, work.inflow
    supplied, gap, content, images = work.supplied, work.film, film.content, joint.images
    force[:] = 0.0
    for i in range(n):
        for j in range(nz):
            if alpha > 0:
                rest = max(1 - alpha * pressure[i, j], SMALLEST_FLUIDITY)
                here = -np.log(rest) / alpha * area[j] * images
            else:
                here = pressure[i, j] * area[j] * images
            force[0] += here * pulls[0, i]
            force[1] += here * pulls[1, i]
            if full[i, j] and not supplied[i]:
                kept = storage[j] * (gap[i, j] - content[i, j])
                error = abs(inflow[i, j] - kept)
                worst = max(worst, error / (storage[j] * gap[i, j]))

    # an unloaded film has no scale but its own pressure
    load = 0.5 * (drive.loads[0, k] + drive.loads[0, k - 1])
    aside = 0.0 if joint.guided else 0.5 * (drive.loads[1, k] + drive.loads[1, k - 1])
    scale = max(max(np.hypot(load, aside), 1e-9), 1e-3 * abs(force[0]))
    missing[0], missing[1] = load - force[0], 0.0
    if not joint.guided:
        missing[1] = aside - force[1] - joint.stiffness * (work.place[1] - joint.rest)
        scale = max(scale, 1e-3 * abs(force[1]))
    return max(worst, max(abs(missing[0]), abs(missing[1])) / scale)


@_part
def _known_column(work):  # type: ignore[no-untyped-def]
    """A column whose cells are all known, where the ring is cut; -1 where there is none."""
    for i in range(work.supplied.size):
        if work.supplied[i] or not work.full[i].any():
            return i
    return -1


@_part
def _link(joint, work, cut, single):  # type: ignore[no-untyped-def]
    """Coefficients of the balances by the pressures of a cell and its neighbours."""
    n, nz = work.film.shape
    full, supplied, along, across = work.full, work.supplied, work.along, work.across
    band, weights = work.band, joint.end_weights
    band[:] = 0.0

    # rows begin at the cut; a known cell keeps its value and gives no links
    for c in range(n):
        i = c + cut if c + cut < n else c + cut - n
        before = i - 1 if i > 0 else n - 1
        behind = i + 1 if i < n - 1 else 0
        for j in range(nz):
            r = c * nz + j
            if supplied[i] or not full[i, j]:
                band[r, nz] = 1.0
                continue
            centre = -along[i, j] - along[behind, j]
            if c > 0 and full[before, j] and not supplied[before]:
                band[r, 0] += along[i, j]
            if c < n - 1 and full[behind, j] and not supplied[behind]:
                band[r, 2 * nz] += along[behind, j]
            if not single:
                lower, upper = across[i, j], across[i, j + 1]
                centre -= lower + upper
                if j == 0 and weights[0, 1] != 0.0:
                    centre -= (weights[0, 0] - 1) * lower
                    upper += weights[0, 1] * lower
                if j == nz - 1 and weights[1, 1] != 0.0:
                    centre -= (weights[1, 0] - 1) * upper
                    lower += weights[1, 1] * upper
                if j > 0 and full[i, j - 1]:
                    band[r, nz - 1] += lower
                if j < nz - 1 and full[i, j + 1]:
                    band[r, nz + 1] += upper
            band[r, nz] += centre


@_part
def _derive(film, work, storage, cut, single):  # type: ignore[no-untyped-def]
    """The errors of the balances, and their changes with the displacements."""
    n, nz = work.film.shape
    sides, faces, cells = work.sides, work.faces, work.cells
    guided = sides.shape[1] == 2
    sides[:] = 0.0

    # a displacement changes the film and with it all conductances of a cell
    along_slope, steps_along = work.along_slope, work.steps_along
    across_slope, steps_across = work.across_slope, work.steps_across
    gap, content, inflow = work.film, film.content, work.inflow
    full, supplied = work.full, work.supplied
    for c in range(n):
        i = c + cut if c + cut < n else c + cut - n
        behind = i + 1 if i < n - 1 else 0
        for j in range(nz):
            r = c * nz + j
            if supplied[i] or not full[i, j]:
                continue
            kept = storage[j] * (gap[i, j] - content[i, j])
            sides[r, 0] = -(inflow[i, j] - kept)
            first = 0.5 * along_slope[behind, j] * steps_along[behind, j]
            second = 0.5 * along_slope[i, j] * steps_along[i, j]
            side = 0.0
            if not single:
                side = 0.5 * across_slope[i, j + 1] * steps_across[i, j + 1]
                side -= 0.5 * across_slope[i, j] * steps_across[i, j]
            sides[r, 1] = (
                first * faces[0, behind] - second * faces[0, i] + (side - storage[j]) * cells[0, i]
            )
            if not guided:
                sides[r, 2] = first * faces[1, behind] - second * faces[1, i]
                sides[r, 2] += (side - storage[j]) * cells[1, i]


@_part
def _shift(joint, work, cut, shift):  # type: ignore[no-untyped-def]
    """Compute the displacements that restore the force balance, in place; True if there are any."""
    n, nz = work.film.shape
    area, alpha = joint.dx * joint.dz, joint.pressure_viscosity

    # force of the pressures that each right side gives, along and across the mount
    push = np.zeros((work.sides.shape[1], 2))
    sides, pulls, pressure, images = work.sides, work.pulls, work.pressure, joint.images
    for c in range(n):
        i = c + cut if c + cut < n else c + cut - n
        for j in range(nz):
            slope = area[j] * images
            if alpha > 0:
                slope /= max(1 - alpha * pressure[i, j], SMALLEST_FLUIDITY)
            for s in range(push.shape[0]):
                here = slope * sides[c * nz + j, s]
                push[s, 0] += here * pulls[0, i]
                push[s, 1] += here * pulls[1, i]
    shift[:] = 0.0
    if joint.guided:
        if push[1, 0] == 0.0:
            return False
        shift[0] = (work.missing[0] - push[0, 0]) / push[1, 0]
        return True
    a, b = push[1, 0], push[2, 0]
    c1, d = push[1, 1], push[2, 1] + joint.stiffness
    left, right = work.missing[0] - push[0, 0], work.missing[1] - push[0, 1]
    determinant = a * d - b * c1
    if determinant == 0.0:
        return False
    shift[0] = (left * d - b * right) / determinant
    shift[1] = (a * right - c1 * left) / determinant
    return True


@_part
def _move(work, cut, shift):  # type: ignore[no-untyped-def]
    """Take a Newton step, or the share of it that leaves enough film everywhere."""
    n, nz = work.film.shape
    nearest = 0.0
    cells, film, sides, pressure = work.cells, work.film, work.sides, work.pressure
    for i in range(n):
        nearer = shift[0] * cells[0, i] + shift[1] * cells[1, i]
        for j in range(nz):
            nearest = max(nearest, nearer / film[i, j])
    share = 1.0 if nearest <= LARGEST_APPROACH else LARGEST_APPROACH / nearest
    work.place[0] += share * shift[0]
    work.place[1] += share * shift[1]
    for c in range(n):
        i = c + cut if c + cut < n else c + cut - n
        for j in range(nz):
            delta = sides[c * nz + j, 0]
            for s in range(sides.shape[1] - 1):
                delta += shift[s] * sides[c * nz + j, s + 1]
            pressure[i, j] += share * delta


@_part
def _advance(joint, drive, film, work, single, k):  # type: ignore[no-untyped-def]
    """Newton steps until a step is solved: their number and the smallest film; -1 if it is not."""
    n, nz = work.film.shape
    storage = joint.dx * joint.dz * (1 / (drive.time[k] - drive.time[k - 1]))
    shift = np.zeros(2)

    # an edge of a cavity may have to move cell by cell through the film
    for iteration in range(MOST_ITERATIONS + n + nz):
        thinnest = _conduct(joint, work, single)
        if not thinnest > 0:
            return -1, thinnest
        _flow(joint, work, film.content, storage, single)
        changed = _switch(work, joint.floor)
        if changed:
            _flow(joint, work, film.content, storage, single)
        error = _unbalanced(joint, drive, film, work, storage, k)
        if not changed and error <= RESIDUAL_TOLERANCE:
            return iteration, thinnest
        cut = _known_column(work)
        if cut < 0:
            return -1, thinnest
        _link(joint, work, cut, single)
        _derive(film, work, storage, cut, single)
        _solve(work.band, work.sides, nz)
        if not _shift(joint, work, cut, shift):
            return -1, thinnest
        _move(work, cut, shift)
    return -1, thinnest


@_part
def _keep(joint, drive, film, work, single, k, row):  # type: ignore[no-untyped-def]
    """Take over the film of a solved step, its content by the flow, and write its numbers."""
    n, nz = work.film.shape
    viscosity, alpha, area = joint.viscosity, joint.pressure_viscosity, joint.dx * joint.dz
    ex, ey = work.place[0], work.place[1]
    dt = drive.time[k] - drive.time[k - 1]
    storage = area * (1 / dt)
    p = work.pressure
    supply, volume, shear, drag, heat, out, peak = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -np.inf
    for i in range(n):
        before = i - 1 if i > 0 else n - 1
        for j in range(nz):
            gap = work.film[i, j]
            if work.supplied[i]:
                supply += storage[j] * (gap - film.content[i, j]) - work.inflow[i, j]
                film.content[i, j] = gap
            else:
                film.content[i, j] = work.oil[i, j]
            film.void[i, j] = 0.0 if work.full[i, j] else gap - work.oil[i, j]
            here, thick, other = p[i, j], viscosity, p[before, j]
            if alpha > 0:
                here = -np.log(1 - alpha * here) / alpha
                other = -np.log(1 - alpha * other) / alpha
                thick = viscosity * np.exp(alpha * here)
            peak = max(peak, here)
            volume += area[j] * film.content[i, j]

            # shear and pressure belong to the film in the middle of the step
            taken = ex * work.cells[0, i] + ey * work.cells[1, i] + work.taken[0, i]
            middle = joint.gap_cells[j] - 0.5 * taken
            shear += area[j] * thick * (1 - min(max(film.void[i, j] / gap, 0.0), 1.0)) / middle
            taken = ex * work.faces[0, i] + ey * work.faces[1, i] + work.taken[1, i]
            drag += joint.dz[j] * (joint.gap_cells[j] - 0.5 * taken) * (here - other)
            heat += work.along[i, j] * work.steps_along[i, j] * (here - other)
            film.pressure[i, j], film.full[i, j] = p[i, j], work.full[i, j]
        if not single:
            near = work.across[i, 0] * work.steps_across[i, 0]
            out += near - work.across[i, nz] * work.steps_across[i, nz]
            for j in range(nz + 1):
                drop = work.steps_across[i, j]
                if alpha > 0 and 0 < j < nz:
                    drop = np.log((1 - alpha * p[i, j - 1]) / (1 - alpha * p[i, j])) / alpha
                heat += work.across[i, j] * work.steps_across[i, j] * drop
    shear *= drive.speeds[k] * joint.images
    film.earlier[0], film.earlier[1], film.earlier[2] = film.position[0], film.position[1], dt
    film.position[0], film.position[1] = ex, ey
    row[0], row[1] = ex, ey
    row[3], row[4], row[5] = peak, work.force[0], work.force[1]
    row[6] = joint.radius * (shear + 0.5 * joint.images * drag)
    row[7], row[8] = joint.images * out, joint.images * supply
    row[9], row[10] = joint.images * volume, joint.images * heat + drive.speeds[k] * shear


@njit(cache=True, nogil=True, error_model="numpy")
def march(first, last, joint, drive, film, rows):  # type: ignore[no-untyped-def]
    """Make the steps from `first` to `last`, in place; the first step that was not made.

    Parameters
    ----------
    first, last : int
        Steps from and to which, the last one left out.
    joint : CompiledJoint
    drive : Drive
    film : Film
    rows : array, (step, column)
        Results in the order of `transient.SERIES`; displacements and reactions along the axes of
        the mount.

    Returns
    -------
    int
        `last`, or the step that the plain form must make.
    """
    n, nz = film.pressure.shape
    cells, faces = (n, nz), (n, nz + 1)
    sides = 2 if joint.guided else 3
    work = _Work(
        place=np.zeros(2),
        pressure=np.empty(cells),
        full=np.empty(cells, dtype=np.bool_),
        supplied=np.zeros(n, dtype=np.bool_),
        cells=np.empty((2, n)),
        faces=np.empty((2, n)),
        pulls=np.empty((2, n)),
        taken=np.empty((2, n)),
        film=np.empty(cells),
        along=np.empty(cells),
        along_slope=np.empty(cells),
        across=np.zeros(faces),
        across_slope=np.zeros(faces),
        steps_along=np.empty(cells),
        steps_across=np.zeros(faces),
        inflow=np.empty(cells),
        oil=np.empty(cells),
        force=np.zeros(2),
        missing=np.zeros(2),
        band=np.zeros((n * nz, 2 * nz + 1)),
        sides=np.empty((n * nz, sides)),
    )

    # one row of cells without open ends has no flow across
    single = nz == 1 and joint.ways_across[0] == 0.0 and joint.ways_across[1] == 0.0
    compass = _compass(n, 0.0), _compass(n, 0.5)
    for k in range(first, last):
        _begin(joint, drive, film, work, compass, k)
        iterations, thinnest = _advance(joint, drive, film, work, single, k)
        least = joint.gap_cells.min() - np.hypot(work.place[0], work.place[1])
        beyond = joint.pressure_viscosity * work.pressure.max() >= 1 - SMALLEST_FLUIDITY
        if iterations < 0 or beyond or least < THINNEST_FILM:
            return k
        _keep(joint, drive, film, work, single, k, rows[k])
        rows[k, 2], rows[k, 11] = thinnest, iterations
    return last
