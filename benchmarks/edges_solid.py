"""The finite elements of Farzaneh (2002), chapter 3, beside `erlif.joint.models.edges`.

python benchmarks/edges_solid.py straight    straight and undercut bushing
python benchmarks/edges_solid.py lobes       lobes under each reading of the load
python benchmarks/edges_solid.py search      the undercuts of a test, all computed

A quarter of the joint in linear tetrahedra, 4 mm long where it touches and 10 mm elsewhere, about
25,000 of them. The outside of the bushing is held; the middle and the plane of the load are planes
of symmetry. Nodes of pin and bushing face one another, and none overlaps; the pressure of a node is
its force over its area. No code of `erlif.joint.models.edges` is used.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    ElementHex1,
    ElementTetP1,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshHex,
    MeshTet,
)
from skfem.models.elasticity import lame_parameters, linear_elasticity

POUND = 4.4482216
PIN, BORE, OUTSIDE = 0.03336, 0.03359, 0.0533
THESIS = (0.2373 / 2, 0.3508 / 2)  # half lengths of bushing and pin
HOLE = 0.004  # bricks do not close at the axis; the hole takes 0.02 % of the bending stiffness
YOUNG, POISSON = 200e9, 0.3
TOUCHING = np.radians(70)  # no contact beyond this angle

Spans = dict[str, tuple[float, float]]


def lines(*parts: tuple[float, float, float]) -> np.ndarray:
    """Grid lines: from, to and largest step of each part."""
    pieces = []
    for low, high, step in parts:
        count = max(1, int(np.ceil((high - low) / step - 1e-6)))
        pieces.append(np.linspace(low, high, count + 1))
    return np.unique(np.concatenate(pieces).round(12))


def grid(angles: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Angle and place of all nodes of a surface. (node, 2)"""
    return np.stack(np.meshgrid(angles, places, indexing="ij"), axis=-1).reshape(-1, 2)


def mesh_body(
    radii: np.ndarray,
    angles: np.ndarray,
    places: np.ndarray,
    groove: tuple[float, ...] | None = None,
    *,
    bricks: bool = False,
) -> MeshTet | MeshHex:
    """Bricks, or six tetrahedra in each, bent round the axis, without those of a groove."""
    mesh = MeshHex.init_tensor(radii, angles, places)
    if groove is not None:
        r, _, z = mesh.p[:, mesh.t].mean(axis=1)
        inside = (r > groove[0]) & (r < groove[1]) & (z > groove[2])
        mesh = mesh.remove_elements(np.flatnonzero(inside))
    if not bricks:
        mesh = mesh.to_meshtet()
    r, angle, z = mesh.p
    return type(mesh)(np.array([r * np.cos(angle), r * np.sin(angle), z]), mesh.t)


@dataclass
class Body:
    """Radial displacement of the nodes of a surface."""

    compliance: np.ndarray  # under unit radial forces (node, node) [m/N]
    loaded: np.ndarray  # under unit transverse loads (node, span) [m/N]
    area: np.ndarray  # of the surface, that belongs to each node (node,) [m2]
    elements: int


def condense(
    mesh: MeshTet | MeshHex, surface: float, nodes: np.ndarray, *, held: float | None, spans: Spans
) -> Body:
    """Compliance of the nodes of a surface."""
    element = ElementHex1() if isinstance(mesh, MeshHex) else ElementTetP1()
    basis = Basis(mesh, ElementVector(element))
    stiffness = linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(basis)
    x, y, z = mesh.p
    r, angle = np.hypot(x, y), np.arctan2(y, x)
    dofs = basis.nodal_dofs
    fixed = [dofs[1, np.abs(y) < 1e-9], dofs[2, np.abs(z) < 1e-9]]
    if held is not None:
        fixed.append(dofs[:, np.abs(r - held) < 1e-9].ravel())
    else:  # the pin moves along the load; the reaction of this node vanishes in equilibrium
        far = np.abs(r - HOLE) + np.abs(z) + np.abs(angle - np.pi / 2)
        fixed.append(dofs[0, [int(far.argmin())]])
    kept = np.setdiff1d(np.arange(basis.N), np.concatenate(fixed))

    # integrals of the functions of the nodes over the surface
    facets = mesh.boundary_facets()
    facets = facets[(np.abs(r[mesh.facets[:, facets]] - surface) < 1e-9).all(axis=0)]
    area = LinearForm(lambda v, w: v + 0 * w.x[0]).assemble(
        FacetBasis(mesh, element, facets=facets)
    )
    # a unit force on each node of the surface, and a unit load on each span
    on = np.flatnonzero(np.abs(r - surface) < 1e-9)
    order = [on[np.hypot(angle[on] - a, z[on] - place).argmin()] for a, place in nodes]
    inward = -1.0 if held is None else 1.0
    columns = np.zeros((basis.N, len(nodes) + len(spans)))
    columns[dofs[0, order], np.arange(len(nodes))] = inward * np.cos(nodes[:, 0])
    columns[dofs[1, order], np.arange(len(nodes))] = inward * np.sin(nodes[:, 0])
    for k, (low, high) in enumerate(spans.values()):
        share = area[on] * ((z[on] > low - 1e-9) & (z[on] < high + 1e-9))
        columns[dofs[0, on], len(nodes) + k] = share / share.sum()

    factor = splu(
        stiffness[kept][:, kept].tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    moved = columns[kept, : len(nodes)].T @ factor.solve(columns[kept])
    return Body(moved[:, : len(nodes)], moved[:, len(nodes) :], area[order], mesh.t.shape[1])


@dataclass
class Solid:
    """A quarter of a joint, for any load and any lobes."""

    nodes: np.ndarray
    pin: Body
    bushing: Body
    spans: list[str]

    def solve(
        self,
        pounds: float,
        span: str,
        *,
        bore: float = BORE,
        lobe: float | None = None,
        height: float = 0.0,
    ) -> np.ndarray:
        """Pressure of the nodes [Pa] under a load on the whole pin [lbf]; a lobe has 200 mm."""
        quarter = pounds * POUND / 4
        angle, z = self.nodes.T
        gap = np.full(angle.size, bore - PIN)
        if lobe is not None:
            gap -= np.maximum(height - (z - lobe) ** 2 / 0.4, 0)
        rest = gap + self.pin.loaded[:, self.spans.index(span)] * quarter
        matrix, cosine = self.pin.compliance + self.bushing.compliance, np.cos(angle)
        active = angle < 0.2
        for _ in range(100):
            k = np.flatnonzero(active)
            border = cosine[k, None]
            system = np.block([[matrix[np.ix_(k, k)], -border], [border.T, np.zeros((1, 1))]])
            found = np.linalg.solve(system, np.append(-rest[k], quarter))
            force = np.zeros(angle.size)
            force[k] = found[:-1]
            remaining = rest + matrix @ force - cosine * found[-1]
            closed = np.where(active, force > 0, remaining < 0)
            if np.array_equal(closed, active):
                pressure: np.ndarray = force / self.bushing.area
                return pressure
            active = closed
        raise RuntimeError("The contact has not settled.")


def prepare_solid(
    half: float,
    end: float,
    *,
    cut: tuple[float, float, float] | None = None,
    step: float = 4e-3,
    axial: float = 4e-3,
    bricks: bool = False,
) -> Solid:
    """Mesh and condense pin and bushing; a cut is D1, D2 and D3. [m]"""
    coarse = 2.5 * step
    places = np.append(0.0, half - np.arange(0, half - axial / 3, axial)[::-1]).round(12)
    angles = lines((0, TOUCHING, step / PIN), (TOUCHING, np.pi, coarse / PIN))
    nodes = grid(angles[angles < TOUCHING + 1e-9], places)
    spans = {"ends": (half, end), "whole pin": (0.0, end), "bushing": (0.0, half)}

    core = lines((HOLE, PIN - step, coarse), (PIN - step, PIN, step))
    wall = lines((BORE, BORE + step, step), (BORE + step, OUTSIDE, coarse))
    along, groove = places, None
    if cut is not None:
        groove = (BORE + cut[2], BORE + cut[2] + cut[1], half - cut[0])
        parts = ((BORE, groove[0]), (groove[0], groove[1]), (groove[1], OUTSIDE))
        wall = lines(*((low, high, step) for low, high in parts))
        if np.abs(places - groove[2]).min() > 1e-9:
            along = np.sort(np.append(places, groove[2]))
    whole = np.union1d(places, lines((half, end, coarse)))
    body = mesh_body(core, angles, whole, bricks=bricks)
    pin = condense(body, PIN, nodes, held=None, spans=spans)
    ring = mesh_body(wall, angles, along, groove, bricks=bricks)
    bushing = condense(ring, BORE, nodes, held=OUTSIDE, spans={})
    return Solid(nodes, pin, bushing, list(spans))


KINDS = {"tetrahedra": False, "bricks": True}


def compute_straight() -> None:
    """Straight and undercut bushing under the loads in question."""
    for kind, bricks in KINDS.items():
        cut = (0.020, 0.008, 0.0093)
        bodies = [prepare_solid(*THESIS, cut=each, bricks=bricks) for each in (None, cut)]
        print(f"{bodies[0].pin.elements + bodies[0].bushing.elements} {kind} without the cut")
        for span in bodies[0].spans:
            for pounds in (10e3, 40e3, 100e3, 150e3, 200e3, 400e3):
                plain, relieved = (body.solve(pounds, span).max() / 1e6 for body in bodies)
                print(
                    f"{pounds / 1e3:.0f},000 lbf, {span:9}: straight {plain:5.0f}, undercut "
                    f"{relieved:5.0f} MPa, {relieved / plain:.3f}"
                )


def compute_lobes() -> None:
    """Lobes with their crest on a line of nodes, and between two; high and low ones."""
    for (kind, bricks), axial in product(KINDS.items(), (4e-3, 2e-3)):
        solid = prepare_solid(*THESIS, axial=axial, bricks=bricks)
        crests = np.unique(solid.nodes[:, 1])
        for pounds in (10e3, 20e3, 40e3):
            for bore, height in ((BORE, 37.5e-6), (BORE + 237.5e-6, 237.5e-6)):
                shown = []
                for aside in (0.0, axial / 2):
                    lobe = float(crests[crests.size // 2]) + aside
                    for span in ("whole pin", "bushing"):
                        found = solid.solve(pounds, span, bore=bore, lobe=lobe, height=height)
                        shown.append(f"{found.max() / 1e6:4.0f}")
                print(
                    f"{kind}, nodes every {axial * 1e3:g} mm, {pounds / 1e3:.0f},000 lbf, lobes of "
                    f"{height * 1e6:5g} um: on a node {' '.join(shown[:2])}, between "
                    f"{' '.join(shown[2:])} MPa (load on the whole pin, within the bushing)"
                )


def compute_search() -> None:
    """Joint of the tests, 60 mm long: largest pressure inside the last two millimetres."""
    half, end, pounds = 0.030, 0.060, 1e5 / POUND
    depths, lips = (0.004, 0.012), (0.003, 0.006, 0.009, 0.012)
    for cut in [None, *product(depths, (0.004,), lips)]:
        solid = prepare_solid(half, end, cut=cut, axial=2e-3, step=3e-3, bricks=True)
        found = solid.solve(pounds, "ends").max() / 1e6
        name = (
            "straight"
            if cut is None
            else "D1 {:g}, D2 {:g}, D3 {:g} mm".format(*np.multiply(cut, 1e3))
        )
        print(f"{name}: {found:.0f} MPa", flush=True)


def main() -> None:
    """Run the chosen part."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parts = {"straight": compute_straight, "lobes": compute_lobes, "search": compute_search}
    parser.add_argument("part", choices=list(parts))
    parts[parser.parse_args().part]()


if __name__ == "__main__":
    main()
