"""The ERLIF challenge: what its score means, and what its rigs hand out."""

from pathlib import Path

import h5py
import numpy as np
import pytest
import tifffile
from scenes.scripts import load_script

ROOT = Path(__file__).parents[1]
FILM, LIMIT = 5.0, 0.1  # um

score = load_script(ROOT / "benchmarks" / "challenge" / "score.py")


@pytest.fixture
def truth():
    """Two maps of one film; the last row of the first map lies under a bubble."""
    film = np.full((2, 100, 100), FILM)
    limit = np.full(film.shape, LIMIT)
    limit[0, -1] = np.nan
    region = np.ones(film.shape[1:], bool)
    return {
        "film": film,
        "limit": limit,
        "region": region,
        "minimum": np.full(2, FILM),
        "exponent": 0.6,
    }


def test_the_score_of_noise_and_bias_of_known_size(truth):
    rng = np.random.default_rng(1)
    noise = rng.normal(0.0, 2 * LIMIT, truth["film"].shape)
    found = {
        "thickness": 1.02 * truth["film"] + noise,
        "std": np.full(truth["film"].shape, np.hypot(2 * LIMIT, 0.02 * FILM)),
        "minimum": 1.03 * truth["minimum"],
        "exponent": 0.58,
    }
    got = score.score_rig(truth, found)
    assert got["bias"] == pytest.approx(2.0, abs=0.1)
    assert got["scatter"] == pytest.approx(2.0, abs=0.05)
    assert got["minimum"] == pytest.approx(3.0)
    assert got["exponent"] == pytest.approx(-0.02)
    assert got["measured"] == 100
    assert got["false"] == pytest.approx(0.5)  # the row under the bubble: 100 of 20,000 values
    # within one standard deviation of a normal error of bias 0.447 and scatter 0.894 of it
    assert got["within_68"] == pytest.approx(67.9, abs=1.0)


def test_what_is_not_measured_is_not_false(truth):
    thickness = truth["film"].copy()
    thickness[0, -1] = np.nan  # the bubble
    thickness[1, :50] = np.nan
    got = score.score_rig(truth, {"thickness": thickness})
    assert got["false"] == 0
    assert got["measured"] == pytest.approx(100 * 14_900 / 19_900)
    assert np.isnan(got["within_68"])

    thickness[1, 50:60] = 1.3 * FILM
    assert score.score_rig(truth, {"thickness": thickness})["false"] == pytest.approx(100 / 14.9)


def test_a_table_has_a_row_for_each_submission(truth, tmp_path):
    with h5py.File(tmp_path / "one.h5", "w") as file:
        for key in ("film", "limit", "region", "minimum"):
            file[key] = truth[key]
        file.attrs["exponent"] = truth["exponent"]
    for method, factor in (("near", 1.01), ("far", 1.1)):
        (tmp_path / method).mkdir()
        with h5py.File(tmp_path / method / "one.nc", "w") as file:
            file["thickness"] = factor * truth["film"]
    table = score.tabulate(tmp_path, [tmp_path / "near", tmp_path / "far"])
    assert "| one | near | **1.00** |" in table
    assert "| one | far | 10.00 |" in table


def test_a_rig_keeps_truth_and_means_of_a_laboratory_apart(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks.challenge import rigs

    small = {"width": 64, "height": 48, "spacing": 8.0, "fixture_frames": 1}
    monkeypatch.setattr(rigs, "COMMON", rigs.COMMON | small)
    digest = rigs.draw_rig("thin", tmp_path)

    home = tmp_path / "rigs" / "thin"
    assert not list(home.rglob("truth*"))
    plain, whole = (
        (home / part / "run.toml").read_text(encoding="utf-8") for part in ("run", "laboratory")
    )
    for means in ("background =", "fixture_after", 'ratio = "correct"', "[systematics]"):
        assert means not in plain
        assert means in whole
    with h5py.File(tmp_path / "truth" / "thin.h5") as file:
        assert file["film"].shape == file["limit"].shape == (6, 48, 64)

    # one count in one frame is another rig
    path = home / "run" / "camera1_dark.tif"
    counts = tifffile.imread(path)
    counts.flat[7] += 1
    tifffile.imwrite(path, counts)
    assert rigs.hash_frames(home) != digest


def test_the_page_and_the_list_of_hashes_have_every_rig_and_method(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks.challenge import methods, rigs

    page = (ROOT / "docs" / "challenge.md").read_text(encoding="utf-8")
    assert list(rigs.read_hashes()) == list(rigs.RIGS)
    for rig in rigs.RIGS:
        assert f"| `{rig}` |" in page
        assert all(f"| {rig} | {method} |" in page for method in methods.METHODS)
