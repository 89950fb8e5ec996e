"""Stress below the surface of a contact."""

from typing import TYPE_CHECKING

import numpy as np

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.models.arguments import Values, formula
from erlif.models.edges.influence import Convolution, stress_of_cells

if TYPE_CHECKING:
    import xarray as xr


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

    >>> from erlif.models.edges import solve_contact
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
    stresses = {name: np.stack(found) for name, found in layers.items()}
    mises = equivalent_stress(stresses)
    layer, row, column = np.unravel_index(int(mises.argmax()), mises.shape)
    peak = {
        "peak_von_mises": mises.max(),
        "peak_depth": depths[layer],
        "peak_x": x[row],
        "peak_z": z[column],
    }
    named = {"von_mises": mises} | {f"stress_{name}": found for name, found in stresses.items()}
    return describe_by(
        read_table("erlif.models", "variables.toml")["stress"],
        {name: (("depth", "x", "z"), values) for name, values in named.items()}
        | {name: ((), float(value)) for name, value in peak.items()},
        {"depth": ("depth", depths)},
    ).assign_coords(contact.coords)


def equivalent_stress(stress: dict[str, Array]) -> Array:
    """Equivalent stress of von Mises of the components xx, zz, yy, xz, xy, zy."""
    xx, yy, zz = stress["xx"], stress["yy"], stress["zz"]
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    shear = stress["xz"] ** 2 + stress["xy"] ** 2 + stress["zy"] ** 2
    return np.sqrt(normal / 2 + 3 * shear)
