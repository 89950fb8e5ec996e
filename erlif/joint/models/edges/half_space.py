"""Contact of two bodies on elastic half spaces, and the stress below it: rollers, lobes, ends.

Coordinates of the contact: x across (circumferential), z along the axis, both in the surface, and
the depth below it. All cells of a grid are equal, so that one cell at every offset determines the
whole matrix, and a convolution by FFT on a doubled grid multiplies by it without wrap-around.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy.fft

from erlif.core.arrays import AnyArray, Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.joint.models.edges.active_set import solve_active_set
from erlif.models.arguments import Values, formula, require_finite

if TYPE_CHECKING:
    import xarray as xr


@formula(load="number", approach="number", tolerance="number")
def solve_contact(
    gap: Values,
    *,
    spacing: Values,
    contact_modulus: float,
    load: float | None = None,
    approach: float | None = None,
    free_tilt: bool = False,
    load_position: tuple[float, float] = (0.0, 0.0),
    mirror: float = 0.0,
    tolerance: float = 1e-5,
) -> "xr.Dataset":
    """Find the pressure between two bodies of given gap, without friction.

    The pressure is constant in each cell (Love, 1929), its deflection a convolution by FFT on a
    doubled grid, and the contact is found by conjugate gradients with an active set (Polonsky and
    Keer, 1999). Pressure acts within the grid only: the edge of the grid is the end of a body. A
    gap along x alone is a plane contact, infinitely long.

    Parameters
    ----------
    gap : array, (x,) or (x, z)
        Gap of the undeformed bodies at the middle of equal cells. Only its shape counts where the
        load is given. [m]
    spacing : float or tuple of float
        Sides of a cell along x and z. [m]
    contact_modulus : float
        E*, see `erlif.models.contact.contact_modulus`. [Pa]
    load : float, optional
        Load. [N, or N/m for a plane contact]
    approach : float, optional
        Approach of the bodies from the given gap, in place of a load; without pressure where it is
        less than the gap. [m]
    free_tilt : bool
        Whether the bodies turn about x and z until the load is at its position; otherwise they stay
        parallel.
    load_position : tuple of float
        With `free_tilt`: place of the load along x and z, from the middle of the grid. [m]
    mirror : float
        Share of the pressure, mirrored about both ends in z, that deflects the bodies too. 0 stands
        for half spaces, 1 for two free ends at a Poisson's ratio of 0, about 1.5 at 0.3, and half
        of it where one of two equal bodies goes on. [1]
    tolerance : float
        Largest error of the gap, over the deflection of a cell under its own largest pressure. [1]

    Returns
    -------
    xarray.Dataset
        Over x (and z): `pressure` [Pa], `deflection` of both bodies [m], `gap` that remains [m].
        `force` [N or N/m], `approach` [m], `tilt_x`, `tilt_z` [rad], the slopes of the motion along
        x and z, `peak_pressure` [Pa], `area` of the contact [m2 or m], `iterations`, `residual`.
        The deflection of a plane contact, and its approach, are relative to a point as far away as
        the grid is wide.

    Raises
    ------
    ModelError
        Neither or both of load and approach, a gap that is not finite, lengths that are not
        positive, a load outside the bodies.

    Examples
    --------
    A ball of 10 mm under 10 N on a plane, both of steel: Hertz has 616.4 MPa.

    >>> x = (np.arange(96) - 47.5) * 2.2e-6
    >>> gap = (x[:, None] ** 2 + x**2) / (2 * 0.01)
    >>> contact = solve_contact(gap, spacing=2.2e-6, contact_modulus=110e9, load=10)
    >>> print(f"{float(contact.peak_pressure) / 1e6:.0f} MPa")
    616 MPa
    """
    heights, steps = _check_grid(gap, spacing)
    if (load is None) == (approach is None):
        raise ModelError("A contact needs either a load or an approach, not both and not neither.")
    plane = heights.ndim == 1
    if plane and (mirror or free_tilt):
        raise ModelError(
            "A gap along x alone is infinitely long and has neither ends nor tilt; give gap (x, z)."
        )

    # deflection, the rigid motions and what they have to carry
    deflect, diagonal = _deflection(heights.shape, steps, contact_modulus, mirror)
    middles = [
        (np.arange(count) - (count - 1) / 2) * step
        for count, step in zip(heights.shape, steps, strict=True)
    ]
    modes = np.ones((1, *heights.shape))
    if free_tilt:
        modes = np.array([modes[0], *np.meshgrid(*middles, indexing="ij")])
        require_finite(load_position=load_position)
        half = np.array(heights.shape) * steps / 2
        if np.any(np.abs(load_position) >= half):
            raise ModelError(
                f"The load at {tuple(load_position)} m lies outside the grid, which ends at x = "
                f"±{half[0]:g} and z = ±{half[1]:g} m; no contact carries it."
            )
    targets = None if load is None else load * np.array([1.0, *load_position])[: len(modes)]
    motion = None if approach is None else np.array([approach, 0.0, 0.0])[: len(modes)]
    cell = float(np.prod(steps))

    balance = solve_active_set(
        deflect,
        heights,
        diagonal=diagonal,
        modes=modes,
        area=cell,
        targets=targets,
        motion=motion,
        tolerance=tolerance,
    )
    motions = np.pad(balance.motion, (0, 3 - len(modes)))
    dims = ("x", "z")[: heights.ndim]
    words = read_table("erlif.joint.models", "variables.toml")
    return describe_by(
        words["contact"] | words["half_space"] | (words["plane"] if plane else {}),
        {
            "pressure": (dims, balance.pressure),
            "deflection": (dims, balance.deflection),
            "gap": (dims, balance.gap),
            "force": ((), balance.pressure.sum() * cell),
            "approach": ((), motions[0]),
            "tilt_x": ((), motions[1]),
            "tilt_z": ((), motions[2]),
            "peak_pressure": ((), balance.pressure.max()),
            "area": ((), np.count_nonzero(balance.pressure) * cell),
            "iterations": ((), balance.iterations),
            "residual": ((), balance.residual),
        },
        {dim: (dim, middle) for dim, middle in zip(dims, middles, strict=True)},
    )


def _check_grid(gap: Values, spacing: Values) -> tuple[Array, tuple[float, ...]]:
    """The gap as an array of one or two dimensions, and the sides of its cells."""
    heights = np.asarray(gap, float)
    if heights.ndim not in (1, 2) or min(heights.shape, default=0) < 2:
        raise ModelError(
            "A gap has the dimensions (x,) or (x, z) with at least two cells each, got the shape "
            f"{heights.shape}."
        )
    if not np.isfinite(heights).all():
        raise ModelError(
            f"The gap holds {np.count_nonzero(~np.isfinite(heights))} values that are not finite; "
            "cut the grid at the ends of the bodies."
        )
    steps = np.broadcast_to(np.asarray(spacing, float), heights.ndim)
    return heights, tuple(float(step) for step in steps)


def _deflection(
    shape: tuple[int, ...], steps: tuple[float, ...], modulus: float, mirror: float
) -> tuple[Callable[[Array], Array], float]:
    """Deflection of a pressure, and that of a cell under its own unit pressure."""
    if len(shape) == 1:
        plane = Convolution.of(displacement_of_strips(shape[0], steps[0], modulus))
        return plane, plane.diagonal

    # images beside both ends: three lengths of pressure, of which the middle one is deflected
    across, along = shape
    extent = (across, 2 * along if mirror else along)
    cells = Convolution.of(displacement_of_cells(extent, (steps[0], steps[1]), modulus))

    def deflect(pressure: Array) -> Array:
        image = mirror * pressure[:, ::-1]
        window = (slice(0, across), slice(along, 2 * along))
        return cells.multiply(np.hstack([image, pressure, image]), window)

    return deflect if mirror else cells, cells.diagonal


@formula(depth="number")
def subsurface_stress(
    contact: "xr.Dataset", *, depth: Values, poisson: float = 0.3
) -> "xr.Dataset":
    """Compute the stresses in a half space under the pressure of a contact.

    Sums of the closed form of a uniformly loaded rectangle (Love, 1929), by FFT at each depth.
    Below a tenth of a cell they are those of the steps between cells.

    Parameters
    ----------
    contact : xarray.Dataset
        `pressure` (x, z) on equal cells, as `solve_contact` has it. [Pa]
    depth : float or array, (depth,)
        Depths below the surface. [m]
    poisson : float
        Poisson's ratio of the body. [1]

    Returns
    -------
    xarray.Dataset
        Over depth, x and z, tension positive: `von_mises`, the normal stresses `stress_xx`,
        `stress_zz`, `stress_yy` (y along the depth) and the shear stresses `stress_xz`,
        `stress_xy`, `stress_zy` [Pa]. `peak_von_mises` [Pa] is the largest equivalent stress on
        the grid, at `peak_x`, `peak_z`, `peak_depth` [m].

    Raises
    ------
    ModelError
        A plane contact, a depth that is not positive, a Poisson's ratio outside its range.

    Examples
    --------
    Under Hertz's circular contact, equivalent stress is largest at 0.48 of the radius:

    >>> from erlif.joint.models.edges import solve_contact
    >>> x = (np.arange(48) - 23.5) * 0.05
    >>> contact = solve_contact(
    ...     (x[:, None] ** 2 + x**2) / 2, spacing=0.05, contact_modulus=1e9, load=4e9 / 3
    ... )
    >>> stress = subsurface_stress(contact, depth=np.linspace(0.3, 0.7, 41))
    >>> print(f"{float(stress.peak_depth):.2f}")
    0.48
    """
    if contact["pressure"].dims != ("x", "z"):
        raise ModelError(
            f"Stresses need a pressure over (x, z), got {contact['pressure'].dims}; give "
            "solve_contact a gap along both."
        )
    depths = np.atleast_1d(np.asarray(depth, float))
    pressure = contact["pressure"].to_numpy()
    x, z = contact["x"].to_numpy(), contact["z"].to_numpy()
    spacing = ((x[-1] - x[0]) / (x.size - 1), (z[-1] - z[0]) / (z.size - 1))

    # one transform of the pressure per component and depth is cheap beside that of the influence
    layers: dict[str, list[Array]] = {}
    for level in depths:
        influence = stress_of_cells((x.size, z.size), spacing, float(level), poisson)
        for name, values in influence.items():
            layers.setdefault(name, []).append(Convolution.of(values)(pressure))
    stresses = {name: np.stack(values) for name, values in layers.items()}
    mises = equivalent_stress(**stresses)
    layer, row, column = np.unravel_index(int(mises.argmax()), mises.shape)
    peak = {
        "peak_von_mises": mises.max(),
        "peak_depth": depths[layer],
        "peak_x": x[row],
        "peak_z": z[column],
    }
    named = {"von_mises": mises} | {f"stress_{name}": each for name, each in stresses.items()}
    return describe_by(
        read_table("erlif.joint.models", "variables.toml")["stress"],
        {name: (("depth", "x", "z"), values) for name, values in named.items()}
        | {name: ((), float(value)) for name, value in peak.items()},
        {"depth": ("depth", depths)},
    ).assign_coords(contact.coords)


def equivalent_stress(
    *, xx: Array, yy: Array, zz: Array, xz: Array, xy: Values = 0.0, zy: Values = 0.0
) -> Array:
    """Equivalent stress of von Mises."""
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    shear = xz**2 + xy**2 + zy**2
    mises: Array = np.sqrt(normal / 2 + 3 * shear)
    return mises


# influence of uniformly loaded cells


def corner_differences(
    corner: Callable[[Array, Array], Array], shape: tuple[int, int], spacing: tuple[float, float]
) -> Array:
    """Integral over a cell from its antiderivative at the four corners, for all offsets of a grid.

    Parameters
    ----------
    corner : callable
        Antiderivative of the influence of a point in x and z.
    shape : tuple of int
        Numbers of offsets of either sign along x and z: 2 n - 1 offsets from 1 - n to n - 1.
    spacing : tuple of float
        Sides of a cell. [m]

    Returns
    -------
    array, (2 nx - 1, 2 nz - 1)
        Influence at the offsets, the offset zero in the middle.
    """
    x, z = (_edges(count, step) for count, step in zip(shape, spacing, strict=True))
    values = corner(x.reshape(-1, 1), z.reshape(1, -1))
    return np.diff(np.diff(values, axis=0), axis=1)


def _edges(count: int, step: float) -> Array:
    """Sides of the cells at offsets from 1 - n to n - 1, about the middle of a cell."""
    return np.asarray((np.arange(2 * count) - (count - 0.5)) * step, dtype=np.float64)


def displacement_of_cells(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> Array:
    """Displacement under a cell with unit pressure at all offsets. Johnson (1985), eq. 3.25.

    u = [f(x + a, z + b) + f(x - a, z - b) - f(x + a, z - b) - f(x - a, z + b)] / (pi E*) with
    f = x ln(z + r) + z ln(x + r). Terms that cancel at the corners are left out.
    """

    def corner(x: Array, z: Array) -> Array:
        return x * np.arcsinh(z / np.abs(x)) + z * np.arcsinh(x / np.abs(z))

    return corner_differences(corner, shape, spacing) / (np.pi * contact_modulus)


def displacement_of_strips(count: int, spacing: float, contact_modulus: float) -> Array:
    """Displacement under a strip with unit pressure at all offsets, plane strain.

    u = -(2 / (pi E*)) int ln(|x - s| / L) ds with the width L of the grid: displacements are
    relative to a point at the distance L.
    """
    edges = _edges(count, spacing)
    integral = edges * (np.log(np.abs(edges) / (count * spacing)) - 1)
    strips: Array = -2 * np.diff(integral) / (np.pi * contact_modulus)
    return strips


def stress_of_cells(
    shape: tuple[int, int], spacing: tuple[float, float], depth: float, poisson: float
) -> dict[str, Array]:
    """Stresses below a cell with unit pressure, at one depth and all offsets. Love (1929).

    With V = int 1/r and chi = int ln(y + r) over the cell, y the depth:
    s_xx = [2 nu V_y - y V_xx - (1 - 2 nu) chi_xx] / (2 pi), s_yy = [V_y - y V_yy] / (2 pi),
    s_xz = -[y V_xz + (1 - 2 nu) chi_xz] / (2 pi), s_xy = -y V_xy / (2 pi), and alike for z.

    Returns
    -------
    dict of array, (2 nx - 1, 2 nz - 1)
        Stress per pressure of the components xx, zz, yy (along the depth), xz, xy, zy; tension
        positive.
    """
    y = depth

    def root(x: Array, z: Array) -> Array:
        return np.sqrt(x * x + z * z + y * y)

    def v_y(x: Array, z: Array) -> Array:
        return -np.arctan(x * z / (y * root(x, z)))

    def v_xx(x: Array, z: Array) -> Array:
        return -x * z / (root(x, z) * (x * x + y * y))

    def chi_xx(x: Array, z: Array) -> Array:
        return np.arctan(z / x) - np.arctan(y * z / (x * root(x, z)))

    def v_xy(x: Array, z: Array) -> Array:
        return -y * z / (root(x, z) * (x * x + y * y))

    free = 1 - 2 * poisson
    corners: dict[str, Callable[[Array, Array], Array]] = {
        "xx": lambda x, z: 2 * poisson * v_y(x, z) - y * v_xx(x, z) - free * chi_xx(x, z),
        "zz": lambda x, z: 2 * poisson * v_y(x, z) - y * v_xx(z, x) - free * chi_xx(z, x),
        "yy": lambda x, z: v_y(x, z) + y * (v_xx(x, z) + v_xx(z, x)),  # V is harmonic
        "xz": lambda x, z: -y / root(x, z) - free * np.log(y + root(x, z)),
        "xy": lambda x, z: -y * v_xy(x, z),
        "zy": lambda x, z: -y * v_xy(z, x),
    }
    return {
        name: corner_differences(corner, shape, spacing) / (2 * np.pi)
        for name, corner in corners.items()
    }


@dataclass(frozen=True)
class Convolution:
    """Multiplication by the matrix of a grid's influence coefficients.

    Attributes
    ----------
    shape : tuple of int
        Cells of the grid.
    padded : tuple of int
        Cells of the doubled grid of the FFT.
    transform : array
        Transform of the influence.
    diagonal : float
        Influence of a cell on itself.
    """

    shape: tuple[int, ...]
    padded: tuple[int, ...]
    transform: AnyArray
    diagonal: float

    @classmethod
    def of(cls, influence: Array) -> "Convolution":
        """Prepare the convolution with an influence at offsets from 1 - n to n - 1."""
        shape = tuple((size + 1) // 2 for size in influence.shape)
        padded = tuple(scipy.fft.next_fast_len(size, real=True) for size in influence.shape)
        wrapped = np.zeros(padded)
        wrapped[tuple(slice(0, size) for size in influence.shape)] = influence
        # the offset zero, in the middle of the influence, becomes the first cell
        wrapped = np.roll(wrapped, [1 - size for size in shape], axis=tuple(range(len(shape))))
        middle = tuple(size - 1 for size in shape)
        return cls(shape, padded, scipy.fft.rfftn(wrapped), float(influence[middle]))

    def __call__(self, pressure: Array) -> Array:
        """Sum of the influences of all cells at all cells."""
        return self.multiply(pressure, tuple(slice(0, size) for size in self.shape))

    def multiply(self, values: Array, window: tuple[slice, ...]) -> Array:
        """Multiply values of any extent on the doubled grid and return the wanted window.

        Rows of the padding are zero before, and not wanted after, so that their transforms are
        left out.
        """
        spectrum = scipy.fft.rfft(values, self.padded[-1], axis=-1)
        if len(self.shape) == 1:
            return scipy.fft.irfft(spectrum * self.transform, self.padded[-1])[window]
        spectrum = scipy.fft.fft(spectrum, self.padded[0], axis=0, overwrite_x=True)
        spectrum *= self.transform
        rows = scipy.fft.ifft(spectrum, axis=0, overwrite_x=True)[window[0]]
        return scipy.fft.irfft(rows, self.padded[-1], axis=-1)[:, window[1]]
