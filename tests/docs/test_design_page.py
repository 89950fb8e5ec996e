"""The two designs by hand: each number follows from its expression, and erlif has it too."""

import math
import re
from functools import cache
from pathlib import Path

import pytest

import erlif
from erlif.joint.settings import read_design_settings
from erlif.joint.settings.design import SizingOptions

DOCS = Path(__file__).parents[2] / "docs"
ROW = re.compile(r"^\| (.+?) \| `(.+?)` \| ([0-9.]+) \| (.*?) ?\|$", re.MULTILINE)
SIGNS = {
    "·": "*", "²": "**2", "³": "**3", "⁴": "**4", "^": "**", "√": "sqrt", "π": "pi", "−": "-",
    "ln(": "log(",
}  # fmt: skip
KNOWN = {name: getattr(math, name) for name in ("sqrt", "pi", "log", "asinh", "atan")}


def evaluate(text):
    for sign, code in SIGNS.items():
        text = text.replace(sign, code)
    return eval(text, {"__builtins__": {}}, KNOWN)


@cache
def designed(name):
    return erlif.joint.design(DOCS / "examples" / f"{name}.toml")


@cache
def tables():
    page = (DOCS / "design.md").read_text(encoding="utf-8")
    start = page.index("### A joint whose dimensions are given")
    further = Path(__file__).with_name("bucket_link_by_hand.md").read_text(encoding="utf-8")
    return {"boom": ROW.findall(page[:start]), "bucket_link": ROW.findall(page[start:] + further)}


@pytest.mark.parametrize("name", ["boom", "bucket_link"])
def test_the_numbers_of_the_page(name):
    assessment = designed(name).assessment
    rows = tables()[name]
    assert len(rows) > 30
    for step, expression, printed, where in rows:
        value, digits = evaluate(expression), len(printed.partition(".")[2])
        assert abs(value - float(printed)) <= 0.51 * 10**-digits, step
        if where:
            key, _, number = where.partition(": ")
            found = assessment.step(key).number(number) if number else assessment.step(key).present
            assert found == pytest.approx(value, rel=1e-3), step


def test_the_eyes_of_the_table_are_those_of_the_boom():
    page = (DOCS / "design.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \| [\d.]+ \|$", page, re.M)
    assert len(rows) == 4
    settings = read_design_settings(DOCS / "examples" / "boom.toml")
    for ratio, *printed in rows:
        wanted = SizingOptions(series="none", eye_ratio=float(ratio))
        joint = erlif.joint.design(settings.model_copy(update={"sizing": wanted})).joint
        sizes = (joint.pin_diameter, joint.bushing_width, joint.housing_diameter)
        assert [1e3 * size for size in sizes] == pytest.approx(list(map(float, printed)), abs=6e-3)
        # eq. 14 with the allowed stress of 167.5 MPa at that eye
        bore, eye, width = joint.pin_diameter + 2 * joint.wall, sizes[2], sizes[1]
        stress = 150e3 * (eye / bore + bore / eye) / (width * (eye - bore))
        assert stress <= 167.5e6 * (1 + 1e-6)


def test_all_steps_with_a_limit_are_on_the_page():
    for name, rows in tables().items():
        named = {where.partition(":")[0] for *_, where in rows}
        limits = {step.key for step in designed(name).assessment.limits} - {"lateral_force"}
        assert limits <= named


def test_what_the_page_states_of_both():
    boom = designed("boom")
    assert boom.sound
    assert boom.assessment.weakest.key == "housing_eye"
    link = designed("bucket_link")
    assert {step.key for step in link.assessment.failed} == {"weld", "prong"}
    assert [step.key for step in link.assessment.doubtful] == ["seizure"]
    assert [step.key for step in link.assessment.unusual] == ["housing_ratio"]


def test_the_changes_that_the_page_proposes_are_enough(tmp_path):
    text = (DOCS / "examples" / "bucket_link.toml").read_text(encoding="utf-8")
    text = text.replace('height = "85 mm"', 'height = "100 mm"')
    path = tmp_path / "joint.toml"
    path.write_text(text.replace('throat = "9 mm"', 'throat = "11 mm"'), encoding="utf-8")
    assert erlif.joint.design(path).sound
