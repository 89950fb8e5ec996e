"""The same run in the files of other cameras: the same film, bit for bit."""

from __future__ import annotations

import shutil
from dataclasses import replace

import h5py
import numpy as np
import pytest
import tifffile
import xarray as xr
from scenes.camera_files import write_im7
from scenes.tiff_pages import rewrite

import erlif
from conftest import SMALL
from erlif.core.flags import Flag
from erlif.io.ingest import open_run, read_frames, read_reference_pages, select_counts
from erlif.rig import simulate

pytestmark = pytest.mark.usefixtures("without_theory")


def read_pages(*paths):
    """Counts of TIFF files, (page, y, x)."""
    pages = [tifffile.imread(path) for path in paths]
    return np.concatenate([page if page.ndim == 3 else page[np.newaxis] for page in pages])


def to_set(run):
    """Both cameras in each image, as DaVis stores the frames of one trigger."""
    (one, *references), (two, *others) = take_pages(run, ".set", both="both")
    names = [f"images/B{number:05}.im7" for number in range(len(one))]
    (run / "images").mkdir()
    for number, (name, pair) in enumerate(zip(names, zip(one, two, strict=True), strict=True)):
        write_im7(run / name, np.array(pair), packing=number % 4)
    (run / "images.set").write_text("SetType = 1")
    for name, a, b in zip(("dark", "flat"), references, others, strict=True):
        pairs = np.stack([a, b], axis=1).reshape(-1, *a.shape[1:])
        (run / f"both_{name}").mkdir()
        for number in range(len(a)):
            path = run / f"both_{name}" / f"B{number:05}.im7"
            write_im7(path, pairs[2 * number : 2 * number + 2], packing=1)
        (run / f"both_{name}.set").write_text("SetType = 1")
    text = (run / "run.toml").read_text()
    for camera in (1, 2):
        part = f'files = "images.set"\npart = "channel {camera}"\n'
        text = text.replace('files = "both.set"', part, 1)
    (run / "run.toml").write_text(text)


def to_hdf5(run):
    """Frames, darks and flats of both cameras in one file, as int32."""
    with h5py.File(run / "run.h5", "w") as file:
        for camera, counts in enumerate(take_pages(run, ".h5", both="run"), 1):
            for name, pages in zip(("counts", "dark", "flat"), counts, strict=True):
                file.create_dataset(
                    f"camera{camera}/{name}", data=pages.astype("i4"), compression="gzip"
                )
    text = (run / "run.toml").read_text()
    for name in ("dark", "flat"):
        text = text.replace(f'"run_{name}.h5"', '"run.h5"')
    kinds = (("dataset", "counts"), ("dark_dataset", "dark"), ("flat_dataset", "flat"))
    for camera in (1, 2):
        keys = "".join(f'\n{key} = "/camera{camera}/{name}"' for key, name in kinds)
        text = text.replace('files = "run.h5"\n', f'files = "FILE"{keys}\n', 1)
    (run / "run.toml").write_text(text.replace('"FILE"', '"run.h5"'))


def pages_of(run, camera):
    """Counts of frames, darks and flats in the files of the rig."""
    kinds = (read_pages(run / f"{camera}_{kind}.tif") for kind in ("dark", "flat"))
    return read_pages(*sorted((run / camera).glob("*.tif"))), *kinds


def take_pages(run, suffix, *, both):
    """Frames, darks and flats of both cameras; the TIFF files go and run.toml names new ones."""
    text, found = (run / "run.toml").read_text(), []
    for camera in ("camera1", "camera2"):
        found.append(pages_of(run, camera))
        shutil.rmtree(run / camera)
        text = text.replace(f'"{camera}/*.tif"', f'"{both}{suffix}"')
        for name in ("dark", "flat"):
            (run / f"{camera}_{name}.tif").unlink()
            text = text.replace(f'"{camera}_{name}.tif"', f'"{both}_{name}{suffix}"')
    (run / "run.toml").write_text(text)
    return found


@pytest.mark.parametrize("convert", [to_set, to_hdf5])
def test_counts_do_not_depend_on_the_files_of_the_camera(small_rig, tmp_path, convert):
    """Frames, darks and flats, bit for bit; tifffile reads the expected ones."""
    pages = [pages_of(small_rig.run, camera) for camera in ("camera1", "camera2")]
    shutil.copytree(small_rig.run, tmp_path / "run")
    convert(tmp_path / "run")

    run = open_run(tmp_path / "run")
    assert run.pairs.full_scales == (4095, 4095)
    counts = read_frames(run.pairs, run.pairs.usable).counts
    for camera, expected in enumerate(pages, 1):
        settings, found = run.cameras[camera - 1], [counts.sel(camera=camera).values]
        for kind, pattern in (("dark", settings.dark), ("flat", settings.flat)):
            read = read_reference_pages(
                run.directory,
                pattern,
                what=kind,
                bit_depth=settings.bit_depth,
                shape=run.pairs.shape,
                selection=select_counts(settings, kind),
            )
            found.append(np.array(list(read)))
        for one, other in zip(found, expected, strict=True):
            assert one.dtype == other.dtype
            assert np.array_equal(one, other)


def test_eight_bit_frames_give_the_mean_film_of_twelve_bits(lab, film):
    """4.4 electrons per count of 12 bits are 70.4 per count of 8 bits."""
    for directory in (lab.run, lab.fixture):
        for path in directory.rglob("*.tif"):
            rewrite(path, lambda counts: (counts >> 4).astype(np.uint8))
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


def test_camera_2_turned_by_90_degrees_with_frames_that_are_not_square(tmp_path):
    """Both have pages of 128 x 96 pixels; what both see is a square of 96 pixels.

    The rig draws 128 x 128, of which each camera keeps the rows that its sensor has.
    """
    rig = replace(SMALL, height=128)
    simulate(tmp_path, seed=1, rig=rig)
    for folder in ("run", "fixture"):
        for path in (tmp_path / folder).rglob("*.tif"):
            turned = "camera2" in str(path.relative_to(tmp_path))
            counts = np.rot90(tifffile.imread(path), -int(turned), axes=(-2, -1))
            counts = np.ascontiguousarray(counts[..., 16:112, :])
            tifffile.imwrite(path, counts, photometric="minisblack")
        with (tmp_path / folder / f"{folder}.toml").open("a") as settings:
            settings.write('\n[registration]\norientation = "rotated_90"\n')
    calibration = erlif.calibrate(tmp_path / "fixture")
    film = erlif.process(tmp_path / "run", calibration=calibration, workers=1)

    flags, columns = film["flags"].values, np.arange(128)
    unseen = (flags & int(Flag.OUTSIDE_OVERLAP)) > 0
    assert unseen[..., (columns < 12) | (columns >= 116)].all()
    inner = (columns >= 24) & (columns < 104)
    assert np.mean(flags[..., inner] == 0) > 0.9
    with xr.open_dataset(tmp_path / "truth.nc", engine="h5netcdf") as truth:
        true = truth.film.values[:, 16:112]
    std = np.hypot(film.thickness_std.values, film.thickness_std_shared.values)
    pull = np.abs(film.thickness.values - true)[flags == 0] / std[flags == 0]
    assert 0.6 < np.mean(pull < 1) < 0.76
    assert 0.93 < np.mean(pull < 2) < 0.97
