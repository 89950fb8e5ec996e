"""Photron MRAW with the spellings of its headers."""

from __future__ import annotations

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_mraw

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.photron import open_photron, read_photron_header


@pytest.mark.parametrize("header", ["cihx", "cih"])
@pytest.mark.parametrize(("stored", "bits"), [(8, 8), (12, 12), (16, 12)])
def test_known_counts_by_either_file(tmp_path, header, stored, bits):
    frames = random_frames(np.random.default_rng(stored), bits=bits)
    path = write_mraw(tmp_path / "cam1.mraw", frames, stored=stored, header=header)
    for name, other in ((path, f".{header}"), (path.with_suffix(f".{header}"), ".mraw")):
        file = open_frames(name)
        npt.assert_array_equal([file.read(k) for k in range(3)], frames)
        assert str(file.kinds[0]) == f"8 x 6 uint{8 if stored == 8 else 16}"
        assert file.bits == bits
        assert [companion.name for companion in file.companions] == [f"cam1{other}"]
        npt.assert_allclose(file.times, [0, 1 / 2000, 2 / 2000])
        file.close()


def test_times_of_a_recording_saved_in_steps(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    for header in ("cihx", "cih"):
        path = write_mraw(
            tmp_path / f"{header}.mraw", frames, rate="50000", step=2500, header=header
        )
        file = open_photron(path)
        npt.assert_allclose(file.times, [0, 0.05, 0.1])
        file.close()


def test_counts_at_the_high_end_leave_the_depth_open(tmp_path):
    frames = random_frames(np.random.default_rng(1)) << 4
    file = open_photron(write_mraw(tmp_path / "a.mraw", frames, side="Higher"))
    npt.assert_array_equal(file.read(1), frames[1])
    assert file.bits is None
    file.close()


def test_upper_case_names_belong_together(tmp_path):
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)), header="cih")
    path.rename(tmp_path / "A.MRAW")
    path.with_suffix(".cih").rename(tmp_path / "A.CIH")
    file = open_frames(tmp_path / "A.MRAW")
    assert len(file.kinds) == 3
    file.close()


def test_a_header_of_a_shorter_recording_is_refused(tmp_path):
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)), claimed=2)
    with pytest.raises(FrameError, match=r"a\.cihx describes 2 frames of 96 bytes, .* 288 bytes"):
        open_photron(path)


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


def test_a_header_without_a_rate_has_no_times():
    text = "Total Frame : 1\nImage Width : 4\nImage Height : 4\nColor Bit : 8\n"
    assert read_photron_header(text).interval is None
    for rate in ("0", "1e-320", "-5"):
        assert read_photron_header(text + f"Record Rate(fps) : {rate}\n").interval is None


def test_entities_of_the_header_are_not_followed(tmp_path):
    """A parser of XML would expand them without bound."""
    path = write_mraw(tmp_path / "a.mraw", random_frames(np.random.default_rng(1)))
    header = path.with_suffix(".cihx")
    bomb = '<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><cih>'
    header.write_bytes(header.read_bytes().replace(b"<cih>", bomb.encode()))
    file = open_photron(path)
    assert len(file.kinds) == 3
    file.close()
