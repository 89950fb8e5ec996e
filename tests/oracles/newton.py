"""One step of Newton's method for a film that ends where its pressure would fall below zero."""

import numpy as np


def take_step(pressure, approach, active, *, excess, slope, by_approach, area, load, film, sinking):
    """Pressure, approach and active cells after a step, and its size over the largest pressure.

    `excess` is the outflow of the cells, `slope` and `by_approach` its derivatives by pressures and
    approach, `area` that of the cells. `film` at the faces changes with the approach by 1 and with
    the pressures by `sinking`. Cells that are not active have no pressure; the size is infinite
    where others became active.
    """
    change = np.where(active, 0.0, -pressure)
    inside = np.flatnonzero(active)
    matrix = np.zeros((inside.size + 1, inside.size + 1))
    matrix[:-1, :-1], matrix[:-1, -1] = slope[np.ix_(inside, inside)], by_approach[inside]
    matrix[-1, :-1] = area[inside]
    right = np.append(-(excess + slope @ change)[inside], load - (pressure + change) @ area)
    rows = np.abs(matrix).max(axis=1)
    *change[inside], lift = np.linalg.solve(matrix / rows[:, None], right / rows)

    # no step of more than half of the largest pressure, or half of the film
    falling = -(lift + sinking @ change) / film
    step = min(1, 0.5 * pressure.max() / np.abs(change).max(), 0.5 / max(falling.max(), 0.5))
    pressure, approach = pressure + step * change, approach + step * lift
    outlook = excess + slope @ change + by_approach * lift
    changed = np.where(active, pressure > 0, outlook < 0) if step > 0.2 else active
    pressure = np.maximum(pressure, 0)
    same = (changed == active).all()
    return pressure, approach, changed, np.abs(change).max() / pressure.max() if same else np.inf
