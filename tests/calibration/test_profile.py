"""CMM profiles: what is read, corrected and refused, and the gradient of known forms."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import SHAPE, WEDGE, calibrate, has_note, image, log_ratio, wedge_profile

from erlif.calibration import Profile, read_profile
from erlif.calibration.profile import gradient_of_thickness
from erlif.core.errors import CalibrationError
from erlif.core.notes import Level


def write_profile(path, rows, header="x_mm,thickness_um,uncertainty_um"):
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


# the file


def test_columns_are_read_and_spaces_and_blank_lines_ignored(tmp_path):
    rows = [f" {x} , {x / 2},0.1" for x in range(9)]
    profile = read_profile(write_profile(tmp_path / "p.csv", [*rows, "", " , ,"]))
    npt.assert_array_equal(profile.position, np.arange(9))
    npt.assert_array_equal(profile.thickness, np.arange(9) / 2)
    npt.assert_array_equal(profile.uncertainty, 0.1)
    assert profile.notes == ()


def test_profile_out_of_order_is_sorted_and_repeats_averaged(tmp_path):
    rows = [f"{x},{x * 2.0},0.1" for x in (0, 2, 1, 3, 4, 5, 6, 7, 8)] + ["8,17.0,0.1"]
    profile = read_profile(write_profile(tmp_path / "p.csv", rows))
    npt.assert_allclose(profile.position, np.arange(9))
    npt.assert_allclose(profile.thickness[-1], 16.5)
    npt.assert_allclose(profile.uncertainty[-1], 0.1 / np.sqrt(2))
    assert [(note.level, note.subject) for note in profile.notes] == [(Level.WARNING, "p.csv")] * 2


X, GAP = np.arange(9) / 4, np.arange(9) / 2 + 1
FORMS = {
    "own names": ("Position [mm];Spalt [um]", ";", 1, 1),
    "in German": ("Weg [mm]\tSchichtdicke [µm]\tUnsicherheit [nm]", "\t", 1, 1),
    "suffixes": ("x_um,film_thickness_mm", ",", 1e3, 1e-3),
    "metres": ("X / m,Gap / nm", ",", 1e-3, 1e3),
    "a row of units": ("x,thickness,sigma\nmm,um,um", ",", 1, 1),
    "blanks": ("x [mm]   gap [um]  std [um]", "   ", 1, 1),
    "comments": ("# Calypso 2023\n% Plan: wedge\n\nx_mm,thickness_um", ",", 1, 1),
    "a preamble": ("Profilometer 3\nOperator;Ä\nx_mm;thickness_um", ";", 1, 1),
    "further columns": ("no,x_mm,thickness_um,note", ",", 1, 1),
}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
@pytest.mark.parametrize(("header", "separator", "x_scale", "gap_scale"), FORMS.values(), ids=FORMS)
def test_profiles_have_the_forms_of_logs(tmp_path, header, separator, x_scale, gap_scale, encoding):
    rows = []
    for n, (x, gap) in enumerate(zip(X * x_scale, GAP * gap_scale, strict=True)):
        cells = [f"{x:.9g}", f"{gap:.9g}"]
        if "no," in header:
            cells = [str(n), *cells, "end" if n == 8 else ""]
        elif "um]  std" in header or "sigma" in header or "Unsicherheit" in header:
            cells.append("0.1" if "nm" not in header else "100")
        line = separator.join(cells)
        rows.append(line.replace(".", ",") if separator == ";" else line)
    path = tmp_path / "p.csv"
    path.write_text("\n".join([header, *rows]) + "\n", encoding=encoding)
    profile = read_profile(path)
    npt.assert_allclose(profile.position, X)
    npt.assert_allclose(profile.thickness, GAP)
    if profile.uncertainty is not None:
        npt.assert_allclose(profile.uncertainty, 0.1)


@pytest.mark.parametrize(
    ("header", "scales", "words"),
    [
        ("x_mm,thickness_um", (1, 1e-3), "as numbers in mm would have"),
        ("x_mm,thickness_mm", (1, 1), "as numbers in nm would be"),
        ("x_mm,thickness_um", (1, -1), "as heights of a surface are. Write"),
        ("x_mm,thickness_um", (1e3, 1), "x_mm spans 2000 mm, as numbers in um would"),
        ("x_mm,z_um", (1, 1), "column 'z_um' is a height of its surface. Write"),
        ("x [mm],Height [um]", (1, 1), "column 'Height [um]' is a height"),
        ("x,gap", (1, 1), "the unit of column x of p.csv, the x; got none"),
        ("x_mm,gap [inch]", (1, 1), "got 'inch'. Give its unit: write it behind the name"),
        ("x_mm,A", (1, 1), "its columns are 'x_mm', 'A'. Choose one: call it thickness_um"),
        ("gap [um],film_um,x_mm", (1, 1), "'gap [um]' and 'film_um' may be meant"),
    ],
)
def test_what_is_no_thickness_is_named(tmp_path, header, scales, words):
    rows = [f"{x * scales[0]},{gap * scales[1]}" for x, gap in zip(X, GAP, strict=True)]
    rows = [row + ",1" * (header.count(",") - 1) for row in rows]
    with pytest.raises(CalibrationError) as refused:
        read_profile(write_profile(tmp_path / "p.csv", rows, header))
    assert words in str(refused.value)


# lines and surfaces


def test_a_line_scan_with_a_y_column_is_a_line(tmp_path):
    """A CMM writes y_mm although it ran along a line, to a few micrometres.

    The calibration is the same as without the column.
    """
    rng = np.random.default_rng(18)
    line, ratios = wedge_profile(rng), image(rng, log_ratio(WEDGE))
    rows = [
        f"{x!r},{t!r},0.15"
        for x, t in zip(line.position.tolist(), line.thickness.tolist(), strict=True)
    ]
    plain = read_profile(write_profile(tmp_path / "line.csv", rows))
    header = "x_mm,y_mm,thickness_um,uncertainty_um"
    for wander in (0.0, 0.003):
        across = (1.5 + rng.uniform(-wander, wander, len(rows))).tolist()
        listed = [row.replace(",", f",{y!r},", 1) for row, y in zip(rows, across, strict=True)]
        order = rng.permutation(len(rows))
        found = read_profile(
            write_profile(tmp_path / "scan.csv", [listed[n] for n in order], header)
        )
        npt.assert_array_equal(found.position, plain.position)
        npt.assert_array_equal(found.thickness, plain.thickness)
        assert has_note(found, "a line profile along x_mm, at y_mm 1.5")
        npt.assert_array_equal(
            calibrate(ratios, found).parameters, calibrate(ratios, plain).parameters
        )


def test_a_scan_with_extent_in_y_is_a_surface_in_its_own_order(tmp_path):
    places = [(x, y) for y in (0, 2) for x in range(5)]
    rows = [f"{x},{y},{x + y}" for x, y in places]
    found = read_profile(write_profile(tmp_path / "p.csv", rows, "x_mm,y_mm,thickness_um"))
    npt.assert_array_equal(found.position, places)
    npt.assert_array_equal(found.thickness, np.sum(places, axis=1))
    assert found.notes == ()


def test_a_surface_without_extent_is_refused_where_it_is_used():
    x = np.arange(0, 18.9, 0.3)
    profile = Profile(np.stack([x, np.full_like(x, 1.5)], axis=1), 0.1 + x, np.full_like(x, 0.1))
    with pytest.raises(CalibrationError, match="extent"):
        calibrate(image(np.random.default_rng(19), log_ratio(WEDGE), shape=SHAPE), profile)


# the gradient


def test_gradient_of_a_surface_is_that_of_its_polynomial():
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 3, 12), np.linspace(-1, 1, 9)))
    thickness = 2 + x**2 - 3 * x * y + y**3
    expected = np.stack([2 * x - 3 * y, -3 * x + 3 * y**2], axis=1)
    found = Profile(np.stack([x, y], axis=1), thickness, None).surface_gradient
    npt.assert_allclose(found, expected, atol=1e-8)


def test_gradient_of_a_wave_is_its_derivative():
    x = np.linspace(0, 12, 241)
    found = gradient_of_thickness(x[:, None], 5 + np.sin(2 * x), np.full(x.size, 1e-6))
    npt.assert_allclose(found[:, 0], 2 * np.cos(2 * x), atol=1e-4)


def test_noise_of_a_straight_wedge_does_not_become_form():
    """Of 50 noisy wedges at least 48 have one slope at all points, and it is the true one."""
    rng = np.random.default_rng(20)
    x = np.arange(0, 19, 0.1)
    slopes = [
        gradient_of_thickness(
            x[:, None], 0.1 + 0.93 * x + rng.normal(0, 0.15, x.size), np.full(x.size, 0.15)
        )[:, 0]
        for _ in range(50)
    ]
    assert sum(np.ptp(slope) < 1e-9 for slope in slopes) >= 48
    std = 0.15 / np.sqrt(((x - x.mean()) ** 2).sum())  # of the slope of a line
    pulls = (np.median(slopes, axis=1) - 0.93) / std
    assert abs(pulls.mean()) < 4 / np.sqrt(50)


def test_a_precise_point_outweighs_an_imprecise_one():
    """A kink measured with an uncertainty of its own size leaves the slope of the others."""
    x = np.linspace(0, 10, 41)
    thickness, uncertainty = 1 + 0.5 * x, np.full(x.size, 1e-3)
    thickness[20] += 1.0
    uncertainty[20] = 1.0
    found = gradient_of_thickness(x[:, None], thickness, uncertainty)
    npt.assert_allclose(found[:, 0], 0.5, atol=1e-3)
