"""The catalogue of damages through the command line.

Each ends with one message that holds the words expected and what to do, status 2, and nothing
half-written; none takes 20 s or 1.5 GB.
"""

import re
import resource
import shutil
import time

import pytest
from click.testing import CliRunner
from damages.bench import copy_rig
from damages.frames import FRAMES
from damages.logs import LOGS, PROFILES
from damages.products import CALIBRATIONS, FILMS, OUTPUTS, PLACES, TABLES, USAGE
from damages.settings import SETTINGS
from scenes.film import make_film

from erlif.commands.main import main

pytestmark = pytest.mark.slow

CATALOGUE = [
    *(*SETTINGS, *FRAMES, *LOGS, *PROFILES, *CALIBRATIONS, *FILMS, *OUTPUTS, *USAGE, *TABLES),
    *PLACES,
]

_WORDS = """
    add calibrate call change check choose clean close compare convert copy correct cover
    delete divide draw exchange export give install keep lay leave log lower make measure
    mount move name number open pass photograph pick point press put raise read record reduce
    register reload remove rename repeat replace run save set show start take try use wait
    widen write
"""

STEPS = frozenset(_WORDS.split())
"""Words with which a sentence begins that names the next step."""

LONGEST = 20.0
"""Processor time of one command. [s]"""

LARGEST = 1.5e9
"""Memory of one command beyond what the tests hold. [byte]"""

POINTS_THERE = (
    *("correct these", "Replace each ??", "did you mean", "runs failed", "Usage:"),
    *("must be the shortest link", "dask writes it with"),
)
"""Messages in which the next step stands before or within a list."""


@pytest.fixture(scope="module")
def originals(small_rig, tmp_path_factory):
    """The rig and a film of formulas; never changed by a damage."""
    directory = tmp_path_factory.mktemp("originals")
    for name in ("run", "fixture"):
        shutil.copytree(small_rig.directory / name, directory / name)
    (directory / "films").mkdir()
    shutil.copy(make_film(tmp_path_factory.mktemp("made")), directory / "films" / "film.nc")
    return directory


def listing(directory):
    """All files with what changes when one of them is written or replaced."""
    return {
        str(path.relative_to(directory)): (path.lstat().st_ino, path.lstat().st_mtime_ns)
        for path in directory.rglob("*")
        if path.is_symlink() or not path.is_dir()
    }


@pytest.mark.parametrize("damage", CATALOGUE, ids=lambda damage: damage.name)
def test_a_damage_is_refused_in_one_message(damage, originals, tmp_path, monkeypatch):
    bench = copy_rig(originals, tmp_path)
    damage.change(bench)
    if "a heap without end" in damage.name:  # the library of HDF5 goes round: 1 s in place of 10
        monkeypatch.setattr("erlif.core.guarded.LONGEST", 1.0)
    before, kept = listing(tmp_path), listing(originals)
    monkeypatch.chdir(tmp_path)

    start = time.process_time()
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    result = CliRunner().invoke(main, damage.command.split())
    assert time.process_time() - start < LONGEST
    assert 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory) < LARGEST

    assert result.exit_code == 2, result.output
    assert "Traceback" not in result.output
    usage = damage.name.startswith(("usage", "budget")) and "Usage:" in result.stderr
    assert usage or result.stderr.count("erlif: ") == 1
    for words in damage.words:
        assert words in result.stderr
    assert listing(tmp_path) == before
    assert listing(originals) == kept

    # the last sentences hold the next step
    message = result.stderr.partition("erlif: ")[2]
    sentences = re.split(r"(?<=[.;:?])\s+", message)
    steps = [re.match(r"[A-Za-z]+", sentence) for sentence in sentences[1:]]
    assert (
        any(step and step.group().lower() in STEPS for step in steps)
        or re.search(rf"\bor ({'|'.join(STEPS)})\b", message)
        or any(text in result.stderr for text in POINTS_THERE)
    ), message
