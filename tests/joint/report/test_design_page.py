"""The page of a design: complete, without other files, and the same for the same joint."""

import base64
import re
import tomllib

import pytest
from scenes.joints import designed

from erlif.joint.report import design_page, make_design_page
from erlif.joint.report.design import NUMBERS
from erlif.joint.settings import DesignSettings
from erlif.joint.sizing.design import design, example_design


@pytest.fixture(scope="module")
def page():
    return make_design_page(example_design())


@pytest.fixture(scope="module")
def unsound_page():
    """Without its figures, which take a second."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(design_page, "_figures", lambda design: [])
        thin = ('# diameter = "80 mm"', 'diameter = "20 mm"')
        named = ('"boom of a loader"', '"<b>boom</b> & arm"')
        return make_design_page(designed(thin, named))


def test_tags_are_closed_and_nothing_is_loaded(page, unsound_page, read_page):
    for text in (page, unsound_page):
        assert read_page(text).open == []
        assert not re.findall(r'(?:src|href)="(?!data:|#)', text)
    assert len(page) < 1_000_000


def test_all_steps_have_a_row_and_a_reason(page):
    for step in example_design().assessment.steps:
        assert step.title in page
        assert step.missing or f'id="step-{step.key}"' in page


def test_the_saved_table_has_the_steps_with_their_margins(page, read_page):
    _, rows = read_page(page).saved()
    steps = example_design().assessment.steps
    assert [row["step"] for row in rows] == [step.key for step in steps]
    assert float(rows[0]["margin"]) == pytest.approx(steps[0].margin, rel=1e-8)

    # the saved joint can be designed again
    (content,) = re.findall(r'href="data:application/toml[^"]*;base64,([^"]*)"', page)
    joint = tomllib.loads(base64.b64decode(content).decode())
    again = design(DesignSettings.model_validate(joint))
    assert again.assessment.weakest.key == example_design().assessment.weakest.key


def test_the_page_lists_every_input_and_states_what_safety_leaves_out(page):
    titles = [number["title"] for number in NUMBERS.values() if "title" in number]
    assert len(titles) == 16
    assert all(f'<th scope="row">{title}</th>' in page for title in titles)
    assert "5e-08 mm³/(N m), your own" in page
    assert "Half swing</th><td>25°</td>" in page
    assert "two exceptions: the press fit" in page


def test_an_unsound_joint_is_reported_and_names_are_escaped(unsound_page):
    page = unsound_page
    assert "<h1>&lt;b&gt;boom&lt;/b&gt; &amp; arm</h1>" in page
    assert "limits are exceeded" in page
    assert '<details id="step-pin_bending" class="printed" open>' in page
