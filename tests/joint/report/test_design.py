"""A design in sentences and tables."""

from scenes.joints import designed, designed_without_motion

from erlif.commands.lines import wrap
from erlif.joint.report import list_materials, summarise_design
from erlif.joint.sizing import read_materials


def test_what_is_wrong_or_not_known_is_named():
    """Limits that are exceeded, doubtful equations, materials without a source."""
    seat = "# Name in the table of materials. Default: none, all values are given here.\n"
    tight = (
        ('interference = "60 um"', 'interference = "0 um"'),
        ('period = "8 s"', 'period = "1 s"'),
        (f'[seat]\n\n{seat}material = "S355"\n', ""),
    )
    for changes, words in (
        ((('# diameter = "80 mm"', 'diameter = "20 mm"'),), ["limits are exceeded; the worst is:"]),
        (
            tight,
            [
                "holds (doubtful)",
                "? doubtful",
                "seat S355 (assumed), housing S355",
                "friction moment",
            ],
        ),
        ((('# diameter = "200 mm"', 'diameter = "20 mm"'),), ["no section left"]),
        ((("CuAl10Ni5Fe4", "CuNi15Sn8 hardened"),), ["CuNi15Sn8 hardened: all other values"]),
    ):
        text = summarise_design(designed(*changes))
        assert all(word in text for word in words)
        assert "inf " not in text
        assert "-0 um" not in text
    assert "give [motion] half_swing and period" in summarise_design(designed_without_motion())
    lines = wrap(list_materials(read_materials())).splitlines()
    assert max(map(len, lines)) <= 80
    assert sum(not line.startswith(" ") for line in lines) == len(read_materials()) + 1


def test_a_doubtful_row_has_its_mark_in_the_brief_table():
    fast = designed(('period = "8 s"', 'period = "1 s"'))  # 27 mm/s, beyond eq. 5
    for brief in (True, False):
        text = summarise_design(fast, brief=brief)
        (row,) = (line for line in text.splitlines() if line.startswith("seizure"))
        assert " %?" in row or "% ?" in row
        assert "? doubtful: outside of the validity" in text
    assert "doubtful" not in summarise_design(designed(), brief=True)


def test_values_of_the_user_are_named_and_large_margins_have_no_digits():
    text = summarise_design(designed())
    assert "Your own values, not of the table: wear rate of the bushing." in text
    assert "> 1000 %" in text
    own = ('# pv_limit = "1.5 W/mm^2"', 'pv_limit = "1.5 W/mm^2"')
    assert "pv limit of the bushing, wear rate" in summarise_design(designed(own))


def test_what_is_not_valid_stands_below_a_table_of_80_columns():
    text = summarise_design(designed(), brief=True)
    table, _, below = text.partition("Not valid for this joint:\n")
    assert "pressure of a flat arc (Hertz)" in below.splitlines()[2]
    assert "Hertz" not in table
    rows = table[table.index("\nstep ") :].splitlines()
    assert max(map(len, rows)) <= 80
    assert " x " not in table
