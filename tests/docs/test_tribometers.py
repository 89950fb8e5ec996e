"""The examples of docs/tribometers.md: each processes the frames of such a tribometer."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import erlif
from conftest import SMALL, Laboratory
from erlif.rig import simulate

PAGE = Path(__file__).parents[2] / "docs" / "tribometers.md"
EXAMPLES = dict(
    re.findall(
        r"^### (.*?)\n+```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.S | re.M
    )
)
SHARED = EXAMPLES["Pin on disc"].partition("[encoder]")[0]
MOTIONS = {
    "Pin on disc": "rotation",
    "Reciprocating slider": "sinusoidal",
    "A column of the speed": "rotation",
    "Static film": "static",
}


def test_every_example_is_tried():
    assert set(EXAMPLES) == set(MOTIONS)


@pytest.mark.parametrize("name", MOTIONS)
def test_example_processes_a_run(small_rig, tmp_path, name):
    rig = replace(SMALL, mechanism=MOTIONS[name], pictures=3, fixture_frames=1)
    lab = Laboratory(simulate(tmp_path / "lab", seed=21, rig=rig))
    shutil.copy(small_rig.fixture / "calibration.nc", lab.fixture)
    text = SHARED + EXAMPLES[name].removeprefix(SHARED)
    text = text.replace('"60 um"', '"150 um"')  # the small picture has larger pixels
    (lab.run / "run.toml").write_text(text, encoding="utf-8")
    log = lab.run / "encoder.csv"
    if name == "A column of the speed":
        rows = [f"{k},{speed}" for k, speed in enumerate((100, 200, 300))]
        log.write_text("frame,Speed [mm/s]\n" + "\n".join(rows) + "\n", encoding="utf-8")

    film = erlif.process(lab.run)
    assert np.isfinite(film.film_min).all()
    if name == "Static film":
        assert film.frames_used.values.tolist() == [3]
        assert "sliding_speed" not in film
    elif name == "A column of the speed":
        np.testing.assert_allclose(film.sliding_speed, [0.1, 0.2, 0.3])
    else:
        assert film.sizes["trigger"] == 3
        assert "sliding_speed" in film
