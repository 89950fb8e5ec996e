"""Radial compliance of pins and bushings of finite length, by harmonics round the axis.

A body of revolution under a load of any shape: displacements and loads are Fourier series in the
angle, each harmonic a problem in the section (r, z) alone (Zienkiewicz and Taylor, 2000, chapter
on semi-analytical elements). The finite elements are those of scikit-fem. Ends are free faces, so
that edges, necks and undercuts are as compliant as they are.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.core.errors import ModelError

if TYPE_CHECKING:
    import skfem

# Harmonics that are computed; the others lie between them on a smooth curve.
HARMONICS = (0, 1, 2, 3, 4, 5, 6, 8, 11, 16, 22, 32, 45, 64, 90, 128, 181, 256, 362, 512, 724, 1024)


@dataclass(frozen=True)
class Section:
    """Section of a body of revolution, meshed by rectangles.

    Attributes
    ----------
    radii : array
        Radii of the grid lines, rising. [m]
    places : array
        Axial places of the grid lines, rising. [m]
    surface : float
        Radius of the surface in contact, the first or the last line. [m]
    youngs_modulus : float
        Young's modulus of the body. [Pa]
    poisson : float
        Its Poisson's ratio. [1]
    clamped : bool
        Whether the surface opposite to that in contact is held.
    symmetric : bool
        Whether the first axial line is a plane of symmetry; otherwise it is free.
    held_ends : bool
        Whether both ends are held along the axis: plane strain.
    cut : tuple of float, optional
        Inner radius, outer radius, first and last place of a rectangle that is removed. [m]
    """

    radii: Array
    places: Array
    surface: float
    youngs_modulus: float
    poisson: float
    clamped: bool
    symmetric: bool = True
    held_ends: bool = False
    cut: tuple[float, float, float, float] | None = None


@dataclass(frozen=True)
class Compliance:
    """Radial displacement of a surface under radial pressure, both constant in axial cells.

    Attributes
    ----------
    harmonics : array, (harmonic,)
        Harmonics round the axis, rising from 0 and 1.
    matrices : array, (harmonic, cell, cell)
        Displacement in the direction of the pressure, averaged over a cell, per pressure on
        another. [m/Pa]
    loaded : array, (cell, load)
        The same displacement under transverse loads, of the first harmonic, per newton. [m/N]
    """

    harmonics: Array
    matrices: Array
    loaded: Array

    def between(self, count: int) -> Array:
        """Matrices of the harmonics 0 to count - 1.

        n C is constant for a half space. Between those computed it is a line over the logarithm of
        n, which keeps every matrix positive, and it is constant beyond the last. The first
        harmonic, which bends and moves the body, is always one of those computed.
        """
        orders = np.maximum(self.harmonics, 1)
        scaled = self.matrices * orders[:, None, None]
        wanted = np.arange(2, count)
        place = np.interp(np.log(wanted), np.log(orders[1:]), np.arange(1, orders.size))
        lower = np.minimum(place.astype(int), orders.size - 2)
        share = (place - lower)[:, None, None]
        upper = (1 - share) * scaled[lower] + share * scaled[lower + 1]
        return np.concatenate([self.matrices[:2], upper / wanted[:, None, None]])[:count]


def compute_compliance(
    section: Section,
    cells: Array,
    *,
    harmonics: Sequence[int] = HARMONICS,
    load_spans: Sequence[tuple[float, float]] = (),
) -> Compliance:
    """Compute the compliance of the surface of a section.

    Parameters
    ----------
    section : Section
        Body and mesh. The ends of the cells must be axial lines of its mesh.
    cells : array, (cell + 1,)
        Ends of the axial cells of the pressure. [m]
    harmonics : sequence of int
        Harmonics round the axis that are computed.
    load_spans : sequence of tuple of float
        Axial extents over which transverse loads act on the surface. [m]

    Returns
    -------
    Compliance
        One matrix for each harmonic.

    Raises
    ------
    ModelError
        scikit-fem is not installed, or the cells do not fit the mesh.

    Examples
    --------
    A disc of unit radius under even pressure, plane strain: u = p R (1 - nu - 2 nu^2) / E.

    >>> import numpy as np
    >>> disc = Section(np.linspace(0, 1, 5), np.array([0.0, 1.0]), 1.0, 1e9, 0.3, False,
    ...                held_ends=True)
    >>> found = compute_compliance(disc, disc.places, harmonics=[0])
    >>> print(f"{found.matrices[0, 0, 0] * 1e9:.3f}")
    0.520
    """
    solver = HarmonicSolver.of(section)
    pressures = solver.pressure_vectors(cells)
    lengths = np.diff(cells)
    matrices, loaded = [], np.zeros((lengths.size, len(load_spans)))
    for n in harmonics:
        loads = [solver.transverse_vector(span)[:, None] for span in load_spans if n == 1]
        columns = np.hstack([pressures, *loads])
        found = solver.solve(n, columns)
        average = pressures.T @ found / (lengths[:, None] * section.surface)
        matrices.append(average[:, : lengths.size])
        if n == 1:
            loaded = average[:, lengths.size :] / (2 * np.pi)
    return Compliance(np.asarray(harmonics, float), np.array(matrices), loaded)


def _elasticity(section: Section) -> Array:
    """Stresses of the strains rr, tt, zz, rz, rt, zt."""
    nu = section.poisson
    scale = section.youngs_modulus / ((1 + nu) * (1 - 2 * nu))
    matrix = np.diag(scale * np.array([1 - 2 * nu] * 3 + [0.5 - nu] * 3))
    matrix[:3, :3] += nu * scale
    return matrix


def _stiffness(basis: Any, elasticity: Array) -> tuple[Any, Any, Any]:
    """K0, K1 and K2 of the stiffness K0 + n K1 + n^2 K2, from the strains of each element."""
    from scipy.sparse import coo_matrix

    # strains of the local functions at the points of integration, without and with the factor n
    r = np.asarray(basis.global_coordinates()[0])
    count = len(basis.basis)
    strain = np.zeros((2, *r.shape, 6, count))
    for k in range(count):
        field = basis.basis[k][0]
        (radial, axial, around) = np.broadcast_to(np.asarray(field), (3, *r.shape))
        slope = np.broadcast_to(field.grad, (3, 2, *r.shape))
        strain[0, :, :, 0, k] = slope[0, 0]
        strain[0, :, :, 1, k] = radial / r
        strain[0, :, :, 2, k] = slope[1, 1]
        strain[0, :, :, 3, k] = slope[0, 1] + slope[1, 0]
        strain[0, :, :, 4, k] = slope[2, 0] - around / r
        strain[0, :, :, 5, k] = slope[2, 1]
        strain[1, :, :, 1, k] = around / r
        strain[1, :, :, 4, k] = -radial / r
        strain[1, :, :, 5, k] = -axial / r
    stress = elasticity @ strain * (r * basis.dx)[..., None, None]

    # one matrix for each power of n
    def product(i: int, j: int) -> Array:
        energy: Array = (np.swapaxes(strain[i], -1, -2) @ stress[j]).sum(axis=1)
        return energy

    rows = np.repeat(basis.element_dofs.T[:, :, None], count, axis=2)
    columns = np.swapaxes(rows, 1, 2)
    parts = (product(0, 0), product(0, 1) + product(1, 0), product(1, 1))
    return tuple(  # type: ignore[return-value]  # three of them
        coo_matrix(
            (part.ravel(), (rows.ravel(), columns.ravel())), shape=(basis.N, basis.N)
        ).tocsc()
        for part in parts
    )


@dataclass(frozen=True)
class HarmonicSolver:
    """Stiffness of a section as a polynomial in the harmonic, K0 + n K1 + n^2 K2.

    Attributes
    ----------
    section : Section
        Body and mesh.
    basis : object
        Biquadratic elements of scikit-fem with three components: radial, axial, round.
    parts : tuple
        The three sparse matrices.
    """

    section: Section
    basis: "skfem.Basis"
    parts: tuple[Any, Any, Any]

    @classmethod
    def of(cls, section: Section) -> "HarmonicSolver":
        """Assemble the parts."""
        try:
            import skfem
        except ModuleNotFoundError as error:
            raise ModelError(
                "Joints of finite length need finite elements, and scikit-fem is not installed. "
                'Install it with: pip install "erlif[edges]"'
            ) from error
        mesh = skfem.MeshQuad.init_tensor(section.radii, section.places)
        if section.cut is not None:
            r, z = mesh.p[:, mesh.t].mean(axis=1)
            inner, outer, first, last = section.cut
            removed = (r > inner) & (r < outer) & (z > first) & (z < last)
            mesh = mesh.remove_elements(np.flatnonzero(removed))
        element = skfem.ElementVector(skfem.ElementQuad2(), dim=3)
        basis = skfem.Basis(mesh, element, intorder=4)
        return cls(section, basis, _stiffness(basis, _elasticity(section)))

    def solve(self, harmonic: int, loads: Array) -> Array:
        """Displacements under loads of one harmonic, per radian of the integral round the axis."""
        from scipy.sparse.linalg import splu

        matrix = self.parts[0] + harmonic * self.parts[1] + harmonic**2 * self.parts[2]
        kept = np.flatnonzero(~self._held(harmonic))
        factor = splu(
            matrix[kept][:, kept].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        moved = np.zeros((self.basis.N, loads.shape[1]))
        moved[kept] = factor.solve(np.ascontiguousarray(loads[kept]))
        return moved

    @property
    def points(self) -> Array:
        """Radius and axial place of the middles of the elements. (2, element)"""
        return np.asarray(self.basis.mesh.p[:, self.basis.mesh.t].mean(axis=1))

    @property
    def sizes(self) -> Array:
        """Extents of the elements along radius and axis. (2, element)"""
        return np.asarray(np.ptp(self.basis.mesh.p[:, self.basis.mesh.t], axis=1))

    def stress(self, harmonic: int, displacement: Array) -> Array:
        """Amplitudes of the stresses rr, tt, zz, rz, which vary as a cosine. (4, element)

        Means over the elements. The shear stresses rt and zt vary as a sine and are zero in the
        plane of the load.
        """
        field = self.basis.interpolate(displacement)
        r = np.asarray(self.basis.global_coordinates()[0])
        (radial, _, around), gradient = np.asarray(field), field.grad
        strain = np.array(
            [
                gradient[0, 0],
                (radial + harmonic * around) / r,
                gradient[1, 1],
                gradient[0, 1] + gradient[1, 0],
            ]
        )
        weights = self.basis.dx / self.basis.dx.sum(axis=1, keepdims=True)
        rr, tt, zz, rz = (strain * weights).sum(axis=-1)
        normal = _elasticity(self.section)[:4, :4] @ np.array([rr, tt, zz, rz])
        return np.asarray(normal)

    def pressure_vectors(self, cells: Array) -> Array:
        """Loads of unit pressure on each cell of the surface, into the body. (unknown, cell)"""
        inward = 1.0 if self.section.surface == self.section.radii[0] else -1.0
        return np.stack(
            [self._surface_vector(span, inward, 0.0) for span in pairwise(cells)], axis=1
        )

    def transverse_vector(self, span: tuple[float, float]) -> Array:
        """Load of the first harmonic, even over a part of the surface; 2 pi of it are a newton."""
        density = 1 / ((span[1] - span[0]) * self.section.surface)
        return self._surface_vector(span, density, -density)

    def _surface_vector(self, span: tuple[float, float], radial: float, around: float) -> Array:
        """Load of tractions on a part of the surface: Simpson's rule, exact for these elements."""
        section, lines = self.section, self.section.places
        tolerance = 1e-9 * section.surface
        if not all(np.abs(lines - end).min() < tolerance for end in span):
            raise ModelError(
                f"The cell from {span[0]:g} to {span[1]:g} m does not end at lines of the mesh."
            )
        component, (r, z) = self._components, self.basis.doflocs
        loads = np.zeros(self.basis.N)
        for number, traction in ((0, radial), (2, around)):
            nodes = np.flatnonzero(
                (np.abs(r - section.surface) < tolerance) & (component == number)
            )
            nodes = nodes[np.argsort(z[nodes])]  # ends and middles of the elements in turn
            for k in range(lines.size - 1):
                if span[0] - tolerance < lines[k] and lines[k + 1] < span[1] + tolerance:
                    share = np.array([1, 4, 1]) / 6 * (lines[k + 1] - lines[k])
                    loads[nodes[2 * k : 2 * k + 3]] += traction * section.surface * share
        return loads

    @cached_property
    def _components(self) -> Array:
        """Number of the component, radial, axial or round, of each unknown."""
        component = np.empty(self.basis.N)
        for number, name in enumerate(("u^1", "u^2", "u^3")):
            component[self.basis.get_dofs(elements=True).all([name])] = number
        return component

    def _held(self, harmonic: int) -> Mask:
        """Mask of fixed unknowns: symmetry planes, clamps, the axis, rigid motions."""
        section, basis = self.section, self.basis
        r, z = basis.doflocs
        tolerance = 1e-9 * section.surface
        component = self._components
        held = np.zeros(basis.N, dtype=bool)

        def line(values: Array, place: float) -> Mask:
            return np.abs(values - place) < tolerance

        ends = [section.places[0]] if section.symmetric or section.held_ends else []
        ends += [section.places[-1]] if section.held_ends else []
        for end in ends:
            held |= line(z, end) & (component == 1)
        if section.clamped:
            outer = section.surface == section.radii[0]
            held |= line(r, section.radii[-1] if outer else section.radii[0])
        if section.radii[0] == 0:
            # on the axis nothing but the translation of the first and the stretch of none remains
            kept = {0: (1,), 1: (0, 2)}.get(harmonic, ())
            held |= line(r, 0.0) & ~np.isin(component, kept)
        if section.clamped:
            return held

        # a free body is fixed; the reactions vanish in equilibrium
        inner = line(r, section.radii[0])
        first, last = line(z, section.places[0]), line(z, section.places[-1])
        supported = section.symmetric or section.held_ends
        if harmonic == 1:
            held |= inner & first & (component != 1)
            if not supported:
                held |= inner & last & (component != 1)
        if harmonic == 0:
            held |= component == 2  # torsion is not loaded
            if not supported:
                held |= inner & first & (component == 1)
        return held
