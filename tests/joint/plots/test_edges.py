"""Figures of a contact: steps, patches and marks are where the dataset has them."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pictures import picture, without_texts

from erlif.joint import plots
from erlif.joint.models import solve_contact, subsurface_stress


@pytest.fixture
def joint():
    """A contact of graded cells, as solve_joint returns it."""
    lengths = np.array([4.0, 2.0, 1.0]) * 1e-3
    z = np.cumsum(lengths) - lengths / 2
    angle = np.linspace(-np.pi, np.pi, 36, endpoint=False)
    pressure = np.maximum(np.cos(angle) - 0.7, 0)[:, None] * np.array([0.0, 1e8, 3e8])
    return xr.Dataset(
        {"pressure": (("angle", "z"), pressure), "cell_length": ("z", lengths)},
        {"angle": angle, "z": z},
    )


@pytest.fixture
def ball():
    x, z = (np.arange(20) - 9.5) * 1e-4, (np.arange(24) - 11.5) * 1e-4
    return solve_contact(
        (x[:, None] ** 2 + z**2) / 2, spacing=1e-4, contact_modulus=1e11, load=40.0
    )


@pytest.fixture
def section():
    """Four elements of a bushing with a step."""
    axes = {"z": [1.0, 3.0, 1.0, 3.0], "r": [10.0, 10.0, 12.0, 12.0]}
    return xr.Dataset(
        {"von_mises": ("point", [1e8, 4e8, 1e5, 2e8]), "peak_r": 10e-3, "peak_z": 3e-3},
        {name: ("point", np.array(values) * 1e-3) for name, values in axes.items()}
        | {name: ("point", np.full(4, 2e-3)) for name in ("width_r", "width_z")},
    )


@pytest.fixture
def search():
    pressure = np.array([[[5e8, 4e8, 4.5e8]], [[4e8, 3e8, 3.2e8]]])
    return xr.Dataset(
        {
            "patch_pressure": (("depth", "width", "lip"), pressure, {"patch": 4e-3}),
            "best_depth": 0.02,
            "best_width": 0.008,
            "best_lip": 0.007,
        },
        {"depth": [0.01, 0.02], "width": [0.008], "lip": [0.005, 0.007, 0.009]},
    )


def test_maps_have_the_cells_of_joint_and_half_spaces(joint, ball):
    mesh = plots.contact_pressure_map(ball)
    npt.assert_allclose(mesh.get_coordinates()[0, [0, -1], 0], [-1.2, 1.2])
    assert mesh.axes.get_ylabel() == "across x [mm]"
    mesh = plots.contact_pressure_map(joint)
    corners = mesh.get_coordinates()
    npt.assert_allclose(corners[0, :, 0], [0, 4, 6, 7])  # mm
    npt.assert_allclose(np.nanmax(mesh.get_array()), 90.0)  # MPa
    assert mesh.axes.get_ylim()[1] < 90  # the free part is left out
    npt.assert_allclose(mesh.axes.get_xlim()[1], 7.0)


def test_profiles_are_the_largest_pressures(joint, ball):
    *steps, line = plots.axial_pressure({"joint": joint, "ball": ball}, hertz=2e8)
    npt.assert_allclose(steps[0].get_data().values, [0, 30, 90])
    npt.assert_allclose(steps[1].get_data().values.max(), ball.peak_pressure / 1e6)
    npt.assert_allclose(line.get_ydata(), 200)


def test_stress_is_drawn_element_by_element(section, ball):
    patches = plots.stress_section(section)
    npt.assert_allclose(patches.get_array(), [100, 400, 0.1, 200])
    npt.assert_allclose(patches.get_paths()[1].get_extents().extents, [2, 9, 4, 11])
    (cross,) = patches.axes.lines
    npt.assert_allclose([cross.get_xdata()[0], cross.get_ydata()[0]], [3, 10])
    assert patches.axes.yaxis.get_inverted()

    stress = subsurface_stress(ball, depth=[1e-4, 2e-4, 3e-4])
    below = plots.stress_section(stress)
    npt.assert_allclose(below.get_array().max(), stress.peak_von_mises / 1e6)


def test_the_best_undercut_is_circled(search):
    *lines, best = plots.undercut_pressure(search)
    assert [line.get_label() for line in lines] == ["10", "20"]
    npt.assert_allclose([best.get_xdata()[0], best.get_ydata()[0]], [7, 300])
    assert best.axes.get_ylabel() == "largest mean over 4 mm [MPa]"


@picture
def test_picture_of_a_stressed_section(section):
    return without_texts(plots.stress_section(section).axes.get_figure())
