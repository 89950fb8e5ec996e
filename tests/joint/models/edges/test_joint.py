"""The joint against Persson's law, its own similarity, and what Farzaneh (2002) observed."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.contact import conformal_radius, hertz_ellipse, persson_contact

pytest.importorskip("skfem", reason="the finite elements of the joint are those of scikit-fem")

from erlif.joint.models.edges import (
    EdgeJoint,
    Undercut,
    prepare_joint,
    search_undercut,
    section_stress,
    solve_joint,
)
from erlif.joint.models.edges.cylinders import Section, compute_compliance
from erlif.joint.models.edges.joint import ElasticJoint, graded_lines

THESIS = EdgeJoint(0.03336, 0.03359, 0.0533, length=0.2373, pin_length=0.3508)
OPTIMUM = Undercut(depth=0.020, width=0.008, lip=0.0093)
TEN_THOUSAND_POUNDS = 44.48e3


SHORT = replace(THESIS, length=0.06, pin_length=0.12)
COARSE = {"smallest_cell": 2e-3, "harmonics": [0, 1, 2, 5, 14, 40, 110]}


@pytest.fixture(scope="module")
def straight():
    return prepare_joint(THESIS, **COARSE, largest_cell=8e-3)


@pytest.fixture(scope="module")
def undercut(straight):
    cut = replace(THESIS, undercut=OPTIMUM)
    return prepare_joint(cut, pin=straight.pin, **COARSE, largest_cell=8e-3)


@pytest.fixture(scope="module")
def short():
    return prepare_joint(SHORT, **COARSE)


@pytest.mark.parametrize("line_load", [1e5, 1e6])
def test_long_joint_has_perssons_pressure(line_load):
    """Plane strain, a thick bushing: half contact angles of 26 and 60 degrees."""
    cells = np.array([0.0, 1.0])
    pin_radii = 1 - graded_lines(1.0, first=0.01, growth=1.5, largest=0.2)[::-1]
    radii = 1.001 + graded_lines(30.0, first=0.01, growth=1.5, largest=5.0)
    sections = (
        Section(pin_radii, cells, 1.0, 1e9, 0.3, False, held_ends=True),
        Section(radii, cells, radii[0], 1e9, 0.3, True, held_ends=True),
    )
    pin, bushing = (compute_compliance(section, cells) for section in sections)
    joint = EdgeJoint(1.0, 1.001, 31.001, length=2.0, pin_length=2.0)
    elastic = ElasticJoint(joint, cells, (0.0, 1.0), sections, pin, bushing)
    elastic.pin.loaded.resize((1, 1), refcheck=False)
    found = solve_joint(elastic, load=2 * line_load, tolerance=1e-6)
    exact = persson_contact(line_load, play=0.002, pin_diameter=2.0, youngs_modulus=1e9 / 0.91)
    npt.assert_allclose(found.peak_pressure, exact.pressure, rtol=1e-3)
    touching = found.angle[found.pressure[:, 0] > 0]
    npt.assert_allclose(touching.max(), exact.half_angle, atol=2 * np.pi / 512)


def test_straight_bushing_presses_at_its_end(straight):
    """Farzaneh (2002), section 3.4: the largest pressure is at the inside edge of the bushing."""
    found = solve_joint(straight, load=TEN_THOUSAND_POUNDS)
    npt.assert_allclose(found.peak_z, found.z[-1])
    npt.assert_allclose(found.force, TEN_THOUSAND_POUNDS, rtol=1e-9)
    npt.assert_allclose(2 * (found.line_load * found.cell_length).sum(), found.force, rtol=1e-9)
    npt.assert_allclose(found.pressure[1:], found.pressure[:0:-1], rtol=0.01, atol=1e4)
    assert float(found.gap.min()) > -1e-9
    assert np.all(np.diff(found.bending) > 0)  # the ends of the pin sink most


def test_load_and_modulus_scale_together(short):
    """Farzaneh (2002), section 3.1: 1/75 of modulus and load are 1/75 of the pressure."""
    soft = replace(SHORT, youngs_modulus=200e9 / 75, pin_youngs_modulus=200e9 / 75)
    acrylic = solve_joint(prepare_joint(soft, **COARSE), load=TEN_THOUSAND_POUNDS / 75)
    steel = solve_joint(short, load=TEN_THOUSAND_POUNDS)
    npt.assert_allclose(75 * acrylic.pressure, steel.pressure, rtol=1e-6, atol=1.0)


def test_a_lobe_has_the_pressure_of_hertz():
    """14 mm round the bore, an arc over which Hertz is a few % low, and 1.6 mm along the axis.

    Farzaneh (2002), section 3.3.3: 756 MPa by elements of 4 mm under 10,000 lbf, which is Hertz's
    751 MPa if these act on the quarter that is meshed.
    """
    crest, height = 0.03359, 237.5e-6
    lobed = EdgeJoint(0.03336, crest + height, 0.0533, length=0.08, pin_length=0.08)
    elastic = prepare_joint(
        lobed, smallest_cell=0.3e-3, refine=[0.02], growth=1.5, largest_cell=0.01,
        load_span=(0.0, 0.04), harmonics=[0, 1, 2, 5, 14, 40, 110],
    )  # fmt: skip
    radius = conformal_radius(0.03336, bushing_radius=crest)
    for load, printed, high in (
        (TEN_THOUSAND_POUNDS, 475e6, 1.06),
        (4 * TEN_THOUSAND_POUNDS, 756e6, 1.08),
    ):
        found = solve_joint(elastic, load=load, lobes=[0.02], lobe_height=height)
        hertz = hertz_ellipse(
            load / 2, radius=radius, radius_across=0.2, contact_modulus=109.89e9
        ).pressure
        npt.assert_allclose(hertz, printed, rtol=0.01)
        assert 1.0 < float(found.peak_pressure) / hertz < high
    npt.assert_allclose(found.patch_pressure, 756e6, rtol=0.03)


def test_a_load_beside_the_middle_tilts_the_pin(short):
    whole = prepare_joint(SHORT, **COARSE, whole=True)
    even, centred = solve_joint(short, load=2e4), solve_joint(whole, load=2e4)
    npt.assert_allclose(centred.peak_pressure, even.peak_pressure, rtol=1e-3)
    npt.assert_allclose(centred.displacement, even.displacement, rtol=1e-3)
    npt.assert_allclose(centred.tilt, 0, atol=1e-9)
    off = solve_joint(whole, load=2e4, load_position=5e-3)
    arm = (off.line_load * off.cell_length * off.z).sum() / off.force
    npt.assert_allclose(arm, 5e-3, rtol=1e-6)
    assert float(off.tilt) > 0
    with pytest.raises(ModelError, match="whole=True"):
        solve_joint(short, load=2e4, load_position=5e-3)
    with pytest.raises(ModelError, match="beyond the bushing"):
        solve_joint(whole, load=2e4, load_position=0.04)


def test_stress_in_the_wall_carries_the_load():
    """Below the contact the radial stress of a wide, thin ring is the pressure above it."""
    thin = EdgeJoint(0.03336, 0.03359, 0.0346, length=0.2, pin_length=0.2)
    elastic = prepare_joint(thin, **COARSE, load_span=(0.0, 0.1), growth=1.6, largest_cell=0.03)
    contact = solve_joint(elastic, load=1e6, around=256)
    stress = section_stress(elastic, contact, harmonics=40)
    middle = (stress.z < 0.03) & (stress.r > 0.0339)
    pressed = contact.pressure.sel(angle=0, z=0, method="nearest")
    npt.assert_allclose(-stress.stress_rr[middle].mean(), pressed, rtol=0.05)
    assert {"peak_von_mises", "peak_r", "peak_z"} <= set(stress)


BRICKS = {4e-3: [147, 131, 214], 12e-3: [168, 147, 129]}
"""Largest pressure [MPa] of the short joint in trilinear bricks, for lips of 3, 6 and 12 mm.

`python benchmarks/edges_solid.py search`: a quarter of both bodies in three dimensions, nodes every
2 mm, contact from node to node; no harmonics, and no code of `erlif.joint.models.edges`.
"""


def test_search_finds_the_undercut_that_solid_elements_find():
    found = search_undercut(
        SHORT,
        load=1e5,
        depths=list(BRICKS),
        widths=[0.004, 0.018],
        lips=[0.003, 0.006, 0.012],
        smallest_cell=1e-3,
        harmonics=[0, 1, 2, 5, 14, 40, 110],
        patch=1e-3,
    )
    assert np.isnan(found.patch_pressure.sel(width=0.018)).all()  # wider than the wall
    solid = np.array(list(BRICKS.values())) * 1e6
    pressure = found.patch_pressure.sel(width=0.004).to_numpy()
    assert (float(found.best_depth), float(found.best_lip)) == (0.012, 0.012)
    assert solid.argmin() == 5

    # the thick lip of a short cut presses at its sharp edge, where a pressure is one of its mesh
    smooth = np.array([[True, True, False], [True, True, True]])
    npt.assert_allclose(pressure[smooth], solid[smooth], rtol=0.06)
    npt.assert_allclose(np.argsort(pressure[0]), np.argsort(solid[0]))
    with pytest.raises(ModelError, match="No undercut"):
        search_undercut(SHORT, load=1e5, depths=[0.04], widths=[0.005], lips=[0.005], **COARSE)


def test_options_that_cannot_be_are_refused(straight):
    with pytest.raises(ModelError, match="even number"):
        solve_joint(straight, load=1.0, around=33)
    with pytest.raises(ModelError, match="patch must be positive"):
        solve_joint(straight, load=1.0, patch=0.0)
    with pytest.raises(ModelError, match="Lobes lie"):
        solve_joint(straight, load=1.0, lobes=[0.2], lobe_height=1e-4)
