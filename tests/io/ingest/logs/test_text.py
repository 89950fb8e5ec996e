"""Text files as loggers write them, and what is no table."""

import tomllib
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.text import read_text_table

FORMS = tomllib.loads(Path(__file__).with_name("forms.toml").read_text("utf-8"))["forms"]
NUMBERS = {"time": [0.0, 0.1, 0.2], "angle": [1.5, -2.25, 3.0]}


def read(tmp_path, content, wanted=("angle",)):
    path = tmp_path / "log.txt"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_text_table(path, wanted)


def numbers(table):
    return {column.name: column.values.tolist() for column in table.columns}


@pytest.mark.parametrize("text", FORMS)
@pytest.mark.parametrize("wanted", [("angle",), ()])
def test_every_usual_form_gives_the_same_numbers(tmp_path, text, wanted):
    found = numbers(read(tmp_path, text, wanted))
    found.pop("", None)
    assert found == NUMBERS


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_encodings_of_windows_and_of_old_loggers_are_read(tmp_path, encoding):
    text = "Zeit [s];Öl [°C]\n0,5;20,25\n1,5;21\n"
    table = read(tmp_path, text.encode(encoding), ("Öl [°C]",))
    assert numbers(table) == {"Zeit [s]": [0.5, 1.5], "Öl [°C]": [20.25, 21]}
    assert [column.unit for column in table.columns] == ["s", "°C"]
    spoken = {"utf-16": "text in UTF-16", "latin-1": "text in Latin-1"}.get(encoding)
    assert "decimal commas" in table.remarks
    assert "columns separated by semicolons" in table.remarks
    assert spoken is None or spoken in table.remarks


@pytest.mark.parametrize("bracket", ["[{}]", "({})", "（{}）"])
def test_headers_in_chinese_are_read_as_old_windows_programs_write_them(tmp_path, bracket):
    time, angle, oil = (
        name + bracket.format(unit)
        for name, unit in (("时间", "s"), ("编码器角度", "度"), ("油温", "℃"))
    )
    table = read(tmp_path, f"{time},{angle},{oil}\n0.5,20,25\n1.5,21,26\n".encode("gbk"), ())
    assert numbers(table) == {time: [0.5, 1.5], angle: [20, 21], oil: [25, 26]}
    assert [column.unit for column in table.columns] == ["s", "度", "℃"]
    assert "text in GBK" in table.remarks


@pytest.mark.parametrize("name", ["Größe [°C]", "Füße [µm]", "Öl [°]", "Température", "Ångström²"])
def test_letters_of_western_europe_are_no_chinese(tmp_path, name):
    assert name in numbers(read(tmp_path, f"angle,{name}\n1,2\n3,4\n".encode("latin-1")))


@pytest.mark.parametrize(
    "again",
    [
        "t,angle\ns,deg\n",
        "t,angle\n",
        "\nRig 3\nStep 2\nt,angle\ns,deg\n",
        "# step 2\nt,angle\n",
    ],
)
def test_a_header_may_come_again_above_each_block(tmp_path, again):
    table = read(tmp_path, f"t,angle\ns,deg\n0,1\n1,2\n{again}2,3\n3,4\n")
    assert numbers(table) == {"t": [0, 1, 2, 3], "angle": [1, 2, 3, 4]}
    assert list(table.rows)[2:] == [5 + again.count("\n"), 6 + again.count("\n")]


@pytest.mark.parametrize("between", ["Rig 3\n", "2\n", "t;angle\n"])
def test_a_short_row_without_a_header_below_it_is_refused(tmp_path, between):
    with pytest.raises(EncoderError, match="Expected 2 values in row 4"):
        read(tmp_path, f"t,angle\n0,1\n1,2\n{between}2,3\n")


def test_a_block_of_other_columns_is_no_part_of_the_table(tmp_path):
    assert read(tmp_path, "t,angle\n0,1\n1,2\nangle,t\n3,2\n").columns[0].texts == {2: "angle"}


def test_units_come_from_brackets_and_from_their_own_row(tmp_path):
    table = read(tmp_path, "t,angle,F (kN)\nms,rad,\n0,1,2\n1,2,3\n")
    assert [column.unit for column in table.columns] == ["ms", "rad", "kN"]


def test_rows_keep_the_number_that_a_spreadsheet_shows(tmp_path):
    table = read(tmp_path, "# a\nangle,b\n\n1,2\n# b\n3,x\n")
    assert list(table.rows) == [4, 6]
    assert table.columns[1].texts == {1: "x"}


def test_a_comma_within_quotes_is_no_number_where_commas_separate(tmp_path):
    assert read(tmp_path, 'angle,b\n"1,5","2,5"\n').columns[0].texts == {0: "1,5"}


def test_a_file_of_words_alone_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("erlif.io.ingest.logs.text.MOST_TEXTS", 100)
    with pytest.raises(EncoderError, match="Export the part of the log"):
        read(tmp_path, "angle,b\n" + "x,y\n" * 200)


@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), (";", ","), ("\t", ",")])
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_a_large_file_gives_the_same_table_as_a_small_one(
    tmp_path, monkeypatch, separator, decimal, encoding
):
    rows = [f"{k / 7:.7f}{separator}{-k / 3:.5e}" for k in range(60)]
    text = f"° a\nb{separator}angle\n" + "\n".join(rows).replace(".", decimal) + "\n"
    small = read(tmp_path, text.encode(encoding))
    monkeypatch.setattr("erlif.io.ingest.logs.text.LARGE", 0)
    monkeypatch.setattr("erlif.io.ingest.logs.text._read_rows", None)  # must not be needed
    large = read(tmp_path, text.encode(encoding))
    assert numbers(large) == numbers(small)
    assert list(large.rows) == list(small.rows)
    assert large.remarks == small.remarks


@pytest.mark.parametrize(
    "row", ["1,x", "1,nan", "", "1,2,3", "1", "# pause", "1_0,2", '"1",2', "1,0x10", "1,2,"]
)
def test_a_large_file_with_another_row_is_read_row_by_row(tmp_path, monkeypatch, row):
    text = "time,angle\n0,1\n" + row + "\n1,2\n"

    def outcome():
        try:
            table = read(tmp_path, text)
        except EncoderError as error:
            return str(error)
        cells = [
            (column.values[~np.isnan(column.values)].tolist(), column.texts)
            for column in table.columns
        ]
        return cells, list(table.rows)

    small = outcome()
    monkeypatch.setattr("erlif.io.ingest.logs.text.LARGE", 0)
    assert outcome() == small


def test_a_large_file_takes_little_more_memory_than_its_text_and_numbers(tmp_path):
    """Python keeps a text that is read like a file in four bytes for each character."""
    path = tmp_path / "log.csv"
    row = b"0.123456789012345678901234567890\n"
    path.write_bytes(b"time_s,angle_deg\n" + (row[:-1] + b"," + row) * 40_000)
    size = path.stat().st_size
    tracemalloc.start()
    table = read_text_table(path, ["angle_deg"])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(table.rows) == 40_000
    assert peak < 3.5 * size


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("angle;b\n1,5;2\n2;2.5\n", r"not both; column angle has commas, row 3, column b"),
        ("time,angle\n0,1\n1\n", r"2 values in row 3 of log.txt.* it has 1\."),
        ("angle,b\n" + "1" * (2**20 + 5), "a line has more than"),
    ],
)
def test_numbers_and_rows_that_are_not_clear_are_refused(tmp_path, text, words):
    with pytest.raises(EncoderError, match=words):
        read(tmp_path, text)
