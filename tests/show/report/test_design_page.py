"""The page of a design: complete, without other files, and the same for the same joint."""

import base64
import csv
import io
import re
import tomllib

import pytest

from erlif.io.settings import DesignSettings
from erlif.joint.sizing.design import design, example_design, example_joint_file
from erlif.show.report import design_page, make_design_page


def unsound():
    text = example_joint_file().replace('# diameter = "80 mm"', 'diameter = "20 mm"')
    text = text.replace('"boom of a loader"', '"<b>boom</b> & arm"')
    return design(DesignSettings.model_validate(tomllib.loads(text)))


@pytest.fixture(scope="module")
def page():
    return make_design_page(example_design())


def saved(page, kind):
    """Content of the file behind a link."""
    found = re.search(rf'href="data:{kind}[^"]*;base64,([^"]*)"', page)
    return base64.b64decode(found[1]).decode()


@pytest.fixture(scope="module")
def unsound_page():
    """Without its figures, which take a second."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(design_page, "_figures", lambda design: [])
        return make_design_page(unsound())


def test_tags_are_closed_and_nothing_is_loaded(page, unsound_page, read_page):
    for text in (page, unsound_page):
        assert read_page(text).open == []
        assert not re.findall(r'(?:src|href)="(?!data:|#)', text)
    assert len(page) < 1_000_000


def test_all_steps_have_a_row_and_a_reason(page):
    for step in example_design().assessment.steps:
        assert step.title in page
        assert step.missing or f'id="step-{step.key}"' in page


def test_the_saved_table_has_the_steps_with_their_margins(page):
    rows = list(csv.DictReader(io.StringIO(saved(page, "text/csv"))))
    steps = example_design().assessment.steps
    assert [row["step"] for row in rows] == [step.key for step in steps]
    assert float(rows[0]["margin"]) == pytest.approx(steps[0].margin, rel=1e-8)

    # the saved joint can be designed again
    again = design(DesignSettings.model_validate(tomllib.loads(saved(page, "application/toml"))))
    assert again.assessment.weakest.key == example_design().assessment.weakest.key


def test_an_unsound_joint_is_reported_and_names_are_escaped(unsound_page):
    page = unsound_page
    assert "<h1>&lt;b&gt;boom&lt;/b&gt; &amp; arm</h1>" in page
    assert "limits are exceeded" in page
    assert '<details id="step-pin_bending" open>' in page
