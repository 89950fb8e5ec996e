"""Damaged encoder logs and profiles."""

from damages.bench import TEXTS, Damage


def _rows(path, change):
    """A table after a change of its rows."""

    def damage(bench):
        content = change((bench.directory / path).read_text().splitlines())
        content = content if isinstance(content, bytes) else "\n".join(content) + "\n"
        bench.write(bench.directory / path, content)

    return damage


def _log(name, change, *words):
    return Damage(f"log: {name}", _rows("run/encoder.csv", change), "process run", words)


def _cell(row, column, value):
    def change(rows):
        cells = rows[row - 1].split(",")
        cells[rows[0].split(",").index(column)] = value
        return [*rows[: row - 1], ",".join(cells), *rows[row:]]

    return change


def _header(old, new):
    return lambda rows: [rows[0].replace(old, new), *rows[1:]]


def _column(column, change):
    def damage(rows):
        place = rows[0].split(",").index(column)
        out = [rows[0]]
        for k, row in enumerate(rows[1:]):
            cells = row.split(",")
            cells[place] = change(k, cells[place])
            out.append(",".join(cells))
        return out

    return damage


def _profile(name, change, *words):
    damage = _rows("fixture/profile.csv", change)
    return Damage(f"profile: {name}", damage, "calibrate fixture --overwrite", words)


def _scale(factor):
    def damage(rows):
        cells = [row.split(",") for row in rows[1:]]
        return [rows[0], *(f"{x},{float(t) * factor},{u}" for x, t, u in cells)]

    return damage


def _in_time(name, setting, *words):
    """Three rows without a number of the frame in place of one, and settings of the encoder."""

    def dense(rows):
        cells = [row.split(",")[1:] for row in rows]
        steps = [[f"{float(t) + k * 1e-3:.6f}", *c] for t, *c in cells[1:] for k in range(3)]
        return [",".join(row) for row in (cells[0], *steps)]

    def damage(bench):
        _rows("run/encoder.csv", dense)(bench)
        bench.edit(bench.run / "run.toml", ("[encoder]\n", f"[encoder]\n{setting}\n"))

    return Damage(f"log in time: {name}", damage, "process run", words)


LOGS = [
    *(_in_time(name, *row) for name, row in TEXTS["log_times"].items()),
    *(_log(name, _cell(*row[:3]), *row[3:]) for name, row in TEXTS["log_cells"].items()),
    *(_log(name, _header(*row[:2]), *row[2:]) for name, row in TEXTS["log_headers"].items()),
    _log("header alone", lambda rows: rows[:1], "rows of numbers"),
    _log("one row", lambda rows: rows[:2], "rows"),
    _log("a row missing in the middle", lambda rows: [*rows[:3], *rows[4:]], "missing"),
    _log("a row missing at the end", lambda rows: rows[:-1], "5 rows", "6 frames"),
    _log("a row too many", lambda rows: [*rows, "6" + rows[-1][1:]], "time to rise", "row 8"),
    _log("a row twice", lambda rows: [*rows[:3], *rows[2:]], "repeats frame"),
    _log("rows in reverse", lambda rows: [rows[0], *rows[:0:-1]], "frame"),
    _log("a cell missing", lambda rows: [*rows[:3], "2,0.2,16", *rows[4:]], "row 4"),
    _log("constant angle", _column("angle_deg", lambda k, v: "8.0"), "angle"),
    _log("time backwards", _column("time_s", lambda k, v: f"{1 - 0.1 * k:.3f}"), "time to rise"),
    _log("time stands still", _column("time_s", lambda k, v: "1.0"), "time to rise"),
    _log("a cell too many", lambda rows: [*rows[:3], rows[3] + ",7", *rows[4:]], "6 values"),
    _log("blank row", lambda rows: [*rows[:3], "", *_cell(4, "angle_deg", "x")(rows)[3:]], "row 5"),
    _log("no header", lambda rows: rows[1:], "header"),
    _log("bytes of zero", lambda rows: bytes(4000), "bytes of zero"),
    _log("binary", lambda rows: bytes(range(1, 256)) * 20, "encoder.csv"),
    _log(
        "UTF-16 cut within a character",
        lambda rows: "\n".join(rows).encode("utf-16")[:-1],
        "encoder.csv",
    ),
    _log("decimal commas", lambda rows: [row.replace(".", ",") for row in rows], "decimal"),
    _log("one line of 2 MB", lambda rows: b"frame," * 350_000, "encoder.csv"),
    _log("quote without an end", lambda rows: [rows[0], '"' + rows[1], *rows[2:]], "encoder.csv"),
]

PROFILES = [
    *(
        _profile(name, lambda rows, row=row: [*rows[:4], row, *rows[5:]], *words)
        for name, (row, *words) in TEXTS["profile_rows"].items()
    ),
    _profile("header alone", lambda rows: rows[:1], "rows found: 1"),
    _profile("too short", lambda rows: rows[:7], "at least 8 points"),
    _profile("other header", lambda rows: ["a,b,c", *rows[1:]], "x_mm,"),
    _profile("no header", lambda rows: rows[1:], "x_mm,thickness_um"),
    _profile("bars", lambda rows: [row.replace(",", "|") for row in rows], "rows of numbers in"),
    _profile("decimal commas", lambda rows: [rows[0], *('0,1,"0,2",0,1',) * 9], "row 2"),
    _profile("all at one place", lambda rows: [rows[0], *("1,2,0.1",) * 20], "x_mm to change"),
    _profile("of one thickness", lambda rows: [rows[0], *_flat(rows)], "thick at all points"),
    _profile(
        "elsewhere",
        lambda rows: [rows[0], *(f"{500 + n},{n},0.1" for n in range(50))],
        "points of the profile in the image",
    ),
    _profile("Latin-1", lambda rows: "x_mm,thickness_µm\n1,2".encode("latin-1"), "8 points"),
    _profile("binary", lambda rows: bytes(range(256)), "profile.csv"),
    _profile("cell of 200,000 digits", lambda rows: [*rows, "1" * 200_000 + ",1,1"], "profile.csv"),
    _profile("thickness in mm for um", _scale(1e-3), "film"),
    _profile("thickness in nm for um", _scale(1e3), "numbers in nm"),
    _profile("upside down", _scale(-1.0), "thickness"),
]


def _flat(rows):
    return [f"{row.split(',')[0]},5.0,0.1" for row in rows[1:]]
