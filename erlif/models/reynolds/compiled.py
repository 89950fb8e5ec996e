"""The steps of `erlif.models.reynolds.balance` for the joint, compiled: many cycles, many fits.

The half-angle frame, rigid walls and axes round the joint alone; everything else takes the plain
form, to which tests hold this one. A step that does not converge is given back to the plain form.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from erlif.models.reynolds.flow import ROUGHNESS_AMPLITUDE, ROUGHNESS_DECAY, SMALLEST_FLUIDITY


@njit(cache=True, nogil=True, error_model="numpy")
def _mobility(film, viscosity, roughness):  # type: ignore[no-untyped-def]
    """As `Fluid.mobility`, for one film."""
    square = film * film / (12 * viscosity)
    if roughness == 0.0:
        return square * film, 3 * square
    missing = ROUGHNESS_AMPLITUDE * np.exp(-ROUGHNESS_DECAY / roughness * film)
    smooth = square * film
    slope = 3 * square * (1 - missing) + smooth * missing * ROUGHNESS_DECAY / roughness
    return smooth * (1 - missing), slope


@njit(cache=True, nogil=True, error_model="numpy")
def _solve(band, sides, width):  # type: ignore[no-untyped-def]
    """Solve a band in place, without exchange of rows: every column has its largest term first."""
    rows, count = sides.shape
    for r in range(rows):
        pivot = 1.0 / band[r, width]
        for i in range(1, min(width, rows - 1 - r) + 1):
            factor = band[r + i, width - i] * pivot
            if factor == 0.0:
                continue
            for j in range(1, width + 1):
                band[r + i, width - i + j] -= factor * band[r, width + j]
            for s in range(count):
                sides[r + i, s] -= factor * sides[r, s]
    for r in range(rows - 1, -1, -1):
        for j in range(1, min(width, rows - 1 - r) + 1):
            link = band[r, width + j]
            if link == 0.0:
                continue
            for s in range(count):
                sides[r, s] -= link * sides[r + j, s]
        for s in range(count):
            sides[r, s] /= band[r, width]


@njit(cache=True, nogil=True, error_model="numpy")
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


@njit(cache=True, nogil=True, error_model="numpy")
def _turn(directions, angle, cosine, sine):  # type: ignore[no-untyped-def]
    """Cosine and sine of directions after a rotation, in place."""
    c, s = np.cos(angle), np.sin(angle)
    for i in range(cosine.size):
        cosine[i] = directions[0, i] * c - directions[1, i] * s
        sine[i] = directions[1, i] * c + directions[0, i] * s


@njit(cache=True, nogil=True, error_model="numpy")
def march(  # type: ignore[no-untyped-def]
    first,
    last,
    time,
    turned,
    toward,
    loads,
    speeds,
    mount,
    gap_cells,
    gap_faces,
    sizes,
    ways_across,
    end_weights,
    fluid,
    limits,
    grooves,
    position,
    earlier,
    pressure,
    full,
    content,
    void,
    rows,
):
    """Make the steps from `first` to `last`, in place; the first step that was not made.

    Parameters
    ----------
    first, last : int
        Steps from and to which, the last one left out.
    time, turned, speeds : array, (step,)
        Times, angles of the cells, and speeds of the moving surface. [s; rad; m/s]
    toward : float
        Direction of the mount. [rad]
    loads : array, (2, step)
        Load along and across that direction. [N]
    mount : array, (3,)
        Whether the pin is guided, stiffness and rest. [1; N/m; m]
    gap_cells, gap_faces : array, (axial,), (axial + 1,)
        Gap of a centred pin. [m]
    sizes : array, (4,)
        Sizes of a cell along and across, images of the cells, radius. [m; m; 1; m]
    ways_across : array, (axial + 1,)
        Width over length of the flow across. [1]
    end_weights : array, (2, 2)
        As `Grid.end_weights`.
    fluid : array, (4,)
        Viscosity, pressure-viscosity, roughness, reduced cavitation pressure.
    limits : array, (5,)
        SWITCH_TOLERANCE, RESIDUAL_TOLERANCE, LARGEST_APPROACH and MOST_ITERATIONS of `balance`,
        THINNEST_FILM of `transient`: arguments, because the cache of compiled code follows this
        file alone.
    grooves : array, (groove, 2)
        Angles and widths. [rad]
    position, earlier : array, (2,), (3,)
        Displacement; that of the step before, and the time of that step.
    pressure, full, content, void : array, (along, across)
        The film, with reduced pressures.
    rows : array, (step, column)
        Results in the order of `transient.SERIES`; displacements and reactions along the axes of
        the mount.

    Returns
    -------
    int
        `last`, or the step that the plain form must make.
    """
    n, nz = pressure.shape
    dx, dz, images, radius = sizes
    viscosity, alpha, roughness, floor = fluid
    switch_tolerance, residual_tolerance, largest_approach, most_iterations, thinnest_film = limits
    guided = mount[0] > 0
    free = 1 if guided else 2
    way_along = dz / dx
    area = dx * dz
    single = nz == 1 and ways_across[0] == 0.0 and ways_across[1] == 0.0
    step_angle = 2 * np.pi / n
    most = int(most_iterations) + n + nz

    # directions of cells and faces; those after a rotation are sums of products of these
    cells, faces = np.empty((2, n)), np.empty((2, n))
    for i in range(n):
        angle = i * step_angle
        cells[0, i], cells[1, i] = np.cos(angle), np.sin(angle)
        angle -= step_angle / 2
        faces[0, i], faces[1, i] = np.cos(angle), np.sin(angle)

    cosine, sine = np.empty(n), np.empty(n)  # of the new film
    pull_cosine, pull_sine = np.empty(n), np.empty(n)  # of the middle of the step
    taken_before, taken_face_before = np.empty(n), np.empty(n)
    face_cosine, face_sine = np.empty(n), np.empty(n)
    film = np.empty((n, nz))
    along, along_slope = np.empty((n, nz)), np.empty((n, nz))
    across, across_slope = np.zeros((n, nz + 1)), np.zeros((n, nz + 1))
    inflow, oil = np.empty((n, nz)), np.empty((n, nz))
    supplied = np.zeros(n, dtype=np.bool_)
    p, filled = np.empty((n, nz)), np.empty((n, nz), dtype=np.bool_)
    band = np.zeros((n * nz, 2 * nz + 1))
    sides = np.empty((n * nz, free + 1))
    force, missing = np.zeros(2), np.zeros(2)
    push = np.zeros((free + 1, 2))
    shift = np.zeros(2)
    steps_along = np.empty((n, nz))
    steps_across = np.zeros((n, nz + 1))

    for k in range(first, last):
        dt = time[k] - time[k - 1]
        rate = 1 / dt
        storage = area * rate
        _turn(cells, turned[k - 1] - toward, cosine, sine)
        _turn(faces, turned[k - 1] - toward, face_cosine, face_sine)
        for i in range(n):
            taken_before[i] = position[0] * cosine[i] + position[1] * sine[i]
            taken_face_before[i] = position[0] * face_cosine[i] + position[1] * face_sine[i]
        _turn(cells, 0.5 * (turned[k] + turned[k - 1]) - toward, pull_cosine, pull_sine)
        _turn(cells, turned[k] - toward, cosine, sine)
        _turn(faces, turned[k] - toward, face_cosine, face_sine)
        _supply(supplied, grooves, turned[k])

        # the last film, moved on as it moved before where enough of it remains
        ex, ey = position[0], position[1]
        if earlier[2] > 0:
            ahead_x = ex + (ex - earlier[0]) * dt / earlier[2]
            ahead_y = ey + (ey - earlier[1]) * dt / earlier[2] if not guided else ey
            now, then = np.inf, np.inf
            for i in range(n):
                now = min(now, -ex * cosine[i] - ey * sine[i])
                then = min(then, -ahead_x * cosine[i] - ahead_y * sine[i])
            least = gap_cells.min()
            if least + then >= 0.3 * (least + now):
                ex, ey = ahead_x, ahead_y
        for i in range(n):
            for j in range(nz):
                p[i, j], filled[i, j] = pressure[i, j], full[i, j]
                if supplied[i]:
                    p[i, j], filled[i, j] = 0.0, True

        solved = False
        iterations = 0
        load = 0.5 * (loads[0, k] + loads[0, k - 1])
        load_aside = 0.5 * (loads[1, k] + loads[1, k - 1]) if not guided else 0.0
        size = max(np.hypot(load, load_aside), 1e-9)
        for iteration in range(most):
            iterations = iteration
            # film and conductances
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
                    along[i, j], along_slope[i, j] = a * way_along, b * way_along
                if not single:
                    for j in range(nz + 1):
                        face = gap_faces[j] - 0.5 * (taken + taken_before[i])
                        a, b = _mobility(face, viscosity, roughness)
                        across[i, j], across_slope[i, j] = a * ways_across[j], b * ways_across[j]
            if not thinnest > 0:
                return k

            # flow, and the cells that change; once more after a change
            changed = False
            for attempt in range(2):
                highest = 1.0
                for i in range(n):
                    before = i - 1 if i > 0 else n - 1
                    for j in range(nz):
                        steps_along[i, j] = p[i, j] - p[before, j]
                        highest = max(highest, abs(p[i, j]))
                    if not single:
                        for j in range(1, nz):
                            steps_across[i, j] = p[i, j] - p[i, j - 1]
                        steps_across[i, 0] = p[i, 0]
                        if end_weights[0, 1] != 0.0 and filled[i, 0]:
                            steps_across[i, 0] = (
                                end_weights[0, 0] * p[i, 0] - end_weights[0, 1] * p[i, 1]
                            )
                        steps_across[i, nz] = -p[i, nz - 1]
                        if end_weights[1, 1] != 0.0 and filled[i, nz - 1]:
                            steps_across[i, nz] = -(
                                end_weights[1, 0] * p[i, nz - 1] - end_weights[1, 1] * p[i, nz - 2]
                            )
                for i in range(n):
                    behind = i + 1 if i < n - 1 else 0
                    for j in range(nz):
                        flow = along[behind, j] * steps_along[behind, j]
                        flow -= along[i, j] * steps_along[i, j]
                        if not single:
                            flow += across[i, j + 1] * steps_across[i, j + 1]
                            flow -= across[i, j] * steps_across[i, j]
                        inflow[i, j] = flow
                        oil[i, j] = content[i, j] + flow / storage
                if attempt == 1:
                    break
                for i in range(n):
                    for j in range(nz):
                        if filled[i, j]:
                            if p[i, j] < floor - switch_tolerance * highest:
                                filled[i, j], p[i, j], changed = False, floor, True
                        elif film[i, j] - oil[i, j] < -switch_tolerance * film[i, j]:
                            filled[i, j], changed = True, True
                if not changed:
                    break

            # what does not balance
            worst = 0.0
            force[:] = 0.0
            for i in range(n):
                for j in range(nz):
                    if alpha > 0:
                        rest = max(1 - alpha * p[i, j], SMALLEST_FLUIDITY)
                        here = -np.log(rest) / alpha * area * images
                    else:
                        here = p[i, j] * area * images
                    force[0] += here * pull_cosine[i]
                    force[1] += here * pull_sine[i]
                    if filled[i, j] and not supplied[i]:
                        error = abs(inflow[i, j] - storage * (film[i, j] - content[i, j]))
                        worst = max(worst, error / (storage * film[i, j]))
            missing[0] = load - force[0]
            missing[1] = load_aside - force[1] - mount[1] * (ey - mount[2]) if not guided else 0.0
            scale = max(size, 1e-3 * abs(force[0]))
            if not guided:
                scale = max(scale, 1e-3 * abs(force[1]))
            unbalanced = max(abs(missing[0]), abs(missing[1])) / scale
            if not changed and max(worst, unbalanced) <= residual_tolerance:
                solved = True
                break

            # the ring is cut at a column whose cells are all known
            cut = -1
            for i in range(n):
                known = True
                for j in range(nz):
                    known = known and (supplied[i] or not filled[i, j])
                if known:
                    cut = i
                    break
            if cut < 0:
                return k
            for c in range(n):
                i = (c + cut) % n
                before = i - 1 if i > 0 else n - 1
                behind = i + 1 if i < n - 1 else 0
                for j in range(nz):
                    r = c * nz + j
                    for b in range(2 * nz + 1):
                        band[r, b] = 0.0
                    if supplied[i] or not filled[i, j]:
                        band[r, nz] = 1.0
                        for s in range(free + 1):
                            sides[r, s] = 0.0
                        continue

                    centre = -along[i, j] - along[behind, j]
                    if c > 0 and filled[before, j] and not supplied[before]:
                        band[r, 0] += along[i, j]
                    if c < n - 1 and filled[behind, j] and not supplied[behind]:
                        band[r, 2 * nz] += along[behind, j]
                    if not single:
                        lower, upper = across[i, j], across[i, j + 1]
                        centre -= lower + upper
                        if j == 0 and end_weights[0, 1] != 0.0:
                            centre -= (end_weights[0, 0] - 1) * lower
                            upper += end_weights[0, 1] * lower
                        if j == nz - 1 and end_weights[1, 1] != 0.0:
                            centre -= (end_weights[1, 0] - 1) * upper
                            lower += end_weights[1, 1] * upper
                        if j > 0 and filled[i, j - 1]:
                            band[r, nz - 1] += lower
                        if j < nz - 1 and filled[i, j + 1]:
                            band[r, nz + 1] += upper
                    band[r, nz] += centre

                    # the error, and its changes with the displacements
                    sides[r, 0] = -(inflow[i, j] - storage * (film[i, j] - content[i, j]))
                    first_flow = 0.5 * along_slope[behind, j] * steps_along[behind, j]
                    second_flow = 0.5 * along_slope[i, j] * steps_along[i, j]
                    side_flow = 0.0
                    if not single:
                        side_flow = 0.5 * across_slope[i, j + 1] * steps_across[i, j + 1]
                        side_flow -= 0.5 * across_slope[i, j] * steps_across[i, j]
                    sides[r, 1] = (
                        first_flow * face_cosine[behind]
                        - second_flow * face_cosine[i]
                        + (side_flow - storage) * cosine[i]
                    )
                    if not guided:
                        sides[r, 2] = (
                            first_flow * face_sine[behind]
                            - second_flow * face_sine[i]
                            + (side_flow - storage) * sine[i]
                        )
            _solve(band, sides, nz)

            # displacements that restore the forces
            push[:] = 0.0
            for c in range(n):
                i = (c + cut) % n
                for j in range(nz):
                    slope = area * images
                    if alpha > 0:
                        slope /= max(1 - alpha * p[i, j], SMALLEST_FLUIDITY)
                    for s in range(free + 1):
                        here = slope * sides[c * nz + j, s]
                        push[s, 0] += here * pull_cosine[i]
                        push[s, 1] += here * pull_sine[i]
            shift[:] = 0.0
            if guided:
                if push[1, 0] == 0.0:
                    return k
                shift[0] = (missing[0] - push[0, 0]) / push[1, 0]
            else:
                a, b = push[1, 0], push[2, 0]
                c1, d = push[1, 1], push[2, 1] + mount[1]
                left, right = missing[0] - push[0, 0], missing[1] - push[0, 1]
                determinant = a * d - b * c1
                if determinant == 0.0:
                    return k
                shift[0] = (left * d - b * right) / determinant
                shift[1] = (a * right - c1 * left) / determinant
            nearest = 0.0
            for i in range(n):
                nearer = shift[0] * cosine[i] + shift[1] * sine[i]
                for j in range(nz):
                    nearest = max(nearest, nearer / film[i, j])
            share = 1.0 if nearest <= largest_approach else largest_approach / nearest
            ex += share * shift[0]
            ey += share * shift[1]
            for c in range(n):
                i = (c + cut) % n
                for j in range(nz):
                    delta = sides[c * nz + j, 0]
                    for s in range(free):
                        delta += shift[s] * sides[c * nz + j, s + 1]
                    p[i, j] += share * delta
        least = gap_cells.min() - np.hypot(ex, ey)
        if not solved or alpha * p.max() >= 1 - SMALLEST_FLUIDITY or least < thinnest_film:
            return k

        # the step is made: content by the flow, and its numbers
        supply, volume, shear, drag, heat, out, peak = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -np.inf
        for i in range(n):
            before = i - 1 if i > 0 else n - 1
            for j in range(nz):
                gap = film[i, j]
                if supplied[i]:
                    supply += storage * (gap - content[i, j]) - inflow[i, j]
                    content[i, j] = gap
                else:
                    content[i, j] = oil[i, j]
                void[i, j] = 0.0 if filled[i, j] else gap - oil[i, j]
                here, thick, other = p[i, j], viscosity, p[before, j]
                if alpha > 0:
                    here = -np.log(1 - alpha * here) / alpha
                    other = -np.log(1 - alpha * other) / alpha
                    thick = viscosity * np.exp(alpha * here)
                peak = max(peak, here)
                volume += content[i, j]
                middle = gap_cells[j] - 0.5 * (ex * cosine[i] + ey * sine[i] + taken_before[i])
                shear += thick * (1 - min(max(void[i, j] / gap, 0.0), 1.0)) / middle
                face = gap_cells[j] - 0.5 * (
                    ex * face_cosine[i] + ey * face_sine[i] + taken_face_before[i]
                )
                drag += face * (here - other)
                heat += along[i, j] * steps_along[i, j] * (here - other)
                pressure[i, j], full[i, j] = p[i, j], filled[i, j]
            if not single:
                out += across[i, 0] * steps_across[i, 0] - across[i, nz] * steps_across[i, nz]
                for j in range(nz + 1):
                    drop = steps_across[i, j]
                    if alpha > 0 and 0 < j < nz:
                        drop = np.log((1 - alpha * p[i, j - 1]) / (1 - alpha * p[i, j])) / alpha
                    heat += across[i, j] * steps_across[i, j] * drop
        shear *= speeds[k] * area * images
        earlier[0], earlier[1], earlier[2] = position[0], position[1], dt
        position[0], position[1] = ex, ey
        rows[k, 0], rows[k, 1], rows[k, 2] = ex, ey, thinnest
        rows[k, 3], rows[k, 4], rows[k, 5] = peak, force[0], force[1]
        rows[k, 6] = radius * (shear + 0.5 * images * dz * drag)
        rows[k, 7], rows[k, 8] = images * out, images * supply
        rows[k, 9], rows[k, 10] = images * area * volume, images * heat + speeds[k] * shear
        rows[k, 11] = iterations
    return last
