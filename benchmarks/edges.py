"""Speed of the contact solver beside tamaas, and the joint of Farzaneh (2002), chapter 3.

python benchmarks/edges.py speed     one contact on 512 x 256 cells, both codes on one core
python benchmarks/edges.py many      100 000 contacts of Hertz and of Winkler
python benchmarks/edges.py errors    against Hertz, and exponents at sharp edges
python benchmarks/edges.py roller    a straight and a crowned roller in both codes
python benchmarks/edges.py thesis    straight and undercut bushing under the loads in question
python benchmarks/edges.py lobes     lobed bushing under 10,000 lbf
python benchmarks/edges.py trends    figures 3-9 and 3-10: pressure against D1, D2 and D3
python benchmarks/edges.py search    the best undercut
python benchmarks/edges.py stress    von Mises stress in the bushing, with and without undercut
python benchmarks/edges.py mesh      the same pressure on finer meshes
python benchmarks/edges.py figure    docs/images/edges.png

OMP_NUM_THREADS=1 and OPENBLAS_NUM_THREADS=1 keep both codes on one core.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.joint.models.edges import (
    EdgeJoint,
    Undercut,
    edge_exponent,
    lundberg_profile,
    prepare_joint,
    search_undercut,
    section_stress,
    solve_contact,
    solve_joint,
)
from erlif.joint.models.edges.cylinders import Section, compute_compliance
from erlif.models.contact import conformal_radius, hertz_ellipse, hertz_line, winkler_contact

POUND = 4.4482216
STEEL = 200e9 / 2 / (1 - 0.3**2)
THESIS = EdgeJoint(0.03336, 0.03359, 0.0533, length=0.2373, pin_length=0.3508)
OPTIMUM = Undercut(depth=0.020, width=0.008, lip=0.0093)
TESTED = Undercut(depth=0.010, width=0.0051, lip=0.00787)


def middles(count: int, extent: float) -> np.ndarray:
    """Middles of equal cells about zero."""
    return (np.arange(count) - (count - 1) / 2) * extent / count


def solve_by_tamaas(
    gap: np.ndarray, spacing: tuple[float, float], load: float, tolerance: float
) -> np.ndarray:
    """Pressure of the same problem, not periodic, from tamaas."""
    import tamaas

    tamaas.set_log_level(tamaas.LogLevel.error)
    size = [step * count for step, count in zip(spacing, gap.shape, strict=True)]
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, size, list(gap.shape))
    model.E, model.nu = STEEL, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "free")
    solver = tamaas.PolonskyKeerRey(model, -gap, tolerance)
    solver.setIntegralOperator("free")
    solver.solve(load / (size[0] * size[1]))
    return np.array(model.traction)


def compare_speed() -> None:
    """An elliptical contact: processor time of both, alternating."""
    hertz = hertz_ellipse(5e3, radius=0.05, radius_across=0.01, contact_modulus=STEEL)
    sizes = 2.3 * hertz.a, 2.3 * hertz.b
    x, z = middles(512, sizes[0]), middles(256, sizes[1])
    gap = x[:, None] ** 2 / 0.1 + z**2 / 0.02
    spacing = (sizes[0] / 512, sizes[1] / 256)

    def ours() -> np.ndarray:
        found = solve_contact(gap, spacing=spacing, contact_modulus=STEEL, load=5e3)
        return found.pressure.to_numpy()

    def theirs() -> np.ndarray:
        return solve_by_tamaas(gap, spacing, 5e3, 1e-9)

    rows: dict[str, list[tuple[float, float, float]]] = {"erlif": [], "tamaas": []}
    for _ in range(3):
        for label, run in (("erlif", ours), ("tamaas", theirs)):
            wall, processor = time.perf_counter(), time.process_time()
            peak = run().max()
            spent = time.perf_counter() - wall, time.process_time() - processor
            rows[label].append((*spent, peak / hertz.pressure - 1))
    for label, found in rows.items():
        wall, processor, error = np.min(np.abs(found), axis=0)
        print(f"{label:7} {processor:.2f} s processor, {wall:.2f} s wall, p0 off by {error:.1e}")
    ratio = min(row[1] for row in rows["erlif"]) / min(row[1] for row in rows["tamaas"])
    print(f"erlif takes {ratio:.2f} of the processor time of tamaas")


def compute_errors() -> None:
    """Deviations from Hertz's contacts, and the exponents of the pressure at sharp edges."""
    hertz = hertz_ellipse(50.0, radius=0.01, radius_across=0.004, contact_modulus=STEEL)
    sizes = 2.3 * np.array([hertz.a, hertz.b])
    x, z = middles(128, sizes[0]), middles(96, sizes[1])
    gap = x[:, None] ** 2 / 0.02 + z**2 / 0.008
    point = solve_contact(gap, spacing=sizes / (128, 96), contact_modulus=STEEL, load=50.0)
    print(
        f"point, 128 x 96 cells: pressure {float(point.peak_pressure) / hertz.pressure - 1:+.1e}, "
    )
    print(f"    approach {float(point.approach) / hertz.approach - 1:+.1e}")
    line = hertz_line(1e5, radius=0.01, contact_modulus=STEEL)
    x = middles(256, 2.3 * line.half_width)
    plane = solve_contact(x**2 / 0.02, spacing=x[1] - x[0], contact_modulus=STEEL, load=1e5)
    print(f"line, 256 cells: pressure {float(plane.peak_pressure) / line.pressure - 1:+.1e}")

    # a rigid punch on a flat; a ring pressed evenly on a longer pin, both sharp at a right angle
    x = middles(1000, 2.0)
    punch = solve_contact(np.zeros(1000), spacing=0.002, contact_modulus=1e9, load=1e6)
    near = (1 - x > 0.02) & (1 - x < 0.2)
    shape = np.log(punch.pressure[near] * np.sqrt(1 + x[near]))
    print(f"rigid punch: exponent {np.polyfit(np.log(1 - x[near]), shape, 1)[0]:+.4f}, exact -0.5")
    steps = 1e-5 * 1.6 ** np.arange(24)
    cells = 1 - np.concatenate([[0], np.cumsum(steps[np.cumsum(steps) < 0.9]), [1.0]])[::-1]
    below = np.concatenate([[0], np.cumsum(2e-6 * 2.0 ** np.arange(20))])
    beyond = np.unique(np.concatenate([cells, 2 - cells]))
    pin = Section(1 - below[below < 0.9][::-1], beyond, 1.0, 1e9, 0.3, False)
    ring = Section(1 + below[below < 1.5], cells, 1.0, 1e9, 0.3, True)
    matrix = sum(compute_compliance(body, cells, harmonics=[0]).matrices[0] for body in (pin, ring))
    pressure = np.linalg.solve(matrix, np.ones(cells.size - 1))
    distance = 1 - (cells[1:] + cells[:-1]) / 2
    near = (distance > 3e-5) & (distance < 1e-3)
    slope = np.polyfit(np.log(distance[near]), np.log(pressure[near]), 1)[0]
    print(f"ring on a pin: exponent {slope:+.4f}, wedge {-edge_exponent(np.pi / 2):+.4f}")


def compute_many() -> None:
    """A hundred thousand elliptical contacts, and as many of Winkler's."""
    rng, count = np.random.default_rng(1), 10**5
    load, radius = 10 ** rng.uniform(2, 5, count), 10 ** rng.uniform(-1, 1, count)
    across = radius * 10 ** rng.uniform(-3, 0, count)
    shafts = 0.0102 - 10 ** rng.uniform(-4, -3.3, count)
    case = {"bushing_radius": 0.0102, "thickness": 3e-3, "modulus": 1e9}
    runs = {
        "hertz_ellipse": lambda: hertz_ellipse(
            load, radius=radius, radius_across=across, contact_modulus=STEEL
        ),
        "winkler_contact": lambda: winkler_contact(load, shaft_radius=shafts, **case),
    }
    for label, run in runs.items():
        times = []
        for _ in range(4):  # the first one loads the solvers
            started = time.process_time()
            run()
            times.append(time.process_time() - started)
        print(f"{label}: {min(times):.2f} s of processor time, {times[0]:.2f} s at first")


def compare_roller() -> None:
    """Axial pressure of a roller of 20 mm by 20 mm under 20 kN, straight and crowned."""
    hertz = hertz_line(1e6, radius=0.01, contact_modulus=STEEL)
    x, z = middles(64, 2.6 * hertz.half_width), middles(512, 0.02)
    spacing = (x[1] - x[0], z[1] - z[0])
    crown = lundberg_profile(z, load=2e4, length=0.02, contact_modulus=STEEL)
    print("pressure over Hertz at the distance from the end [mm]")
    chosen = [0, 1, 3, 7, 15, 31, 63, 255]
    print(" " * 18 + "".join(f"{(0.01 - abs(z[k])) * 1e3:8.2f}" for k in chosen))
    for label, drop in (("straight", 0 * crown), ("Lundberg", crown)):
        gap = x[:, None] ** 2 / 0.02 + drop
        ours = solve_contact(
            gap, spacing=spacing, contact_modulus=STEEL, load=2e4, tolerance=1e-7
        ).pressure.to_numpy()
        theirs = solve_by_tamaas(gap, spacing, 2e4, 1e-11)
        for code, pressure in (("erlif", ours), ("tamaas", theirs)):
            axial = pressure.max(axis=0) / hertz.pressure
            print(f"{label} {code:8} " + "".join(f"{axial[k]:8.4f}" for k in chosen))
        print(f"largest difference {np.abs(ours - theirs).max() / ours.max():.1e} of the maximum")


def show(label: str, found: object) -> None:
    """One line of a joint's pressure."""
    cell, mean = (float(found[f"{name}_pressure"]) / 1e6 for name in ("peak", "patch"))
    print(
        f"{label:56} cell {cell:6.0f} MPa at {float(found.peak_z) * 1e3:5.1f} mm, "
        f"4 mm mean {mean:5.0f} MPa"
    )


def compute_thesis() -> None:
    """What the thesis gives, for each reading of what it leaves open."""
    half, end = THESIS.length / 2, THESIS.pin_length / 2
    spans = {"load on the ends of the pin": (half, end), "on the whole pin": (0.0, end)}
    for place, span in spans.items():
        straight = prepare_joint(THESIS, smallest_cell=0.1e-3, load_span=span)
        bodies = {"straight": straight}
        for label, cut in (("undercut 20, 8, 9.3", OPTIMUM), ("undercut 10, 5.1, 7.87", TESTED)):
            bodies[label] = prepare_joint(
                replace(THESIS, undercut=cut),
                smallest_cell=0.1e-3,
                load_span=span,
                pin=straight.pin,
            )
        for pounds in (10e3, 100e3, 400e3):
            for label, body in bodies.items():
                found = solve_joint(body, load=pounds * POUND)
                show(f"{label}, {pounds / 1e3:.0f},000 lbf {place}", found)


LOADS = {
    "10,000 lbf in total": 10e3,
    "10,000 lbf on each half": 20e3,
    "10,000 lbf on the quarter": 40e3,
}
"""Loads on the whole pin [lbf] that "a normal load of 10,000 lbf" can mean in a quarter model."""

LOBES = {
    "low": [(0.03359, 27.5e-6), (0.03359, 37.5e-6)],
    "high": [(0.0338275, 237.5e-6), (0.03394, 350e-6)],
    "high, crest 33.70 mm": [(0.03394, 237.5e-6)],
}
"""Bores and heights of lobes [m] that the clearances of the thesis allow."""


def compute_lobes() -> None:
    """Lobes of 200 mm radius: each reading of the load, the place of the lobes and their height."""
    end = THESIS.pin_length / 2
    spans = {"ends": None, "whole pin": (0.0, end), "bushing": (0.0, THESIS.length / 2)}
    rows: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for span in spans.values():
        for centre in (0.03, 0.06, 0.09):
            even = prepare_joint(THESIS, smallest_cell=0.3e-3, refine=[centre], load_span=span)
            for kind, shapes in LOBES.items():
                for (bore, height), (label, pounds) in product(shapes, LOADS.items()):
                    # the bore changes the gap alone; 0.35 mm do not change the compliance
                    joint = replace(even, joint=replace(even.joint, bushing_radius=bore))
                    found = solve_joint(
                        joint, load=pounds * POUND, lobes=[centre], lobe_height=height
                    )
                    pair = float(found.peak_pressure) / 1e6, float(found.patch_pressure) / 1e6
                    rows.setdefault((label, kind), []).append(pair)
    for (label, kind), values in rows.items():
        bore, height = LOBES[kind][0]
        radius = conformal_radius(THESIS.pin_radius, bushing_radius=bore - height)
        hertz = hertz_ellipse(
            LOADS[label] / 2 * POUND, radius=radius, radius_across=0.2, contact_modulus=STEEL
        )
        low, high = np.min(values, axis=0), np.max(values, axis=0)
        print(
            f"{label:26} {kind:21} Hertz {hertz.pressure / 1e6:4.0f} MPa, half axes "
            f"{hertz.a * 1e3:4.1f} and {hertz.b * 1e3:.2f} mm; computed {low[0]:4.0f} to "
            f"{high[0]:4.0f}, mean over 4 mm {low[1]:4.0f} to {high[1]:4.0f} MPa"
        )


def compute_trends(load: float) -> None:
    """One length of the undercut at a time, about the optimum of the thesis."""
    series = {
        "depth D1": ("depths", [2, 5, 10, 15, 20, 25, 30, 40]),
        "width D2": ("widths", [1, 2, 4, 6, 8, 9, 10]),
        "lip D3": ("lips", [2, 3, 4, 5, 6, 7, 8, 9.3, 10, 11]),
    }
    base = {"depths": [20], "widths": [8], "lips": [9.3]}
    for label, (name, values) in series.items():
        chosen = {**base, name: values}
        lengths = {key: [value * 1e-3 for value in given] for key, given in chosen.items()}
        found = search_undercut(THESIS, load=load, patch=0.5e-3, **lengths)
        print(f"{label} [mm]      " + "".join(f"{value:7g}" for value in values))
        for variable in ("patch_pressure", "peak_pressure"):
            line = found[variable].to_numpy().ravel() / 1e6
            print(f"{variable} [MPa]" + "".join(f"{value:7.0f}" for value in line))
    print(f"uncut: 0.5 mm mean {float(found.patch_uncut) / 1e6:.0f} MPa")


ROUGH = {"smallest_cell": 0.5e-3, "harmonics": [0, 1, 2, 3, 4, 6, 8, 16, 32, 64, 128, 256]}
"""Twelve harmonics in place of 22: a third of the time, pressures 0.5 % apart."""


def search(load: float) -> None:
    """The best undercut: all combinations with few harmonics, then all beside the best in full."""
    started = time.process_time()
    axes = {
        "depths": [5, 10, 15, 20, 25, 30, 35, 40],
        "widths": [4, 6, 8, 10],
        "lips": [3, 4, 5, 6, 7, 8, 9, 10, 11, 12],
    }

    def compute(values: dict[str, list[float]], **options: object) -> xr.Dataset:
        lengths = {name: [each * 1e-3 for each in given] for name, given in values.items()}
        found = search_undercut(THESIS, load=load, patch=0.5e-3, **lengths, **options)
        count = np.isfinite(found.patch_pressure).sum().item()
        best = [float(found[f"best_{name}"]) * 1e3 for name in ("depth", "width", "lip")]
        lowest, uncut = float(found.patch_pressure.min()) / 1e6, float(found.patch_uncut) / 1e6
        print(
            f"{count} undercuts, {time.process_time() - started:.0f} s of processor time: best D1 "
            f"{best[0]:g}, D2 {best[1]:g}, D3 {best[2]:g} mm, mean over 0.5 mm "
            f"{lowest:.1f} of {uncut:.0f} MPa",
            flush=True,
        )
        return found

    found = compute(axes, **ROUGH)
    for name in ("width", "depth"):  # the best of each, and how flat the optimum is
        for value in found[name].values:
            one = found.patch_pressure.sel({name: value})
            place = one.where(one == one.min(), drop=True)
            at = {key: f"{float(place[key].max()) * 1e3:g}" for key in ("depth", "width", "lip")}
            print(
                f"    D1 {at['depth']}, D2 {at['width']}, D3 {at['lip']} mm: "
                f"{float(one.min()) / 1e6:.1f} MPa, best of this {name}"
            )
    depth, lip = (float(found[f"best_{name}"]) * 1e3 for name in ("depth", "lip"))
    fine = {
        "depths": [depth - 2.5, depth, depth + 2.5],
        "widths": [8, float(found.best_width) * 1e3],
        "lips": [lip - 0.5, lip, lip + 0.5],
    }
    fine = {name: sorted(set(values)) for name, values in fine.items()}
    compute(fine)
    compute({"depths": [20], "widths": [8], "lips": [9.3]})


def compute_stress(load: float) -> None:
    """Equivalent stress in the plane of the load, in the wall and at the groove."""
    for label, cut in (("straight", None), ("undercut 20, 8, 9.3", OPTIMUM)):
        body = prepare_joint(replace(THESIS, undercut=cut))
        stress = section_stress(body, solve_joint(body, load=load), harmonics=200)
        away = stress.von_mises[stress.r > THESIS.bushing_radius + 4e-3]
        place = int(away.data.argmax())
        print(
            f"{label:20} largest {float(stress.peak_von_mises) / 1e6:5.0f} MPa at r "
            f"{float(stress.peak_r) * 1e3:.2f}, z {float(stress.peak_z) * 1e3:.1f} mm; beyond "
            f"4 mm of the bore {float(away[place]) / 1e6:5.0f} MPa at "
            f"r {float(away.r[place]) * 1e3:.1f}, z {float(away.z[place]) * 1e3:.1f} mm"
        )


def refine(load: float) -> None:
    """Cells at the end of the bushing from 2 mm to 0.05 mm, and twice as many round the axis."""
    for cut in (None, OPTIMUM):
        for cell in (2e-3, 1e-3, 0.5e-3, 0.2e-3, 0.1e-3, 0.05e-3):
            started = time.process_time()
            body = prepare_joint(replace(THESIS, undercut=cut), smallest_cell=cell)
            prepared = time.process_time() - started
            found = solve_joint(body, load=load)
            fine = solve_joint(body, load=load, around=1024)
            kind = "straight" if cut is None else "undercut"
            show(f"{kind}, cell {cell * 1e3:g} mm, {prepared:.1f} s", found)
            change = float(fine.patch_pressure / found.patch_pressure) - 1
            print(f"    1024 round the axis instead of 512: {change:+.1e}")


def draw(load: float) -> None:
    """Profiles, map, search and stress of the joint in one figure."""
    from erlif.joint.plots import edges
    from erlif.show.plots import style

    straight = prepare_joint(THESIS)
    cut = prepare_joint(replace(THESIS, undercut=OPTIMUM), pin=straight.pin)
    before, after = solve_joint(straight, load=load), solve_joint(cut, load=load)
    found = search_undercut(
        THESIS,
        load=load,
        depths=[0.010, 0.015, 0.020, 0.030],
        widths=[0.008],
        lips=[0.005, 0.006, 0.007, 0.008, 0.0093, 0.0105],
        patch=0.5e-3,
    )
    radius = conformal_radius(THESIS.pin_radius, bushing_radius=THESIS.bushing_radius)
    hertz = hertz_line(load / THESIS.length, radius=radius, contact_modulus=STEEL)
    figure = style.new_figure(style.TWO_COLUMNS, 0.62 * style.TWO_COLUMNS)
    panels = figure.subplots(2, 2).ravel()
    contacts = {"straight": before, "undercut": after}
    edges.axial_pressure(contacts, hertz=hertz.pressure, ax=panels[0])
    edges.contact_pressure_map(after, ax=panels[1])
    edges.undercut_pressure(found, ax=panels[2])
    edges.stress_section(section_stress(cut, after, harmonics=128), ax=panels[3])
    style.letter_panels(*panels)
    style.save_figure(figure, Path(__file__).parents[1] / "docs" / "images" / "edges.png", dpi=150)


def main() -> None:
    """Run the chosen part."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "part",
        choices=[
            "speed",
            "many",
            "errors",
            "roller",
            "thesis",
            "lobes",
            "trends",
            "search",
            "stress",
            "mesh",
            "figure",
        ],
    )
    parser.add_argument("--pounds", type=float, default=100e3, help="load on the pin [lbf]")
    given = parser.parse_args()
    load = given.pounds * POUND
    {
        "speed": compare_speed,
        "many": compute_many,
        "errors": compute_errors,
        "roller": compare_roller,
        "thesis": compute_thesis,
        "lobes": compute_lobes,
        "trends": lambda: compute_trends(load),
        "search": lambda: search(load),
        "stress": lambda: compute_stress(load),
        "mesh": lambda: refine(load),
        "figure": lambda: draw(load),
    }[given.part]()


if __name__ == "__main__":
    main()
