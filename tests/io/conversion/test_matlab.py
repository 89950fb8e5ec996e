"""Files of MATLAB, read by scipy, by h5py and, where it is installed, by GNU Octave."""

import shutil
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io

from erlif.core.progress import silent
from erlif.io.conversion.matlab import write_matlab

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "film_octave.m"
ALL = [0, 1, 2, 3, 4, 5]


@pytest.fixture(scope="module")
def mat(film, tmp_path_factory):
    path = tmp_path_factory.mktemp("mat") / "film.mat"
    write_matlab(film, path, triggers=ALL, progress=silent)
    return path


def test_maps_have_rows_y_and_columns_x_as_matlab_shows_them(film, mat):
    found = scipy.io.loadmat(mat)
    for name in ("thickness", "thickness_std", "thickness_std_shared", "flags"):
        assert found[name].dtype == film[name].dtype
        np.testing.assert_array_equal(found[name], film[name].values.transpose(1, 2, 0))
    assert found["x"].shape == (64, 1)
    assert found["pin_position_cov"].shape == (4, 4, 6)
    np.testing.assert_array_equal(found["film_min"][:, 0], film.film_min.values)


def test_units_and_settings_are_structs(film, mat):
    found = scipy.io.loadmat(mat, simplify_cells=True)
    assert found["units"]["rocker_speed"] == "rad s-1"
    assert found["attributes"]["title"] == film.attrs["title"]
    assert found["axis"].tolist() == ["load", "side"]


def test_a_column_of_the_log_with_any_name_has_a_name_of_matlab(film, tmp_path):
    path = tmp_path / "film.mat"
    named = film.assign({"2nd cell (N)": ("trigger", np.arange(6.0))})
    write_matlab(named, path, triggers=[1], progress=silent)
    assert scipy.io.loadmat(path)["x_2nd_cell__N_"].tolist() == [[1.0]]


@pytest.fixture(scope="module")
def large(film, tmp_path_factory):
    """A film that counts as too large for version 5."""
    path = tmp_path_factory.mktemp("mat") / "film.mat"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("erlif.io.conversion.matlab.LARGEST", 1000)
        write_matlab(film, path, triggers=ALL, progress=silent)
    return path


def test_a_large_film_is_written_as_version_73(film, large):
    assert large.read_bytes().startswith(b"MATLAB 7.3 MAT-file, written by erlif")
    with h5py.File(large) as file:
        assert file["thickness"].attrs["MATLAB_class"] == b"single"
        # dimensions of HDF5 are those of MATLAB in reverse
        np.testing.assert_array_equal(file["thickness"][2].T, film.thickness.values[2])
        text = file["units/film_min"]
        assert text.attrs["MATLAB_class"] == b"char"
        assert "".join(map(chr, text[:, 0])) == "um"


def octave(script: str, folder: Path) -> str:
    program = shutil.which("octave-cli") or shutil.which("octave")
    if program is None:
        pytest.skip("GNU Octave is not installed")
    done = subprocess.run(
        [program, "--quiet", "--no-gui", "--no-init-file", "--eval", script],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0 or "bye" in done.stdout, done.stderr
    return done.stdout


def test_octave_runs_the_example_of_the_documentation_on_both_versions(film, mat, large):
    thinnest = film.isel(trigger=int(film.film_min.values.argmin()))
    expected = (
        "24 rows, 64 columns, 6 triggers",
        f"valid {100 * float((film.flags[1] == 0).mean()):.2f} %",
        f"thinnest {float(thinnest.film_min):.3f} +- {float(thinnest.film_min_std):.3f} um at "
        f"trigger {int(thinnest.trigger)}",
    )
    for path in (mat, large):
        shown = octave(f"trigger = 1; source('{EXAMPLE}'); disp('bye')", path.parent)
        assert "bye" in shown
        for line in expected:
            assert line in shown
