"""Contact of half spaces and the stress below it against closed forms, and against tamaas."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scipy.integrate import dblquad

from erlif.joint.models.edges import lundberg_profile, solve_contact, subsurface_stress
from erlif.joint.models.edges.half_space import (
    Convolution,
    displacement_of_cells,
    displacement_of_strips,
)
from erlif.models.contact import hertz_ellipse, hertz_line

STEEL = 109.8901e9
"""Contact modulus of two steel bodies of 200 GPa and 0.3. [Pa]"""


def middles(count, extent):
    return (np.arange(count) - (count - 1) / 2) * extent / count


def test_an_approach_within_the_gap_leaves_it_open():
    gap = 1e-6 + middles(16, 2e-3)[:, None] ** 2 / 0.02 + np.zeros(8)
    found = solve_contact(gap, spacing=1e-4, contact_modulus=STEEL, approach=0.4e-6)
    assert float(found.force) == float(found.peak_pressure) == float(found.area) == 0
    npt.assert_allclose(found.gap, gap - 0.4e-6)


def test_point_contact_is_that_of_hertz():
    hertz = hertz_ellipse(50.0, radius=0.01, radius_across=0.004, contact_modulus=STEEL)
    widths = 2.3 * np.array([hertz.a, hertz.b])
    x, z = middles(128, widths[0]), middles(96, widths[1])
    gap = x[:, None] ** 2 / 0.02 + z**2 / 0.008
    found = solve_contact(gap, spacing=widths / (128, 96), contact_modulus=STEEL, load=50.0)
    npt.assert_allclose(found.peak_pressure, hertz.pressure, rtol=1e-3)
    npt.assert_allclose(found.approach, hertz.approach, rtol=1e-3)
    npt.assert_allclose(found.area, np.pi * hertz.a * hertz.b, rtol=0.01)
    ellipse = 1 - (x[:, None] / hertz.a) ** 2 - (z / hertz.b) ** 2
    exact = hertz.pressure * np.sqrt(np.maximum(ellipse, 0))
    inner = ellipse > 0.1
    npt.assert_allclose(found.pressure.to_numpy()[inner], exact[inner], rtol=3e-3)
    npt.assert_allclose(found.force, 50.0, rtol=1e-12)
    # the approach of Hertz in place of the load
    pushed = solve_contact(
        gap, spacing=widths / (128, 96), contact_modulus=STEEL, approach=hertz.approach
    )
    npt.assert_allclose(pushed.force, 50.0, rtol=1e-3)


def test_plane_contact_is_that_of_hertz():
    hertz = hertz_line(1e5, radius=0.01, contact_modulus=STEEL)
    x = middles(256, 2.3 * hertz.half_width)
    found = solve_contact(x**2 / 0.02, spacing=x[1] - x[0], contact_modulus=STEEL, load=1e5)
    npt.assert_allclose(found.peak_pressure, hertz.pressure, rtol=1e-4)
    npt.assert_allclose(found.area, 2 * hertz.half_width, rtol=0.01)


def test_rigid_punch_has_an_inverse_square_root_at_its_edge():
    """p = F / (pi sqrt(a^2 - x^2)), Johnson (1985), eq. 2.64."""
    x = middles(1000, 2.0)
    found = solve_contact(np.zeros(1000), spacing=0.002, contact_modulus=1e9, load=1e6)
    inner = np.abs(x) < 0.98
    exact = 1e6 / (np.pi * np.sqrt(1 - x**2))
    npt.assert_allclose(found.pressure[inner], exact[inner], rtol=0.015)
    npt.assert_allclose(found.pressure[np.abs(x) < 0.8], exact[np.abs(x) < 0.8], rtol=1e-3)
    near = (1 - x > 0.02) & (1 - x < 0.2)
    slope, _ = np.polyfit(
        np.log(1 - x[near]), np.log(found.pressure[near] * np.sqrt(1 + x[near])), 1
    )
    npt.assert_allclose(slope, -0.5, atol=3e-3)


def test_round_punch_sinks_as_boussinesq():
    """F = 2 E* a d for a flat, round punch, Johnson (1985), eq. 3.36; its rim is a staircase."""
    x = middles(128, 2.02)
    outside = x[:, None] ** 2 + x**2 > 1
    gap = np.where(outside, 1.0, 0.0)  # too far to touch
    found = solve_contact(gap, spacing=2.02 / 128, contact_modulus=1e9, approach=1e-3)
    npt.assert_allclose(found.force, 2e9 * 1e-3, rtol=5e-3)


def roller(profile, cells=(32, 240), tilt=0.0, **options):
    """A steel roller of 20 mm by 20 mm under 20 kN, and Hertz's line contact beside it."""
    hertz = hertz_line(1e6, radius=0.01, contact_modulus=STEEL)
    x, z = middles(cells[0], 2.6 * hertz.half_width), middles(cells[1], 0.02)
    gap = x[:, None] ** 2 / 0.02 + profile * lundberg_profile(
        z, load=2e4, length=0.02, contact_modulus=STEEL
    )
    spacing = (x[1] - x[0], z[1] - z[0])
    found = solve_contact(
        gap + tilt * z, spacing=spacing, contact_modulus=STEEL, load=2e4, **options
    )
    return found, found.pressure.max("x") / hertz.pressure


def test_lundbergs_profile_spreads_the_load_evenly():
    found, axial = roller(1.0)
    inner = np.abs(found.z) < 0.0095
    npt.assert_allclose(axial[inner], 1.0, atol=0.035)
    npt.assert_allclose(axial[np.abs(found.z) < 0.008], 1.0, atol=0.006)


def test_free_tilt_brings_the_load_to_its_place():
    straight, _ = roller(1.0)
    tilted, _ = roller(1.0, tilt=1e-3, free_tilt=True)
    npt.assert_allclose(tilted.tilt_z, 1e-3, rtol=1e-3)
    npt.assert_allclose(tilted.pressure, straight.pressure, atol=2e-3 * straight.peak_pressure)
    moved, axial = roller(1.0, free_tilt=True, load_position=(0.0, 1e-3))
    arm = (moved.pressure * moved.z).sum() / moved.pressure.sum()
    npt.assert_allclose(arm, 1e-3, rtol=1e-6)
    assert float(axial[-8]) > 1.1 > 1.0 > float(axial[8])


def test_deflection_is_that_of_tamaas():
    """Half spaces on a doubled grid: the same influence of cells from another code."""
    tamaas = pytest.importorskip("tamaas")
    count = 64
    x = middles(count, 1.0)
    gap = (x[:, None] ** 2 + 2 * x**2) / 2
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], [count, count])
    model.E, model.nu = 1e9, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "free")
    solver = tamaas.PolonskyKeerRey(model, -gap, 1e-10)
    solver.setIntegralOperator("free")
    solver.solve(2e6)
    found = solve_contact(gap, spacing=1 / count, contact_modulus=1e9, load=2e6, tolerance=1e-8)
    theirs = np.asarray(model.traction)
    npt.assert_allclose(found.pressure, theirs, atol=1e-4 * theirs.max())


def test_mirror_adds_the_pressure_beyond_the_ends():
    """With a mirror of one, a strip of even pressure deflects at its end like an endless one."""
    half, _ = roller(0.0)
    free, axial = roller(0.0, mirror=1.0)
    npt.assert_allclose(axial[4:-4], 1.0, atol=0.01)
    assert float(free.peak_pressure) < float(half.peak_pressure)


def hertz_pressure(count=64):
    """The exact pressure of a circular contact of unit radius, averaged over cells."""
    fine = (np.arange(8 * count) - (8 * count - 1) / 2) * 2.3 / (8 * count)
    values = np.sqrt(np.maximum(1 - fine[:, None] ** 2 - fine**2, 0))
    cells = values.reshape(count, 8, count, 8).mean((1, 3))
    x = fine.reshape(count, 8).mean(1)
    return xr.Dataset({"pressure": (("x", "z"), cells)}, {"x": x, "z": x})


def test_stress_on_the_axis_of_a_round_contact():
    """Johnson (1985), eqs. 3.45: closed forms on the axis."""
    contact = hertz_pressure(65)
    depth = np.linspace(0.1, 2.0, 20)
    found = subsurface_stress(contact, depth=depth, poisson=0.3).sel(x=0, z=0, method="nearest")
    along = -1 / (1 + depth**2)
    across = -1.3 * (1 - depth * np.arctan(1 / depth)) + 0.5 / (1 + depth**2)
    npt.assert_allclose(found.stress_yy, along, atol=5e-4)
    npt.assert_allclose(found.stress_xx, across, atol=5e-4)
    npt.assert_allclose(found.stress_zz, across, atol=5e-4)
    npt.assert_allclose(found.von_mises, across - along, atol=1e-3)


def test_each_depth_carries_the_load():
    """A narrow contact on a wide grid: the stress along the depth sums to the load."""
    pressure = np.zeros((161, 161))
    pressure[78:83, 78:83] = 1.0
    axis = np.arange(161.0) - 80
    contact = xr.Dataset({"pressure": (("x", "z"), pressure)}, {"x": axis, "z": axis})
    found = subsurface_stress(contact, depth=3.0)
    npt.assert_allclose(-found.stress_yy.sum(), 25.0, rtol=2e-3)


def test_far_stress_is_that_of_boussinesq():
    """s_yy = -3 F y^3 / (2 pi r^5) and the other components, Johnson (1985), eqs. 3.19."""
    pressure = np.zeros((41, 41))
    pressure[20, 20] = 1.0
    axis = (np.arange(41) - 20) * 0.1
    contact = xr.Dataset({"pressure": (("x", "z"), pressure)}, {"x": axis, "z": axis})
    nu, force, depth = 0.25, 0.01, 1.5
    found = subsurface_stress(contact, depth=depth, poisson=nu).isel(depth=0)
    x, z, y = axis[:, None], axis[None, :], depth
    r = np.sqrt(x**2 + z**2 + y**2)
    flat = x**2 + z**2
    unit = force / (2 * np.pi)
    npt.assert_allclose(found.stress_yy, unit * -3 * y**3 / r**5, atol=1e-5)
    npt.assert_allclose(found.stress_xy, unit * -3 * x * y**2 / r**5, atol=1e-5)
    npt.assert_allclose(found.stress_zy, unit * -3 * z * y**2 / r**5, atol=1e-5)
    total = found.stress_xx + found.stress_zz + found.stress_yy
    npt.assert_allclose(total, unit * -2 * (1 + nu) * y / r**3, atol=1e-5)
    far = np.where(flat > 0, flat, np.nan)
    radial = (1 - 2 * nu) / far
    xx = radial * ((1 - y / r) * (x**2 - z**2) / far + y * z**2 / r**3) - 3 * y * x**2 / r**5
    xz = radial * ((1 - y / r) * 2 * x * z / far - x * y * z / r**3) - 3 * x * y * z / r**5
    known = flat > 0
    npt.assert_allclose(found.stress_xx.to_numpy()[known], (unit * xx)[known], atol=1e-5)
    npt.assert_allclose(found.stress_xz.to_numpy()[known], (unit * xz)[known], atol=1e-5)


def test_displacement_is_the_integral_of_boussinesq():
    """u = int p / (pi E* r) over a cell."""
    found = displacement_of_cells((4, 3), (0.5, 0.8), 2.0)
    assert found.shape == (7, 5)
    for i, j in ((1, 1), (3, 0), (2, 2)):
        far, _ = dblquad(
            lambda z, x: 1 / np.hypot(x, z),
            (i - 0.5) * 0.5, (i + 0.5) * 0.5, (j - 0.5) * 0.8, (j + 0.5) * 0.8,
        )  # fmt: skip
        npt.assert_allclose(found[3 + i, 2 + j], far / (2 * np.pi), rtol=1e-6)
    # a square under even pressure, in its middle: 4 a ln(1 + sqrt 2) / pi E*, Johnson (1985), 3.27
    square = displacement_of_cells((1, 1), (1.0, 1.0), 1.0)
    npt.assert_allclose(square[0, 0], 4 * np.log(1 + np.sqrt(2)) / np.pi, rtol=1e-12)


def test_rows_of_cells_are_a_strip():
    """A long row of cells deflects like a strip, up to a constant."""
    rows = displacement_of_cells((6, 4000), (1.0, 1.0), 1.0)[5:].sum(axis=1)
    strip = displacement_of_strips(6, 1.0, 1.0)[5:]
    npt.assert_allclose(rows - rows[0], strip - strip[0], rtol=1e-5)


def test_convolution_is_the_sum_over_cells():
    pressure = np.random.default_rng(1).random((5, 4))
    influence = displacement_of_cells((5, 4), (1.0, 0.7), 1.0)
    total = np.zeros((5, 4))
    for i in range(5):
        for j in range(4):
            total[i, j] = sum(
                influence[4 + i - k, 3 + j - m] * pressure[k, m] for k in range(5) for m in range(4)
            )
    npt.assert_allclose(Convolution.of(influence)(pressure), total, rtol=1e-12)
