"""The version stands in one place."""

import re
import runpy
import shutil
from pathlib import Path

import erlif
from erlif.core.version import __version__, digest_of_sources


def test_the_citation_names_this_version():
    text = (Path(__file__).parents[2] / "CITATION.cff").read_text(encoding="utf-8")
    cited = re.search(r'^version:\s*"?([^"\s]+)', text, re.MULTILINE)
    assert cited is not None
    assert cited[1] == __version__


def test_the_digest_changes_with_a_byte_of_the_sources_and_not_with_line_breaks(tmp_path):
    """Of copies, each digested by its own module."""

    def digest(name, old=b"", new=b""):
        copy = tmp_path / name
        shutil.copytree(Path(erlif.__file__).parent / "core", copy / "core")
        file = copy / "core" / "units.toml"
        file.write_bytes(file.read_bytes().replace(old, new) if old else file.read_bytes())
        source = (copy / "core" / "version.py").as_posix()
        return runpy.run_path(source)["digest_of_sources"]()

    plain = digest("plain")
    assert digest("copy") == digest("windows", b"\n", b"\r\n") == plain
    assert digest("edited", b"=", b"= ") != plain
    assert re.fullmatch("[0-9a-f]{12}", digest_of_sources())
