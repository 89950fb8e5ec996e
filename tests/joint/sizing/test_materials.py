"""The table of materials and what a user adds to it."""

import csv
from pathlib import Path

import pytest

from erlif.core.errors import ConfigError
from erlif.joint import sizing
from erlif.joint.sizing import read_materials
from erlif.joint.sizing.materials import USES

WORDS = ("name", "use", "source")  # columns without a value


def table(tmp_path, text):
    path = tmp_path / "materials.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_hardness_ranges_are_those_of_the_guide():
    """Strand (2005), section 2.2.2; Vickers as 0.95 HB."""
    materials = read_materials()
    ranges = {name: (one.hardness_low, one.hardness_high) for name, one in materials.items()}
    assert ranges["CuSn10Zn2"] == (90, 130)  # tin bronze
    assert ranges["CuAl10Ni5Fe4"] == (140, 230)  # aluminium bronze
    assert ranges["CuZn25Al5Mn4Fe3"] == (190, 230)  # manganese brass
    assert ranges["CuNi15Sn8 hardened"] == pytest.approx((0.95 * 275, 0.95 * 375), abs=0.5)
    assert ranges["steel case-hardened"] == (0.95 * 600, 0.95 * 800)
    assert ranges["42CrMo4 chromium-plated"] == (0.95 * 900, 0.95 * 900)


def test_every_material_has_a_source_and_a_use():
    for one in read_materials().values():
        assert len(one.source) > 20
        assert one.use in USES
        assert one.youngs_modulus is not None or "not stated by a source at hand" in one.source
        assert "usual" not in one.source


def test_the_page_states_how_many_values_are_assumptions():
    """One value of each marked material, and of one alloy all but the two of its hardness."""
    path = Path(sizing.__file__).with_name("materials.csv")
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    values = {
        row["name"]: sum(bool(text) for key, text in row.items() if key not in WORDS)
        for row in rows
    }
    marked = {row["name"]: row["source"] for row in rows if row["source"].endswith("assumption")}
    count = sum(
        values[name] - 2 if "all other values: assumption" in source else 1
        for name, source in marked.items()
    )
    assert not any("assumption;" in row["source"] for row in rows)
    stated = f"{count} of {sum(values.values())} in {len(marked)} materials"
    page = Path(__file__).parents[3] / "docs" / "design.md"
    assert stated in page.read_text(encoding="utf-8")


def test_limits_of_pv_are_those_of_the_suppliers():
    """Diversified Bronze: 75 000, 125 000 and 150 000 psi fpm for C93200, C95400 and C86300."""
    materials = read_materials()
    unit = 6894.757 * 0.3048 / 60  # psi fpm in W/m2
    named = ("C93200 (SAE 660)", "C95400", "CuZn25Al5Mn4Fe3")
    limits = [materials[name].pv for name in named]
    assert limits == pytest.approx([75e3 * unit, 125e3 * unit, 150e3 * unit], rel=5e-3)
    speeds = [materials[name].speed for name in named[:2]]
    assert speeds == pytest.approx([750 * 0.3048 / 60, 225 * 0.3048 / 60], rel=5e-3)


def test_hardness_follows_from_the_strength_where_it_is_not_known(tmp_path):
    """Eq. 13: 0.3 x 800 = 240 kgf/mm2."""
    path = table(tmp_path, "name,ultimate_MPa\nX,800\n")
    assert read_materials(path)["X"].hardness == pytest.approx(240 * 9.80665e6)


def test_a_table_of_the_user_changes_and_adds(tmp_path):
    path = table(
        tmp_path,
        "name,use,yield_MPa,wear_mm3/(N m),source\n"
        'S355,,345,,"own test, 20 mm"\nmine,pin,500,2e-9,own\n',
    )
    materials = read_materials(path)
    assert materials["S355"].yield_stress == 345e6
    assert materials["S355"].ultimate_stress == 470e6  # kept
    assert materials["S355"].source == "own test, 20 mm"
    assert materials["mine"].wear == pytest.approx(2e-18)
    assert read_materials()["S355"].yield_stress == 335e6  # the own table is unchanged
    assert list(materials)[-1] == "mine"


@pytest.mark.parametrize(
    ("text", "named"),
    [
        (None, "cannot be read"),
        (b"\xff\xfe\x00name", "Expected a table of materials"),
        (b"", "an empty file"),
        (b"material,yield_MPa\nX,3\n", "'material'"),
        (b"name,yield_MPa,yield_MPa\nX,3,4\n", "each once"),
        (b"name,yield_MPa\nX,hard\n", "yield_MPa in row 2.*'hard'"),
        (b"name,yield_MPa\nX,-3\n", "from 0.1 to 10000"),
        (b"name,yield_MPa\nX,nan\n", "'nan'"),
        (b"name,yield_MPa\nX\n", "row 2"),
        (b"name,yield_MPa\n,3\n", "name of a material in row 2"),
        (b"name,use\nX,shoe\n", "pin, bushing, structure"),
        (b"name,hardness_low_HB,hardness_high_HB\nX,200,100\n", "hardness_high_HB"),
    ],
)
def test_a_table_that_cannot_be_used_is_refused(tmp_path, text, named):
    path = tmp_path / "materials.csv"
    if text is not None:
        path.write_bytes(text)
    with pytest.raises(ConfigError, match=named):
        read_materials(path)
