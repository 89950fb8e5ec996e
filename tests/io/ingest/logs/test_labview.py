"""LabVIEW measurement files, laid out after the specification of the format (NI, 2014)."""

import numpy as np
import pytest

from erlif.core.errors import EncoderError
from erlif.io.ingest.encoder_log import read_log
from erlif.io.ingest.logs.columns import ColumnChoice
from erlif.io.ingest.logs.proposal import propose_log
from erlif.io.ingest.logs.text import read_log_table

TIME = np.arange(6) * 0.25 + 0.5
ANGLE = np.array([1.5, 2.25, 3.0, 4.75, 5.5, 6.25])
FORCE = np.array([222.0, 221.5, 220.25, 219.0, 218.5, 217.75])


def write_lvm(path, *, sep="\t", dec=".", x="One", comment=True, parts=1, special=False):
    """A file with two channels; `x` is X_Columns, `parts` the number of headers of channels."""
    name = {"\t": "Tab", ",": "Comma"}[sep]

    def row(*cells):
        return sep.join(str(cell) for cell in cells)

    def number(value):
        return f"{value:.6f}".replace(".", dec)

    lines = ["LabVIEW Measurement" + sep, row("Writer_Version", 2), row("Separator", name)]
    lines += [row("Decimal_Separator", dec), row("Multi_Headings", "Yes"), row("X_Columns", x)]
    lines += [row("Time_Pref", "Relative"), row("Date", "2026/03/04"), "***End_of_Header***" + sep]
    for part in range(parts):
        chosen = np.array_split(np.arange(TIME.size), parts)[part]
        gap = [""] if x == "Multi" else []

        def pair(key, one, two, gap=gap):
            return row(key, one, *gap, two, "")

        lines += [sep, pair("Channels", 2, ""), pair("Samples", 6, 6), pair("Date", "2026", "2026")]
        lines += [pair("Y_Unit_Label", "deg", "N"), pair("X_Dimension", "Time", "Time")]
        first, step = number(TIME[chosen[0]]), number(0.25)
        lines += [pair("X0", first, first), pair("Delta_X", step, step)]
        if special:
            lines += ["***Start_Special***", row("Gain", 3, 4), "***End_Special***"]
        lines += ["***End_of_Header***" + sep]
        second = ["X_Value"] if x == "Multi" else []
        lines += [row("X_Value", "Encoder", *second, "Force", "Comment")]
        for k in chosen:
            time = "" if x == "No" else number(TIME[k])
            again = [time] if x == "Multi" else []
            note = ["start"] if comment and k == 0 else []
            lines.append(row(time, number(ANGLE[k]), *again, number(FORCE[k]), *note))
    path.write_text("\r\n".join(lines) + "\r\n", newline="")
    return path


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"dec": ","},
        {"comment": False},
        {"sep": ","},
        {"x": "Multi"},
        {"x": "No"},
        {"x": "No", "dec": ","},
        {"parts": 3},
        {"parts": 2, "x": "No"},
        {"special": True, "sep": ","},
    ],
    ids=str,
)
def test_channels_have_their_numbers_names_and_units(tmp_path, options):
    table = read_log_table(write_lvm(tmp_path / "a.lvm", **options), ["Encoder"])
    assert table.names == ["X_Value [s]", "Encoder [deg]", "Force [N]"]
    assert [column.unit for column in table.columns] == ["s", "deg", "N"]
    for column, values in zip(table.columns, (TIME, ANGLE, FORCE), strict=True):
        np.testing.assert_allclose(column.values, values)


def test_rows_keep_their_numbers(tmp_path):
    path = write_lvm(tmp_path / "a.lvm", parts=2)
    lines = path.read_text().splitlines()
    table = read_log_table(path, [])
    for row, angle in zip(table.rows, ANGLE, strict=True):
        assert f"{angle:.6f}" in lines[row - 1]


def test_init_sees_the_log(tmp_path):
    found = propose_log([write_lvm(tmp_path / "a.lvm")], 6)
    assert found.columns == {"angle": "Encoder [deg]", "time": "X_Value [s]", "load": "Force [N]"}


def test_a_log_in_time_needs_no_settings(tmp_path):
    log, _ = read_log(write_lvm(tmp_path / "a.lvm", x="No"), ColumnChoice(), frames=2)
    np.testing.assert_allclose(log.samples["time"], TIME)
    np.testing.assert_allclose(log.samples["angle"], ANGLE)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("X_Value\t", "X\t", "Expected a header .*rows found: 0"),
        ("0.750000\t", "0.75x\t", "row 21, column X_Value"),
        ("0.750000\t2.250000\t0.750000", "0.750000\t2.250000\t0.8", "times of their own"),
    ],
)
def test_damaged_files_are_refused(tmp_path, old, new, words):
    path = write_lvm(tmp_path / "a.lvm", x="Multi" if old.count("\t") > 1 else "One")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(EncoderError, match=words):
        read_log(path, ColumnChoice({"time": "X_Value", "angle": "Encoder"}), frames=6)


def test_parts_of_other_channels_are_refused(tmp_path):
    path = write_lvm(tmp_path / "a.lvm", parts=2)
    head, tail = path.read_text().rsplit("X_Value\tEncoder\tForce", 1)
    path.write_text(f"{head}X_Value\tForce\tEncoder{tail}")
    with pytest.raises(EncoderError, match=r"row 32, column X_Value .s. .*got 'X_Value"):
        read_log(path, ColumnChoice({"time": "X_Value", "angle": "Encoder"}), frames=6)
