"""Logs of NI TDMS, written by npTDMS."""

import hashlib
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.binary import read_binary_table

TIME = np.arange(5) * 0.1
ANGLE = np.array([10.0, 11, 12, 13.5, 14])


def columns(path):
    table = read_binary_table(path)
    return {column.name: (column.unit, column.values.tolist()) for column in table.columns}


def write_tdms(path, *channels):
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(path) as file:
        file.write_segment(
            [nptdms.ChannelObject("run", name, data, props) for name, data, props in channels]
        )


def test_channels_of_tdms_have_their_units(tmp_path):
    path = tmp_path / "log.tdms"
    write_tdms(path, ("Time", TIME, {"unit_string": "s"}), ("Enc", ANGLE, {"unit_string": "deg"}))
    assert columns(path) == {"Time": ("s", TIME.tolist()), "Enc": ("deg", ANGLE.tolist())}


def test_a_waveform_of_tdms_gives_the_times(tmp_path):
    path = tmp_path / "log.tdms"
    wave = {"wf_increment": 0.1, "wf_start_offset": 2.0}
    write_tdms(path, ("Enc [deg]", ANGLE, wave))
    found = columns(path)
    np.testing.assert_allclose(found["time"][1], 2 + TIME)
    assert found["Enc [deg]"] == ("deg", ANGLE.tolist())


def start_later(lead, rate=100.0, size=400):
    """Waveforms of three tasks: what each has measured at the times of its own clock."""
    clock = np.datetime64("2026-03-04T08:00:00")
    time = np.arange(size) / rate
    wave = {"wf_increment": 1 / rate, "wf_start_offset": 0.0, "wf_start_time": clock}
    late = {**wave, "wf_start_time": clock + np.timedelta64(round(1e6 * lead), "us")}
    return (
        ("Enc [deg]", 30 * np.sin(time), wave),
        ("Force [N]", 100 + 10 * (time + lead), late),
        ("Ticks", np.arange(size, dtype=np.int32), wave),
    )


@pytest.mark.parametrize("lead", [0.35, 0.354, -0.2, 1.5])
def test_tasks_that_start_one_after_the_other_have_the_same_time_in_a_row(tmp_path, lead):
    write_tdms(tmp_path / "log.tdms", *start_later(lead))
    table = read_binary_table(tmp_path / "log.tdms")
    found = {column.name: column.values for column in table.columns}
    time = found["time"] + min(lead, 0.0)  # the clock starts with the first task
    assert len(time) == 400 - np.ceil(round(100 * abs(lead), 6))
    np.testing.assert_allclose(found["Enc [deg]"], 30 * np.sin(time), atol=1e-3)
    np.testing.assert_allclose(found["Force [N]"], 100 + 10 * time, atol=1e-9)
    np.testing.assert_allclose(found["Ticks"], 100 * time, atol=0.51)
    assert not (found["Ticks"] % 1).any()
    assert any(f"start {abs(lead):g} s apart" in remark for remark in table.remarks)


def test_tasks_without_a_common_time_are_refused(tmp_path):
    write_tdms(tmp_path / "log.tdms", *start_later(4.0))
    with pytest.raises(EncoderError, match="4 s apart and have no time in common"):
        read_binary_table(tmp_path / "log.tdms")


def test_a_log_of_a_laboratory_is_read_as_by_another_decoder():
    """Analog inputs of NI-DAQmx at 100 Hz; origin and decoder are in samples.toml."""
    pytest.importorskip("nptdms")
    folder = Path(__file__).parents[3] / "samples"
    expected = tomllib.loads((folder / "samples.toml").read_text("utf-8"))["nidaqmx"]
    *channels, time = read_binary_table(folder / "nidaqmx.tdms").columns
    found = {c.name: hashlib.sha256(c.values.astype("<f8").tobytes()).hexdigest() for c in channels}
    assert {name: text[:16] for name, text in found.items()} == expected
    assert {column.unit for column in channels} == {"Volts"}
    np.testing.assert_allclose(time.values, np.arange(3240) / 100, rtol=1e-12)


def test_a_missing_package_is_named_with_the_command_that_installs_it(tmp_path, monkeypatch):
    path = tmp_path / "log.tdms"
    path.write_bytes(b"TDSm" + bytes(24))
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(EncoderError, match=r'pip install "erlif\[logs\]"'):
        read_binary_table(path)


def test_a_truncated_tdms_file_is_refused_and_its_package_prints_nothing(tmp_path, capfd):
    path = tmp_path / "log.tdms"
    write_tdms(path, ("Enc", ANGLE, {}))
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(EncoderError, match=r"log\.tdms to be a TDMS .*less data than expected"):
        read_binary_table(path)
    assert capfd.readouterr() == ("", "")
