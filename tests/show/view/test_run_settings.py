"""The region in run.toml: one line changes, and no other byte."""

import os
import tomllib

import pytest

from erlif.core.errors import ConfigError
from erlif.show.view.run_settings import change_values, propose_region, write_change

REGION = (1.25, 9.0, 2.0, 8.12345)
WANTED = {"x": [1.25, 9.0], "y": [2.0, 8.123]}

FORMS = {
    "inline": "a = 1\n[thickness] # maps\nroi = { x = [4, 15], y = [2, 13] }  # mm\n\n[run]\n",
    "spaced": "[thickness]\n  roi={x=[4,15],y=[2,13]}\nleast_signal   =  '100 electron' # dim\n",
    "table": "[thickness.roi]\n# of the bushing\nx = [4, 15]\n\ny = [2, 13]\n[oil]\nname='x'\n",
    "dotted": "[thickness]\nroi.x = [4, 15]\nroi.y = [2, 13] # mm\n",
    "absent": "[run]\nname = 'a'\n\n[thickness]\nleast_signal = '80 electron'\n# end\n",
    "no table": "# first\n[run]\nname = 'a'   # last line has no end",
    "empty": "",
    "windows": "[run]\r\nname = 'a'\r\n[thickness]\r\nroi = { x = [4, 15], y = [2, 13] }\r\n",
    "marked": "\ufeff[run]\nname = 'a'\n[thickness]\nroi = { x = [4, 15], y = [2, 13] }\n",
    "accents": "[run]\nname = 'Prüfstand µ'\n[thickness]\nroi = { x = [4, 15], y = [2, 13] }\n",
}


def write(tmp_path, text):
    path = tmp_path / "run.toml"
    path.write_bytes(text.encode())
    return path


@pytest.mark.parametrize("form", FORMS)
def test_the_region_changes_and_all_else_stays(tmp_path, form):
    path = write(tmp_path, FORMS[form])
    change = propose_region(tmp_path, REGION)
    assert path.read_bytes() == FORMS[form].encode()  # nothing is written yet
    write_change(change, before=change.digest)

    old, new = (
        tomllib.loads(text.removeprefix("\ufeff")) for text in (FORMS[form], path.read_text())
    )
    assert new["thickness"].pop("roi") == WANTED
    old.setdefault("thickness", {}).pop("roi", None)
    assert new == old

    # every line that does not hold the region is there, byte for byte and in its order
    lines = FORMS[form].encode().splitlines(keepends=True)
    left = path.read_bytes()
    for line in (line for line in lines if b"15]" not in line and b"13]" not in line):
        assert line in left
        left = left[left.index(line) + len(line) :]
    if form == "inline":  # the comment behind the region
        assert b"y = [2.0, 8.123] }  # mm\n" in path.read_bytes()
        assert [line[0] for line in change.lines.splitlines() if line[1:4] == "roi"] == ["-", "+"]


def test_a_file_that_has_changed_meanwhile_is_left_alone(tmp_path):
    path = write(tmp_path, FORMS["inline"])
    shown = propose_region(tmp_path, REGION)
    path.write_text("[run]\nname = 'edited'\n")
    with pytest.raises(ConfigError, match="Make the change again"):
        write_change(propose_region(tmp_path, REGION), before=shown.digest)
    assert path.read_text() == "[run]\nname = 'edited'\n"


def test_links_and_permissions_stay(tmp_path):
    path = write(tmp_path, FORMS["inline"])
    path.chmod(0o640)
    run = tmp_path / "run"
    run.mkdir()
    (run / "run.toml").symlink_to(path)
    change = propose_region(run, REGION)
    write_change(change, before=change.digest)
    assert (run / "run.toml").is_symlink()
    assert tomllib.loads(path.read_text())["thickness"]["roi"] == WANTED
    assert os.stat(path).st_mode & 0o777 == 0o640


def test_a_file_that_cannot_be_changed_is_refused(tmp_path):
    for place in (tmp_path, None):
        with pytest.raises(ConfigError, match="Start erlif view with --run-dir"):
            propose_region(place, REGION)
    assert not list(tmp_path.iterdir())
    for text in ("[thickness\n", "thickness = 3\n", "[thickness]\nroi = 5\n"):
        path = write(tmp_path, text)
        with pytest.raises(ConfigError, match="by hand"):
            propose_region(tmp_path, REGION)
        assert path.read_text() == text


def test_values_of_any_depth_are_written_and_taken_out():
    before = "# first\n[run]  # of May\nname = 'a'\n\n[joint.pin] # steel\nyoungs_modulus = '??'\n"
    after = change_values(
        before,
        {
            ("calibration",): "../fixture/calibration.nc",
            ("run", "name"): None,
            ("joint", "pin", "youngs_modulus"): "206 GPa",
            ("thickness", "exclude"): [[[1.5, 2], [3, 2], [2, 4]], "mask.png"],
            ("reference", "region", "x"): [1, 2],
        },
    )
    assert tomllib.loads(after) == {
        "calibration": "../fixture/calibration.nc",
        "run": {},
        "joint": {"pin": {"youngs_modulus": "206 GPa"}},
        "thickness": {"exclude": [[[1.5, 2], [3, 2], [2, 4]], "mask.png"]},
        "reference": {"region": {"x": [1, 2]}},
    }
    for kept in ("# first", "[run]  # of May", "[joint.pin] # steel"):
        assert kept in after
    assert change_values(after, {("run", "name"): None}) == after
