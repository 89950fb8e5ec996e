"""HDF5 and netCDF-4 files against h5py and h5netcdf, which wrote them."""

import zlib
from contextlib import closing

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray as xr
from scenes.reading import read, refusal, times_of
from scipy.io import savemat

from erlif.core.errors import FrameError
from erlif.io.ingest.images import find_pages, read_page
from erlif.io.ingest.selection import Selection
from erlif.io.readers import open_frames

COUNTS = np.random.default_rng(5).integers(0, 4096, (4, 64, 80), dtype=np.uint16)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.h5"


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"chunks": (1, 64, 80)},
        {"chunks": (3, 10, 80), "compression": "gzip"},
        {"chunks": True, "compression": "lzf", "shuffle": True},
    ],
    ids=["contiguous", "chunks", "gzip", "lzf"],
)
@pytest.mark.parametrize("dtype", ["<u2", ">i4", "<f4"])
def test_the_only_array_of_frames_is_used(path, options, dtype):
    with h5py.File(path, "w") as file:
        file.create_dataset("camera1/counts", data=COUNTS.astype(dtype), **options)
        file["angle"] = np.arange(4.0)
        file["name"] = "run"
    found = read(path)
    np.testing.assert_array_equal(found, COUNTS)
    assert found.dtype == np.dtype(dtype).newbyteorder("=")
    assert times_of(path) is None


def test_an_array_is_chosen_by_its_path(path):
    with h5py.File(path, "w") as file:
        file["camera1/counts"], file["camera2/counts"] = COUNTS, COUNTS[::-1]
    np.testing.assert_array_equal(read(path, dataset="/camera2/counts"), COUNTS[::-1])
    np.testing.assert_array_equal(read(path, dataset="camera1/counts"), COUNTS)
    for dataset in ("", "/camera3", "/camera1"):
        message = refusal(path, dataset=dataset)
        assert "/camera1/counts (4 x 64 x 80 uint16), /camera2/counts" in message
        assert message.endswith('for example dataset = "/camera1/counts".')


@pytest.mark.parametrize("frames", [COUNTS[0], COUNTS[:, :, :3]], ids=["single", "narrow"])
def test_a_single_frame_and_three_columns_are_frames(path, frames):
    with h5py.File(path, "w") as file:
        file["image"] = frames
    np.testing.assert_array_equal(read(path), frames.reshape(-1, *frames.shape[-2:]))


@pytest.mark.parametrize(("unit", "factor"), [("s", 1), ("ms", 1e-3), ("seconds since 2026", 1)])
def test_times_of_netcdf_are_those_of_its_coordinate(tmp_path, unit, factor):
    with h5netcdf.File(tmp_path / "a.nc", "w") as file:
        file.dimensions = {"time": 4, "y": 64, "x": 80}
        file.create_variable("counts", ("time", "y", "x"), data=COUNTS)
        time = file.create_variable("time", ("time",), data=np.array([5.0, 6, 8, 12]))
        time.attrs["long_name"] = "time of the pulse"
    # text of fixed length, as the library of netCDF writes it
    with h5py.File(tmp_path / "a.nc", "a") as file:
        file["time"].attrs["units"] = np.bytes_(unit)
    np.testing.assert_array_equal(read(tmp_path / "a.nc"), COUNTS)
    np.testing.assert_allclose(times_of(tmp_path / "a.nc"), factor * np.array([0, 1, 3, 7]))


def test_times_of_hdf5_stand_beside_the_frames(path):
    with h5py.File(path, "w") as file:
        file["camera1/counts"], file["camera1/exposure"] = COUNTS, np.arange(4.0)
        file["camera1/stamp"] = np.array([100, 110, 130, 170])
        file["camera1/stamp"].attrs["units"] = np.bytes_("ms")
        file["other"] = np.arange(4.0)
        file["other"].attrs["units"] = np.bytes_("s")
    np.testing.assert_allclose(times_of(path), [0, 0.01, 0.03, 0.07])
    with h5py.File(path, "a") as file:
        file["camera1/delay"] = np.arange(4.0)
        file["camera1/delay"].attrs["units"] = np.bytes_("s")
    assert times_of(path) is None  # two arrays of times: which one is meant is not clear


def test_times_of_xarray_keep_their_nanoseconds(tmp_path):
    """Its units are text of variable length; a float resolves 256 ns of the time since 1970."""
    start = np.datetime64("2026-11-22T09:00:00.000000001", "ns")
    stamps = start + np.array([0, 7, 20_000_033, 90_000_000_001]).astype("timedelta64[ns]")
    frames = xr.Dataset({"counts": (("time", "y", "x"), COUNTS)}, {"time": stamps})
    encoding = {"time": {"units": "nanoseconds since 1970-01-01", "dtype": "int64"}}
    frames.to_netcdf(tmp_path / "a.nc", engine="h5netcdf", encoding=encoding)
    with h5py.File(tmp_path / "a.nc") as file:
        assert h5py.h5a.open(file["time"].id, b"units").get_type().is_variable_str()
    found = times_of(tmp_path / "a.nc", dataset="counts")
    np.testing.assert_allclose(found, [0, 7e-9, 0.020000033, 90.000000001], rtol=1e-12)


# what is refused


def _scaled(file):
    file["counts"] = COUNTS
    file["counts"].attrs["scale_factor"] = 0.5


CHUNK = {"chunks": (100_000, 64, 80), "maxshape": (None, 64, 80)}

REFUSED = [
    (lambda file: file.update(angle=np.arange(4.0)), "no dataset of two or three dimensions"),
    (lambda file: file.update(names=np.array([[b"a", b"b"]])), "holds numbers. Choose"),
    (_scaled, "/counts is scaled (scale_factor, add_offset)"),
    (
        lambda file: file.create_dataset("a", (10**9, 64, 80), "u2", chunks=(1, 64, 80)),
        "cannot hold 1000000000 frames of 80 x 64 uint16",
    ),
    (
        lambda file: file.create_dataset("a", (4, 64, 80), "u2", **CHUNK),
        "a chunk is larger than the file can hold",
    ),
]


@pytest.mark.parametrize(("fill", "words"), REFUSED)
def test_what_are_no_counts_of_this_file_is_refused(path, fill, words):
    with h5py.File(path, "w") as file:
        fill(file)
    assert words in refusal(path)


def test_frames_in_other_files_are_refused(path, tmp_path):
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["counts"] = COUNTS
    layout = h5py.VirtualLayout(COUNTS.shape, COUNTS.dtype)
    layout[:] = h5py.VirtualSource(tmp_path / "b.h5", "counts", COUNTS.shape)
    with h5py.File(path, "w") as file:
        file["link"] = h5py.ExternalLink("b.h5", "/counts")
        file.create_virtual_dataset("virtual", layout)
        other = [(str(tmp_path / "b.raw"), 0, h5py.h5f.UNLIMITED)]
        file.create_dataset("outside", COUNTS.shape, COUNTS.dtype, external=other)
    assert "leads to b.h5. Name that file." in refusal(path, dataset="/link")
    assert "lie in other files" in refusal(path, dataset="/virtual")
    assert "lie in other files" in refusal(path, dataset="/outside")


@pytest.mark.parametrize(
    ("installed", "advice"),
    [
        (
            False,
            "hdf5plugin, which is not installed. Install it with: pip install 'erlif[formats]'.",
        ),
        (True, "has no filter 32001 of HDF5. Save"),
    ],
)
def test_a_missing_filter_is_named_with_its_package(path, monkeypatch, installed, advice):
    with h5py.File(path, "w") as file:
        file.create_dataset("counts", data=COUNTS, chunks=(1, 64, 80), compression="gzip")

    def load(name):
        if not installed:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    # 32001 is the registered number of Blosc
    monkeypatch.setattr("erlif.io.readers.hdf5.filters_of", lambda data: [32001])
    monkeypatch.setattr("importlib.import_module", load)
    assert advice in refusal(path)


@pytest.mark.parametrize("name", ["Blosc", "Bitshuffle", "Zstd"])
def test_compressions_of_hdf5plugin_are_read(path, name):
    plugin = pytest.importorskip("hdf5plugin")
    with h5py.File(path, "w") as file:
        file.create_dataset("counts", data=COUNTS, chunks=(1, 64, 80), **getattr(plugin, name)())
    np.testing.assert_array_equal(read(path), COUNTS)


def times_beside(path, fill):
    with h5py.File(path, "w") as file:
        file["counts"] = COUNTS
        fill(file)
    return times_of(path, dataset="/counts")


def seconds(dataset):
    dataset.attrs["units"] = np.bytes_("s")


def test_times_of_another_file_are_not_read(path, tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as other:
        seconds(other.create_dataset("time", data=np.arange(4.0)))
    np.arange(4.0).tofile(tmp_path / "other.raw")

    def link(file):
        file["time"] = h5py.ExternalLink("other.h5", "/time")

    def store(file):
        raw = [(str(tmp_path / "other.raw"), 0, h5py.h5f.UNLIMITED)]
        seconds(file.create_dataset("time", (4,), "f8", external=raw))

    assert times_beside(path, link) is None
    assert times_beside(path, store) is None


def test_times_that_cannot_be_read_are_no_fault_of_the_frames(path, monkeypatch):
    def huge(file):
        options = {"maxshape": (None,), "chunks": (150_000_000,), "compression": "gzip"}
        seconds(file.create_dataset("time", (4,), "f8", **options))

    def packed(file):
        seconds(file.create_dataset("time", data=np.arange(4.0), compression="gzip"))

    assert times_beside(path, huge) is None
    np.testing.assert_array_equal(times_beside(path, packed), np.arange(4.0))
    monkeypatch.setattr(h5py.h5z, "filter_avail", lambda code: False)
    assert times_beside(path, packed) is None


# counts that are not in the file, for which the library returns zeros


@pytest.mark.parametrize(
    ("chunks", "missing"),
    [((1, 64, 80), {2}), ((1, 32, 40), {2}), ((2, 64, 80), {2, 3}), ((3, 10, 80), {3})],
)
def test_a_frame_that_was_never_written_is_refused(path, chunks, missing):
    with h5py.File(path, "w") as file:
        data = file.create_dataset("counts", COUNTS.shape, COUNTS.dtype, chunks=chunks)
        for index in set(range(4)) - missing:
            data[index] = COUNTS[index]
        if chunks == (1, 32, 40):
            data[2, :30] = COUNTS[2, :30]  # a part of the frame
    with closing(open_frames(path)) as opened:
        for index in range(4):
            if index in missing:
                with pytest.raises(FrameError, match="not in the file"):
                    opened.read(index)
            else:
                np.testing.assert_array_equal(opened.read(index), COUNTS[index])


@pytest.mark.parametrize("packed", [True, False])
def test_a_frame_marked_as_plain_is_read_only_where_it_is_plain(path, packed):
    with h5py.File(path, "w") as file:
        data = file.create_dataset("counts", data=COUNTS, chunks=(1, 64, 80), compression="gzip")
        chunk = zlib.compress(COUNTS[2].tobytes()) if packed else COUNTS[2].tobytes()
        data.id.write_direct_chunk((2, 0, 0), chunk, filter_mask=1)
    if packed:
        assert "not in the file" in refusal(path)
    else:
        np.testing.assert_array_equal(read(path), COUNTS)


# order of the axes


def write_matlab(path, images, *, version=None, axes=(), mark=False):
    """Frames as MATLAB has them, column by column; of `save -v7.3`, or named as by ncwrite."""
    with h5py.File(path, "w", userblock_size=512 if version else 0) as file:
        data = file.create_dataset("frames", data=images.swapaxes(-1, -2), chunks=True)
        if mark:
            data.attrs["MATLAB_class"] = np.bytes_("uint16")
        for n, name in enumerate(axes):
            data.dims[n].label = name
        file.create_group("#refs#").create_dataset("a", data=np.zeros((3, 4, 5)))
    if version:
        with path.open("r+b") as raw:
            raw.write(f"MATLAB {version} MAT-file, Platform: PCWIN64".encode().ljust(124))
    return path


@pytest.mark.parametrize(
    "options",
    [
        {"version": "7.3"},
        {"version": "7.3", "mark": True},
        {"mark": True},
        {"axes": ("frame", "x", "y")},
        {"axes": ("time", "columns", "rows")},
    ],
    ids=str,
)
@pytest.mark.parametrize("shape", [(3, 64, 80), (3, 80, 64), (3, 64, 64), (64, 80)], ids=str)
def test_images_of_matlab_stand_upright(tmp_path, options, shape):
    images = np.random.default_rng(3).integers(0, 4096, shape, dtype=np.uint16)
    options = {**options, "axes": options.get("axes", ())[-len(shape) :]}
    path = write_matlab(tmp_path / "a.mat", images, **options)
    found = find_pages(tmp_path, path.name, "camera1", Selection(dataset="/frames"))
    read = [read_page(page, tmp_path, shape[-2:]) for page in found.pages]
    np.testing.assert_array_equal(read, images.reshape(-1, *shape[-2:]))


@pytest.mark.parametrize("what", ["camera1", "camera1 dark"])
@pytest.mark.parametrize("shape", [(3, 64, 80), (3, 64, 64)], ids=str)
def test_an_order_that_no_mark_shows_is_asked_for(tmp_path, shape, what):
    """A square image may be transposed; of one that is higher than wide it is likely."""
    images = np.random.default_rng(3).integers(0, 4096, shape, dtype=np.uint16)
    write_matlab(tmp_path / "a.h5", images)
    with pytest.raises(FrameError, match=r'Give array_order = "column" in \[camera1\]'):
        find_pages(tmp_path, "a.h5", what, Selection(dataset="/frames"))
    selection = Selection("top", "/frames", array_order="column")
    page = find_pages(tmp_path, "a.h5", what, selection).pages[0]
    half = images[0, : shape[1] // 2]
    np.testing.assert_array_equal(read_page(page, tmp_path, half.shape), half)


def test_rows_of_named_axes_are_kept(tmp_path):
    images = np.random.default_rng(3).integers(0, 4096, (3, 80, 64), dtype=np.uint16)
    data = xr.DataArray(images, dims=("frame", "y", "x"), name="counts").to_dataset()
    data.assign_coords(x=np.arange(64)).to_netcdf(tmp_path / "a.nc")
    (page, *_) = find_pages(tmp_path, "a.nc", "camera1").pages
    np.testing.assert_array_equal(read_page(page, tmp_path, (80, 64)), images[0])


def test_frames_of_earlier_versions_of_matlab_are_refused_by_name(tmp_path):
    savemat(tmp_path / "a.mat", {"frames": np.zeros((64, 80, 3), np.uint16)})
    assert "it is a MATLAB file of version 5 to 7, which is not read" in refusal(tmp_path / "a.mat")
