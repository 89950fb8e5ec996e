"""The same frames in other files: the film must not depend on how a rig writes them."""

import contextlib
import shutil

import numpy as np
import pytest
import tifffile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import erlif
from erlif.core.errors import ErlifError
from erlif.io.ingest import open_run
from erlif.pipeline.physics.joint import locate_run


def read_pages(path):
    pages = tifffile.imread(path)
    return pages if pages.ndim == 3 else pages[np.newaxis]


def write_pages(path, pages):
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(page, contiguous=False, metadata=None, photometric="minisblack")


def test_multi_page_files_give_the_film_of_single_pages(lab, film):
    for camera in (1, 2):
        pages = np.concatenate([read_pages(path) for path in lab.frames(camera)])
        shutil.rmtree(lab.run / f"camera{camera}")
        write_pages(lab.run / f"all{camera}.tiff", pages)
        lab.edit("run/run.toml", (f'"camera{camera}/*.tif"', f'"all{camera}.tiff"'))
    with erlif.open_film(film) as reference:
        np.testing.assert_array_equal(erlif.process(lab.run).thickness, reference.thickness)


def test_eight_bit_frames_give_the_mean_film_of_twelve_bits(lab, film):
    """4.4 electrons per count of 12 bits are 70.4 per count of 8 bits."""
    for directory in (lab.run, lab.fixture):
        for path in directory.rglob("*.tif"):
            write_pages(path, (read_pages(path) >> 4).astype(np.uint8))
        toml = directory / f"{directory.name}.toml"
        text = toml.read_text().replace("bit_depth = 12", "bit_depth = 8")
        text = text.replace("4.4 electron/DN", "70.4 electron/DN")
        for camera in (1, 2):
            # 64 DN over 16, less the mean of the four bits that are cut off
            text = text.replace(f'dark = "camera{camera}_dark.tif"', 'offset = "3.5 DN"')
        toml.write_text(text)
    coarse = erlif.process(lab.run, calibration=erlif.calibrate(lab.fixture))
    with erlif.open_film(film) as fine:
        np.testing.assert_allclose(coarse.film_mean, fine.film_mean, rtol=0.02)
    assert (coarse.flags == 0).mean() > 0.5


@pytest.fixture(scope="module")
def scratch(small_rig, tmp_path_factory):
    directory = tmp_path_factory.mktemp("fuzz") / "run"
    shutil.copytree(small_rig.run, directory)
    return directory


@settings(
    deadline=None,
    database=None,
    max_examples=40,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.data())
def test_a_log_with_any_bytes_changed_gives_finite_speeds_or_is_refused(small_rig, scratch, data):
    original = (small_rig.run / "encoder.csv").read_bytes()
    content = bytearray(original)
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(content) - 1))
        content[place] = data.draw(st.sampled_from(b"0123456789.-e,\n\xff"))
    (scratch / "encoder.csv").write_bytes(content)
    with contextlib.suppress(ErlifError):
        assert np.isfinite(locate_run(open_run(scratch)).rocker_speed).all()
