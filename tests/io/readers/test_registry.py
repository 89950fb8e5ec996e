"""One entry point for all formats, own ones and those of other packages."""

import functools
import gzip
import os
import re
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image
from scenes.tiff_pages import write_encoded

from erlif.core.errors import FrameError
from erlif.io.readers import Format, FrameFile, FrameKind, borrow_frames, open_frames, registry

GREY = np.random.default_rng(5).integers(0, 4096, (3, 64, 80), dtype=np.uint16)


class Flat(FrameFile):
    """A format of another package: one frame whose counts are the fifth byte."""

    kinds = (FrameKind((2, 3), "uint8"),)

    def __init__(self, path):
        self.level = path.read_bytes()[4]
        self.closed = False

    def read(self, index):
        return np.full((2, 3), self.level, np.uint8)

    def close(self):
        assert not self.closed
        self.closed = True


FLAT = Format("flat", (".flat",), lambda path, head: head[:4] == b"FLAT", Flat)


@pytest.fixture
def foreign(monkeypatch):
    """Other packages that name what a test lists, by the name of the entry point."""

    def install(**points):
        class Point:
            def __init__(self, name, value):
                self.name, self.value = name, value

            def load(self):
                if isinstance(self.value, Exception):
                    raise self.value
                return self.value

        found = [Point(*item) for item in points.items()]
        monkeypatch.setattr(metadata, "entry_points", lambda group: found if group else [])
        registry._foreign_formats.cache_clear()

    yield install
    registry._keep.cache_clear()
    registry._foreign_formats.cache_clear()


def test_a_dataset_is_refused_where_the_format_has_none(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", GREY, photometric="minisblack")
    with pytest.raises(FrameError, match="TIFF file, which has no datasets"):
        open_frames(tmp_path / "a.tif", dataset="/counts")


@pytest.mark.parametrize(
    ("start", "reason"),
    [
        (b"Andor Technology Multi-Channel File\n65538 1\n", "an Andor SIF file, .* Andor Solis as"),
        (b"DCIMG\0\0\0\7\0\0\0", "a Hamamatsu DCIMG file, .* HCImage as TIFF"),
        (b"RIFF\0\0\0\0AVI LIST", "an AVI film, .* Export the raw counts of the camera as TIFF"),
        (gzip.compress(b"SIMPLE  =", mtime=0), "compressed by gzip, .* Expand"),
    ],
)
@pytest.mark.parametrize("suffix", ["sif", "fits.gz"])
def test_a_format_that_is_not_read_is_refused_by_name(tmp_path, start, reason, suffix, foreign):
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(start.ljust(600, b"\3"))
    with pytest.raises(FrameError, match=reason):
        open_frames(path)

    # another package may read it
    foreign(mine=Format("mine", (), lambda path, head: head.startswith(start[:5]), Flat))
    with closing(open_frames(path)) as file:
        assert isinstance(file, Flat)


# other packages


def test_another_package_cannot_change_how_a_known_file_is_read(tmp_path, foreign):
    foreign(greedy=Format("greedy", (".tif",), lambda path, head: True, Flat))
    tifffile.imwrite(tmp_path / "a.tif", GREY, photometric="minisblack")
    with borrow_frames(tmp_path / "a.tif") as file:
        np.testing.assert_array_equal(file.read(1), GREY[1])


@pytest.mark.parametrize(
    ("value", "reason"),
    [(ImportError("no libflat"), "ImportError: no libflat"), (3, "it is no erlif.readers.Format")],
)
def test_a_reader_that_cannot_be_loaded_is_named(tmp_path, foreign, value, reason):
    foreign(broken=value, flat=FLAT)
    (tmp_path / "a.dat").write_bytes(b"none")
    with pytest.raises(FrameError, match=re.escape(f"broken cannot be loaded ({reason})")):
        open_frames(tmp_path / "a.dat")
    (tmp_path / "b.dat").write_bytes(b"FLAT\x01")
    open_frames(tmp_path / "b.dat").close()


def test_a_package_that_is_missing_is_named_with_the_extra_that_has_it(tmp_path, foreign):
    def needs(name):
        def start(path):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

        return start

    foreign(
        one=Format("one", (".one",), lambda path, head: False, needs("lib_one")),
        two=Format("two", (".two",), lambda path, head: False, needs("lib_two"), extra="formats"),
    )
    for suffix, advice in ((".one", "install lib_one."), (".two", r"install 'erlif\[formats\]'.")):
        path = tmp_path / f"a{suffix}"
        path.write_bytes(b"x")
        with pytest.raises(FrameError, match=f"package lib_{suffix[1:]}, which.*{advice}"):
            open_frames(path)


def test_each_extra_in_the_table_exists():
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())
    extras = project["project"]["optional-dependencies"]
    assert {entry.extra for entry in registry.FORMATS if entry.extra} <= set(extras)
    assert any(name.startswith("hdf5plugin") for name in extras["formats"])


# files kept open


@pytest.fixture
def flats(tmp_path, foreign):
    """Six files of the other format, each with its number as the level."""
    foreign(flat=FLAT)
    paths = [tmp_path / f"{n}.flat" for n in range(6)]
    for n, path in enumerate(paths):
        path.write_bytes(bytes([*b"FLAT", n]))
    return paths


def test_a_file_stays_open_for_the_next_frame(flats):
    with borrow_frames(flats[1]) as one, borrow_frames(flats[1]) as two:
        assert one is two
    assert not one.closed
    registry._keep.cache_clear()
    assert one.closed


def test_few_files_are_open_at_once(flats, monkeypatch):
    monkeypatch.setattr(registry, "_keep", functools.lru_cache(2)(registry._Kept))
    files = []
    for path in flats[:5]:
        with borrow_frames(path) as file:
            files.append(file)
    assert [file.closed for file in files] == [True, True, True, False, False]


def test_a_file_in_use_is_closed_after_its_use(flats):
    with borrow_frames(flats[1]) as file:
        registry._keep.cache_clear()
        assert not file.closed
        assert file.read(0)[0, 0] == 1
    assert file.closed


def test_threads_share_the_open_files(flats, monkeypatch):
    monkeypatch.setattr(registry, "_keep", functools.lru_cache(2)(registry._Kept))

    def work(seed):
        faults = []
        for n in np.random.default_rng(seed).integers(0, 6, 200):
            with borrow_frames(flats[n]) as file:
                if file.closed or file.read(0)[0, 0] != n:
                    faults.append(n)
        return faults

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    with ThreadPoolExecutor(4) as threads:
        faults = [n for one in threads.map(work, range(4)) for n in one]
    sys.setswitchinterval(interval)
    assert not faults


def test_a_file_that_took_the_name_of_an_open_one_is_opened_anew(tmp_path):
    """Programs that copy with the time of change leave size and time as they were."""
    path, other = tmp_path / "a.npy", tmp_path / "b.npy"
    np.save(path, np.zeros((2, 64, 80), np.uint16))
    np.save(other, np.ones((2, 64, 80), np.uint16))
    found = path.stat()
    os.utime(other, ns=(found.st_atime_ns, found.st_mtime_ns))
    with borrow_frames(path) as file:
        assert file.read(1).max() == 0
    other.replace(path)
    with borrow_frames(path) as file:
        assert file.read(1).min() == 1


def test_a_file_that_is_gone_when_it_is_borrowed_is_a_fault(tmp_path):
    with pytest.raises(FrameError, match="No such file"), borrow_frames(tmp_path / "a.tif"):
        pass


@pytest.mark.parametrize(
    "options", [{"compression": "zstd"}, {"compression": "lzw"}, {"bitspersample": 12}, None]
)
def test_frames_that_need_imagecodecs_name_the_extra_that_has_it(tmp_path, monkeypatch, options):
    path = tmp_path / ("a.png" if options is None else "a.tif")
    if options is None:
        Image.fromarray(GREY[0]).save(path)
    else:
        write_encoded(path, GREY[0], **options)
    monkeypatch.setitem(sys.modules, "imagecodecs", None)
    with pytest.raises(FrameError, match=r"imagecodecs.*pip install 'erlif\[formats\]'"):
        open_frames(path)


@pytest.mark.parametrize("compression", [None, "zlib", "packbits"])
def test_usual_tiff_needs_no_imagecodecs(tmp_path, compression):
    """In a process of its own, as tifffile has loaded it here."""
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY, photometric="minisblack", compression=compression)
    code = (
        "import sys; sys.modules['imagecodecs'] = None\n"
        "from pathlib import Path; from erlif.io.readers import open_frames\n"
        f"print(int(open_frames(Path({str(path)!r})).read(2).sum()))"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(shown.stdout) == GREY[2].sum()
