"""Every block of every page is run, parsed, read as settings, or held by a test that is named.

Pages are the readme and docs/; blocks of Sphinx, and the page of commands, which is generated, are
left out.
"""

import re
import shlex
import shutil
import tomllib
from pathlib import Path
from typing import NamedTuple

import click
import cv2
import matplotlib.pyplot as plt
import pytest
from click.testing import CliRunner
from pydantic import ValidationError
from scenes.checkout import copy_part

import erlif
from erlif.calibration import read_profile
from erlif.commands.main import main
from erlif.core.flags import Flag
from erlif.io.ingest.encoder_log import read_log
from erlif.io.ingest.recording import choose_columns
from erlif.io.ingest.run_table import read_run_table
from erlif.io.settings import EncoderSettings, FixtureSettings, PlanSettings, RunSettings
from erlif.io.settings.bore import read_bore
from erlif.joint.settings.endurance import EnduranceSettings
from erlif.joint.sizing.materials import read_materials
from erlif.planning.plan import example_plan
from erlif.rig.settings import read_rig_settings

TESTS = Path(__file__).parents[1]
ROOT = TESTS.parent
SAMPLE = "data_samples/straight_bushing"
FENCE = re.compile(r"^( *)```([^\n]*)\n(.*?)^\1```", re.DOTALL | re.MULTILINE)


class Block(NamedTuple):
    name: str
    kind: str
    text: str


def find_blocks():
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    return [
        Block(f"{page.name} {k}", (kind.split() or ["sh"])[0], text)
        for page in pages
        if page.name != "commands.md"
        for k, (_, kind, text) in enumerate(FENCE.findall(page.read_text(encoding="utf-8")))
        if not kind.startswith("{")
    ]


BLOCKS = {block.name: block for block in find_blocks()}

# Shown as printed by the sample or by an example, and the command, which is that of the page.
PRINTED = {
    "design.md 1": "design joint.toml",
    "endurance.md 2": "endurance {logs} --settings data_samples/endurance/endurance.toml",
    "fit.md 1": f"predict {SAMPLE} --fit",
    "linkage.md 1": "",  # the block before
    "planning.md 5": "plan bore.toml",
    "prediction.md 1": f"predict {SAMPLE}",
    "your_data.md 7": f"check {SAMPLE}",
}

# Tests that hold a block.
FIRST = "docs/test_printed_blocks.py::test_the_first_commands_of_a_page_print_what_it_shows"
README = "docs/test_printed_blocks.py::test_the_sample_gives_text_and_picture_of_the_readme"
FIGURES = "docs/test_printed_blocks.py::test_code_of_the_page_of_figures_runs"
READER = "docs/test_formats_page.py::test_the_reader_of_the_page_is_found_by_its_entry_point"
NOTEBOOK = "docs/test_notebook_page.py::test_code_of_the_page_runs_as_it_stands"
CARRIED = "prediction/test_comparison.py::test_"
HELD = {
    "README.md 1": README,
    "cite.md 0": "docs/test_cite_page.py::test_every_value_of_the_citation_file_is_on_the_page",
    "compare.md 1": FIRST,
    "compare.md 4": "review/comparison/test_table.py::test_the_text_states_what_makes_one_rig",
    "figures.md 1": FIGURES,
    "figures.md 2": FIGURES,
    "formats.md 2": READER,
    "formats.md 3": READER,
    "friction.md 2": FIRST,
    "limits.md 0": "docs/test_limits_page.py::test_the_list_of_remedies_is_that_of_a_virtual_rig",
    "linkage.md 3": "docs/test_linkage_page.py::test_code_of_the_page_runs",
    "logs.md 0": "docs/test_logs_page.py::test_the_log_of_the_page_is_read_with_its_settings",
    **{f"logs.md {k}": "docs/test_logs_page.py::test_every_table_is_accepted" for k in range(1, 5)},
    "planning.md 1": FIRST,
    "speed.md 1": README,
    "uncertainty.md 0": "review/test_budget.py::test_documented_budget_is_that_of_the_sample",
    "which.md 0": f"{CARRIED}a_film_of_no_model_is_not_named_after_the_best_of_them",
    "which.md 1": f"{CARRIED}steady_film_is_recognised_and_has_any_viscosity",
} | {f"notebook.md {k}": NOTEBOOK for k in range(13)}

# What no command prints.
DRAWN = {"README.md 4": "the stages in a row", "your_data.md 2": "a tree of files"}

# Files that a page shows, with the test below that reads them.
FILES = {
    "design.md 2",
    "formats.md 1",
    "prediction.md 5",
    *(f"your_data.md {k}" for k in (3, 4, 8)),
}

# Not run: they install, need a cluster, containers or a shell, or make the files of a challenge.
OUTSIDE = (
    *("python3 -m venv", "pip ", ".venv/bin/pip ", ".venv/bin/python -m ", "podman "),
    *(".venv/bin/python benchmarks/", "dask ", "_ERLIF_COMPLETE=", "echo "),
)


def of_kind(*kinds):
    return [name for name, one in BLOCKS.items() if one.kind in kinds]


def test_every_block_has_its_check():
    known = ("sh", "toml", "python", "matlab", "text", "bibtex")
    assert {one.kind for one in BLOCKS.values()} <= {*known}
    named = [*PRINTED, *HELD, *DRAWN, *FILES]
    assert not [name for name in of_kind("text", "bibtex") if name not in named]
    assert not [name for name in named if name not in BLOCKS]
    for test in HELD.values():
        path, _, function = test.partition("::")
        assert f"def {function}(" in (TESTS / path).read_text(encoding="utf-8"), test


def commands_of_pages():
    """Commands in blocks, and in the lines of the pages."""
    found = []
    for block in BLOCKS.values():
        if block.kind == "sh":
            lines = re.sub(r"\\\n", " ", block.text).splitlines()
            found += [(block.name, part.strip()) for one in lines for part in one.split("&&")]
    for page in (ROOT / "docs").rglob("*.md"):
        if page.name != "commands.md":
            text = page.read_text(encoding="utf-8")
            found += [(page.name, one) for one in re.findall(r"`(erlif [^`\n]+)`", text)]
    return found


def test_every_command_has_such_options_and_values():
    """Parsed and not run; files need not exist, and a line of text may leave some out."""
    for page, line in commands_of_pages():
        words = shlex.split(line.removeprefix(".venv/bin/"), comments=True)
        if not words or line.startswith(OUTSIDE):
            continue
        assert words[0] == "erlif", (page, line)
        words = words[1 : words.index(">") if ">" in words else None]
        name = next((word for word in words if word[0] != "-"), None)
        context = click.Context(main)
        command = main.get_command(context, name) if name else main
        assert command is not None, (page, line)
        try:
            command.make_context(name, words[words.index(name) + 1 :] if name else words, context)
        except (click.MissingParameter, click.exceptions.Exit, erlif.ErlifError):
            pass
        except click.UsageError as error:
            if "requires an argument" not in error.message:
                pytest.fail(f"{page}: {line}: {error.message}")


def merged(base, table):
    """A table laid over another, tables within as well."""
    both = base | table
    for key, own in table.items():
        if isinstance(own, dict) and isinstance(base.get(key), dict):
            both[key] = merged(base[key], own)
    return both


def test_every_settings_file_is_read(tmp_path):
    """A part of one is read within a whole one of its kind."""
    fixture, run = (tomllib.loads(BLOCKS[f"your_data.md {k}"].text) for k in (5, 6))
    sample = tomllib.loads((ROOT / SAMPLE / "run.toml").read_text(encoding="utf-8"))
    free = {name: table for name, table in run.items() if name not in ("joint", "mechanism")}
    wholes = [
        (RunSettings, merged(run, {"joint": sample["joint"], "oil": sample["oil"]})),
        (RunSettings, free),
        (FixtureSettings, fixture),
        (PlanSettings, tomllib.loads(example_plan())),
        (EnduranceSettings, {}),
    ]
    for name in of_kind("toml"):
        if name in HELD or name in FILES:
            continue
        text, faults = BLOCKS[name].text, []
        (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
        for kind, whole in wholes:
            table = merged(whole, tomllib.loads(text))
            if "vogel" in table.get("oil", {}):
                table["oil"].pop("viscosity", None)
            try:
                kind.model_validate(table)
                break
            except ValidationError as fault:
                faults.append(str(fault))
        else:
            assert name.startswith("simulator"), (name, faults)
            assert read_rig_settings(tmp_path / "rig.toml")


def test_every_shown_file_is_read(tmp_path):
    for name in FILES:
        (tmp_path / name.replace(" ", "_")).write_text(BLOCKS[name].text, encoding="utf-8")
    encoder, profile, table = (tmp_path / f"your_data.md_{k}" for k in (3, 4, 8))
    log, _ = read_log(encoder, choose_columns(EncoderSettings(file="encoder.csv")), frames=2)
    assert log.angle.values.tolist() == [0.0, 0.96]
    assert log.joint_load.values.tolist() == [220.696, 220.448]
    with profile.open("a", encoding="utf-8") as file:  # the page has the first two of eight
        file.writelines(f"{0.1 * k:.1f},{0.1 + 0.034 * k:.3f},0.15\n" for k in range(2, 8))
    assert read_profile(profile).thickness[:2].tolist() == [0.108, 0.142]
    assert [str(one.run_dir.name) for one in read_run_table(table)] == ["monday", "tuesday"]
    assert read_materials(tmp_path / "design.md_2")["our bronze"].youngs_modulus == 115e9
    bore = {"profile": "prediction.md_5"}
    read_bore({"joint": {"bore": bore}}, tmp_path)
    assert bore["points"] == [[-15.0, 0.0], [-4.0, -20.0], [15.0, 0.3]]

    (tmp_path / "a.toml").write_text(BLOCKS["formats.md 1"].text, encoding="utf-8")
    with (tmp_path / "a.raw").open("wb") as file:
        file.truncate(500 * 1280 * 1024 * 3 // 2)  # 12 bits packed; without blocks on the disk
    frames = erlif.readers.open_frames(tmp_path / "a.raw")
    assert (frames.kinds[0].shape, len(frames.kinds)) == ((1024, 1280), 500)
    frames.close()


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    """A folder with the sample and its film, and the files that the pages make first."""
    folder = tmp_path_factory.mktemp("desk")
    for part in (SAMPLE, "data_samples/endurance", "calibration"):
        copy_part(part, folder / part)
    with pytest.MonkeyPatch.context() as at:
        at.chdir(folder)
        erlif.process(SAMPLE, output=f"{SAMPLE}/film.nc").close()
        shutil.copy(f"{SAMPLE}/film.nc", "film.nc")
        for name in ("design", "plan"):
            text = CliRunner().invoke(main, [name, "--example"]).stdout
            Path(f"{ {'design': 'joint'}.get(name, name) }.toml").write_text(text, encoding="utf-8")
        erlif.export("film.nc", "film.csv", to="csv")
        bore = BLOCKS["planning.md 4"].text.split("\n", 1)[1]
        plan = re.sub(r"(?s)(\n\[joint\]\n).*?(\n\[|$)", rf"\1{bore}\2", example_plan())
        Path("bore.toml").write_text(plan, encoding="utf-8")
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("name", PRINTED)
def test_a_page_shows_what_its_command_prints(name, desk, monkeypatch):
    monkeypatch.chdir(desk)
    monkeypatch.setattr(erlif.joint.plots, "write_endurance_figures", lambda *_, **__: [])
    logs = " ".join(sorted(map(str, Path("data_samples/endurance").glob("*.csv"))))
    page, number = name.split()
    line = PRINTED[name].format(logs=logs)
    if not line:
        line = BLOCKS[f"{page} {int(number) - 1}"].text.replace("\\\n", " ").removeprefix("erlif ")
    found = CliRunner().invoke(main, shlex.split(line), catch_exceptions=False)
    assert found.exit_code == 0, found.output
    printed = " ".join(found.stdout.split())
    lines = [one for one in BLOCKS[name].text.splitlines() if one.strip() != "..."]
    assert [one for one in lines if " ".join(one.split()) not in printed] == []


# Pages whose code no other test runs, and how it is made short.
SHORT = {
    "edges.md": ("prepare_joint(", "prepare_joint(smallest_cell=5e-3, largest_cell=0.05, joint=")
}
CODED = sorted({name.split()[0] for name in of_kind("python") if name not in HELD})


@pytest.mark.slow
@pytest.mark.parametrize("page", CODED)
def test_code_of_a_page_runs(page, desk, monkeypatch):
    monkeypatch.chdir(desk)
    film = erlif.open_film("film.nc")
    monkeypatch.setattr(erlif, "process", lambda run, progress: film)  # the readme makes the same
    names = {}
    if page == "registration.md":
        first = (next(Path(SAMPLE, f"camera{k}").glob("*.tif")) for k in (1, 2))
        names = {f"image_{k}": cv2.imread(str(one), -1) - 64.0 for k, one in enumerate(first, 1)}
    try:
        for name in of_kind("python"):
            if name.split()[0] == page and name not in HELD:
                exec(BLOCKS[name].text.replace(*SHORT.get(page, ("", ""))), names)
    finally:
        plt.close("all")
        film.close()


def test_code_for_matlab_reads_what_the_film_has(opened, film):
    text = "".join(BLOCKS[name].text for name in of_kind("matlab"))
    for name in re.findall(r"ncread\(file, '(\w+)'", text):
        assert name in opened, name
    for group, name in re.findall(r"ncread\(file, '/(\w+)/(\w+)'", text):
        with erlif.open_film(film, group=group) as found:
            assert name in found, name
    meanings = re.findall(r"'(\w+)'", re.search(r"meanings = \{(.*?)\}", text, re.DOTALL)[1])
    assert meanings == [flag.name.lower() for flag in Flag]
