"""Photron MRAW with the spellings of its headers."""

import numpy as np
import pytest
from scenes.camera_files import random_frames, write_mraw

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.photron import open_photron


def test_upper_case_names_belong_together(tmp_path):
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)), header="cih")
    path.rename(tmp_path / "A.MRAW")
    path.with_suffix(".cih").rename(tmp_path / "A.CIH")
    file = open_frames(tmp_path / "A.MRAW")
    assert len(file.kinds) == 3
    file.close()


def test_a_missing_half_is_named(tmp_path):
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)))
    header = path.with_suffix(".cihx")
    content = header.read_text()
    header.unlink()
    with pytest.raises(FrameError, match=r"Put a\.cihx or a\.cih, .* beside the file\.$"):
        open_photron(path)
    header.write_text(content)
    path.unlink()
    with pytest.raises(FrameError, match=r"Put a\.mraw beside it\.$"):
        open_photron(header)


def test_entities_of_the_header_are_not_followed(tmp_path):
    """A parser of XML would expand them without bound."""
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)))
    header = path.with_suffix(".cihx")
    bomb = '<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><cih>'
    header.write_bytes(header.read_bytes().replace(b"<cih>", bomb.encode()))
    file = open_photron(path)
    assert len(file.kinds) == 3
    file.close()
