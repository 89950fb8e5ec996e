"""A plan in sentences, tables and files."""

import csv
import io
import re
import tomllib

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import OutputError
from erlif.io.settings import PlanSettings, read_plan_settings
from erlif.planning.plan import example_plan, plan
from erlif.show.plots import example_plan_results
from erlif.show.plots.style import new_figure
from erlif.show.report import check_plan_output, summarise_plan, write_plan
from erlif.show.report.plan import table_of_films, table_of_tolerances


def planned_with(*changes):
    text = example_plan()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return plan(PlanSettings.model_validate(tomllib.loads(text)))


@pytest.fixture(scope="module")
def planned():
    return example_plan_results()


def test_summary_states_range_frames_optimum_and_tolerances(planned):
    text = summarise_plan(planned)
    assert "optically thick (Farzaneh 2002)" in text
    assert "The spectra are invented" in text
    assert "The light is taken as even" in text
    assert "One pixel of one frame is measurable from 0.8" in text
    assert "5 % of the film over the whole range needs 20 frame pairs" in text
    assert "Best concentrations: 0.00517 and 0.0476 mol/L" in text
    assert text.index("gain of camera 1") < text.index("full well")


def test_light_that_falls_off_is_stated():
    text = summarise_plan(planned_with(("# corner = 1.0", "corner = 0.43")))
    assert "whose corners have 43% of the light in its middle" in text


def test_a_plan_beyond_its_range_is_reported():
    text = summarise_plan(
        planned_with(
            ('thinnest = "2 um"', 'thinnest = "0.2 um"'),
            ('thickest = "10 um"', 'thickest = "15 um"'),
            ("# frames = 1", "frames = 4"),
            ("# uncertainty = 0.05", "uncertainty = 0.001"),
            ('"11000 electron"', '"30000 electron"'),
            ("# beam_diameter", "beam_diameter"),
            ("# fill = 0.75", "fill = 0.1"),
        )
    )
    for words in (
        "The wanted range, 0.2 to 15 um, is not covered by single pixels.",
        "cannot be reached over the whole range: a camera saturates.",
        "Camera 1 saturates",
        "With 4 frames it is measurable",
        "the dyes saturate at about 1.1 mJ/cm2",
    ):
        assert words in text
    assert re.search(r"They need \d\d\.\d% of the pulse energy, or a camera would saturate", text)

    # where nothing can be measured
    thick = (
        ('thickest = "10 um"', 'thickest = "10 mm"'),
        ('thickest = "18 um"', 'thickest = "20 mm"'),
    )
    text = summarise_plan(planned_with(*thick, ('"0.024 mol/L"', '"0.003 mol/L"')))
    assert "nan" not in text
    assert "not optically thick" in text
    assert "No concentrations give a film over the whole wanted range" in text
    assert "Best concentrations" not in text


def test_frames_are_given_for_the_best_concentrations_too(planned):
    """The best concentrations need fewer frames over the whole range, film by film as computed."""
    text = summarise_plan(planned)
    head, *rows = (line for line in text.splitlines() if re.match(r" *(film um|\d)", line))
    assert head.split()[-2:] == ["needed", "best"]
    assert max(map(len, (head, *rows))) <= 80
    films = np.array([float(row.split()[0]) for row in rows])
    best = [int(row.split()[-1]) for row in rows]
    assert len(films) == 7
    known = planned.optimum_frames_needed.sel(thickness=films, method="nearest")
    npt.assert_allclose(best, known, atol=1)
    assert max(best) < max(int(row.split()[-2]) for row in rows)
    table = list(csv.DictReader(io.StringIO(table_of_films(planned))))
    for column, values in (
        ("optimum_frames_needed [1]", planned.optimum_frames_needed),
        ("std [um]", planned.thickness_std),
        ("signal_camera2 [electron]", planned.signal.sel(camera=2)),
    ):
        npt.assert_allclose([float(row[column]) for row in table], values, rtol=1e-5)
    table = list(csv.DictReader(io.StringIO(table_of_tolerances(planned))))
    assert [row["tolerance"] for row in table] == list(planned.tolerance.values)
    errors = [float(row["film_error [1]"]) for row in table]
    npt.assert_allclose(errors, planned.tolerance_film, rtol=1e-3)


def test_files_are_complete_and_read_back(planned, tmp_path, monkeypatch):
    # tests/show/plots looks at the figure, and the command writes it
    monkeypatch.setattr(
        "erlif.show.plots.plan_figure", lambda _: new_figure(1.0, 1.0).subplots().figure
    )
    output = tmp_path / "plan"
    paths = write_plan(planned, output)
    assert {path.name for path in output.iterdir()} == {path.name for path in paths}
    assert read_plan_settings(output / "plan.toml").name == "example rig"
    best = read_plan_settings(output / "optimum.toml")
    npt.assert_allclose(
        [best.dye1.concentration, best.dye2.concentration], planned.optimum_concentration, rtol=5e-3
    )

    # an earlier plan is replaced on request alone
    with pytest.raises(OutputError, match="exists already"):
        write_plan(planned, output)
    check_plan_output(output, overwrite=True)
    assert not list(tmp_path.glob(".*"))


def test_nothing_else_is_ever_replaced(tmp_path):
    source = tmp_path / "plan.toml"
    for text, message in (
        ('[plan]\nname = "mine"\n', r"other than that of plan\.toml"),
        ("# my remarks", "it is something else"),
    ):
        source.write_text(text)
        with pytest.raises(OutputError, match=message):
            check_plan_output(tmp_path, overwrite=True, source=source)
    check_plan_output(tmp_path / "new", overwrite=False, source=source)
