"""Photron MRAW with the spellings of its headers."""

import re

import numpy as np
from scenes.camera_files import random_frames, write_mraw
from scenes.reading import read, refusal


def test_upper_case_names_belong_together(tmp_path):
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)), header="cih")
    path.rename(tmp_path / "A.MRAW")
    path.with_suffix(".cih").rename(tmp_path / "A.CIH")
    assert len(read(tmp_path / "A.MRAW")) == 3


def test_a_missing_half_is_named(tmp_path):
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)))
    header = path.with_suffix(".cihx")
    content = header.read_text()
    header.unlink()
    assert re.search(r"Put a\.cihx or a\.cih, .* beside the file\.$", refusal(path))
    header.write_text(content)
    path.unlink()
    assert refusal(header).endswith("Put a.mraw beside it.")


def test_entities_of_the_header_are_not_followed(tmp_path):
    """A parser of XML would expand them without bound."""
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)))
    header = path.with_suffix(".cihx")
    bomb = '<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><cih>'
    header.write_bytes(header.read_bytes().replace(b"<cih>", bomb.encode()))
    assert len(read(path)) == 3
