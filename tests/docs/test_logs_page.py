"""The examples of the page on logs are read as the page states."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from erlif.io.ingest.encoder_log import read_log
from erlif.io.ingest.recording import choose_columns
from erlif.io.settings import EncoderSettings

PAGE = (Path(__file__).parents[2] / "docs" / "logs.md").read_text(encoding="utf-8")
TABLES = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.S)


@pytest.mark.parametrize("text", TABLES, ids=range(len(TABLES)))
def test_every_table_is_accepted(text):
    EncoderSettings.model_validate(tomllib.loads(text)["encoder"])


def test_the_log_of_the_page_is_read_with_its_settings(tmp_path):
    (text,) = re.findall(r"```text\n(# rig.*?)```", PAGE, flags=re.S)
    (tmp_path / "rig.txt").write_text(text, encoding="latin-1")
    settings = EncoderSettings.model_validate(tomllib.loads(TABLES[0])["encoder"])
    log, notes = read_log(tmp_path / settings.file, choose_columns(settings), frames=3)
    np.testing.assert_allclose(log.angle, [12.5, 13.46, 14.42])
    np.testing.assert_allclose(log.time, [0, 0.017, 0.034])
    np.testing.assert_allclose(log["joint_load"], np.array([50.1, 50, 49.9]) * 4.4482216152605)
    np.testing.assert_allclose(log.temperature, [24.8, 24.8, 24.9])
    assert log.note.values.tolist() == ["start", "", ""]
    assert "time from column 'Time'" in str(notes[0])
