"""The measured profile of a bore: its file, and its place in the joint."""

import shutil
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ConfigError, FrameError
from erlif.io.files.soundness import read_settings
from erlif.io.settings import RunSettings, read_run_settings, to_toml

SAMPLE = Path(__file__).parents[3] / "data_samples/straight_bushing/run.toml"
ENDS = "118.5"  # mm, of the joint of the sample


def run_with(folder: Path, profile: str, *, beside: str = "") -> RunSettings:
    """The settings of the sample run with a profile of its bore."""
    shutil.copy(SAMPLE, folder)
    text = (folder / "run.toml").read_text(encoding="utf-8")
    table = f'[joint.bore]\nprofile = "bore.csv"\n{beside}\n[oil]'
    (folder / "run.toml").write_text(text.replace("[oil]", table), encoding="utf-8")
    (folder / "bore.csv").write_text(profile, encoding="utf-8")
    return read_run_settings(folder)


@pytest.mark.parametrize(("head", "sign"), [("depth", 1), ("height", -1)])
def test_profile_is_read_in_its_order_and_sign(tmp_path, head, sign):
    rows = f"axial_mm,{head}_um\n{ENDS},0\n-{ENDS},4\n0,-8\n"
    bore = run_with(tmp_path, rows).joint.bore
    axial = np.array([-0.1185, -0.05925, 0.0, 0.05925, 0.1185])
    expected = sign * 1e-6 * np.array([4, -2, -8, -4, 0])
    npt.assert_allclose(bore.shape(axial, 0.237), expected, atol=1e-15)


def test_profile_may_have_names_and_units_of_its_own(tmp_path):
    rows = f"# scan of 3 May\nPosition (mm)\tTiefe [nm]\n-{ENDS}\t0\n0\t2500\n{ENDS}\t0\n"
    bore = run_with(tmp_path, rows).joint.bore
    npt.assert_allclose(bore.points, [(-118.5, 0), (0, 2.5), (118.5, 0)], rtol=1e-12)


def test_results_keep_the_points(tmp_path):
    settings = run_with(tmp_path, "axial_mm;depth_um\n-118,5;0\n1,5;-2,5\n118,5;0\n")
    assert settings.joint.bore.points[1] == (1.5, -2.5)
    assert read_settings(to_toml(settings)) == settings  # without the file


@pytest.mark.parametrize(
    ("profile", "words"),
    [
        ("", "header such as axial_mm,depth_um and rows of numbers in bore.csv; rows found: 0"),
        ("place,depth_um\n0,1\n2,1\n", "Expected the unit of column place of bore.csv"),
        ("axial_mm,gap_um\n0,1\n2,1\n", "Expected a column for the depth_um in bore.csv"),
        ("axial_mm,depth_um,height_um\n0,1,1\n2,1,1\n", "it has both. Leave one of them out"),
        ("axial_mm,depth_um\n0,1\n", "from end to end, -118.5 to 118.5 mm"),
        ("axial_mm,depth_um\n0,1\n1,none\n", "row 3.*none.*Correct the cell"),
        ("axial_mm,depth_um\n0,1\n1,nan\n", "row 3.*nan.*Correct the cell"),
        ("axial_mm,depth_um\n0,1\n1\n", "2 values in row 3 of bore.csv.* has 1. Correct the row"),
        ("axial_mm,depth_um\n-20,1\n20,1\n", "from end to end, -118.5 to 118.5 mm .* -20 to 20 mm"),
        (f"axial_mm,depth_um\n-{ENDS},1\n0,1\n0,2\n{ENDS},1\n", "rising places. Sort them"),
        (f"axial_mm,depth_um\n-{ENDS},0\n{ENDS},-231\n", "clearance, 230 um, .* 231 um into the"),
        (f"axial_mm,depth_um\n-{ENDS},0\n{ENDS},0.02\n", "by 0.02 um at most, as numbers in mm"),
    ],
)
def test_profiles_of_no_use_are_refused(tmp_path, profile, words):
    with pytest.raises(ConfigError, match=words):
        run_with(tmp_path, profile)


def test_profile_beside_lobes_is_refused(tmp_path):
    flat = f"axial_mm,depth_um\n-{ENDS},0\n{ENDS},0\n"
    edges = 'edge_length = "5 mm"\nedge_depth = "9 um"'
    with pytest.raises(ConfigError, match="give either a profile, or lobes and edges"):
        run_with(tmp_path, flat, beside=edges)


def test_missing_profile_is_named(tmp_path):
    run_with(tmp_path, f"axial_mm,depth_um\n-{ENDS},0\n{ENDS},0\n")
    (tmp_path / "bore.csv").unlink()
    with pytest.raises(ConfigError, match=r"bore\.csv; it cannot be read: No such file"):
        read_run_settings(tmp_path)


@pytest.mark.parametrize("how", ["name", "absolute", "link"])
@pytest.mark.parametrize("content", ["axial_mm,depth_um\n-118.5,0\n118.5,5\n", "a secret\n", None])
def test_profile_outside_is_not_read_unless_allowed(tmp_path, how, content):
    run, outside = tmp_path / "run", tmp_path / "secret.csv"
    run.mkdir()
    run_with(run, f"axial_mm,depth_um\n-{ENDS},0\n{ENDS},0\n")
    if content is not None:
        outside.write_text(content)
    if how == "link":
        (run / "bore.csv").unlink()
        (run / "bore.csv").symlink_to(outside)
    else:
        named = "../secret.csv" if how == "name" else outside.as_posix()
        text = (run / "run.toml").read_text().replace("bore.csv", named)
        (run / "run.toml").write_text(text)

    # the same words for any content: nothing of the file is used
    with pytest.raises(FrameError, match=r"within it; .*--allow-outside") as refused:
        read_run_settings(run)
    assert "a secret" not in str(refused.value)
    if content is not None and "depth" in content:
        bore = read_run_settings(run, allow_outside=True).joint.bore
        assert bore.points == ((-118.5, 0), (118.5, 5))
