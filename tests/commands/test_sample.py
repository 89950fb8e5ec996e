"""``erlif sample``."""

from pathlib import Path

import numpy as np
import pytest
import tifffile

REPOSITORY = Path(__file__).parents[2]


@pytest.mark.slow
def test_the_sample_is_that_of_the_repository(tmp_path, command):
    """Settings to the letter; of the pixels, an electron more or less may depend on the machine."""
    kept, out = REPOSITORY / "data_samples" / "straight_bushing", tmp_path / "sample"
    assert "erlif process" in command("sample", out).stdout
    text = (out / "run" / "run.toml").read_text()
    for fixture in ("fixture", "fixture_after"):
        place = f"calibration/{fixture.replace('fixture', 'wedge')}/"
        text = text.replace(f"../{fixture}/", f"../../{place}")
    assert text == (kept / "run.toml").read_text()

    names = [path.relative_to(kept) for path in sorted(kept.glob("camera?/*.tif"))]
    differing = [
        (tifffile.imread(out / "run" / name) != tifffile.imread(kept / name)).mean()
        for name in names
    ]
    assert len(differing) == 100
    assert np.mean(differing) < 1e-3
