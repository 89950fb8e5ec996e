"""Darks and flats that do not belong to their frames."""

from dataclasses import replace

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.correction import DeclaredNoise, make_references, measure_camera
from erlif.correction.agreement import find_reference_faults, find_share
from erlif.correction.view import ViewSum

SHAPE = (96, 128)
GAIN = 4.0
OFFSET = 64.0


def pages(rng, light, count):
    """Exposures of a light [DN] above an offset of 64 DN, with a read noise of 2 DN."""
    electrons = rng.poisson(np.broadcast_to(GAIN * light, (count, *SHAPE)))
    noise = rng.normal(0, 2, electrons.shape)
    return np.rint(OFFSET + electrons / GAIN + noise).clip(0, 4095).astype(np.uint16)


def beam(rng):
    """Light of a frame: a beam, and a speckle that is new in every frame."""
    y, x = np.mgrid[-1 : 1 : SHAPE[0] * 1j, -1 : 1 : SHAPE[1] * 1j]
    return 1500 * np.exp(-(x**2 + y**2) / 2) * (1 + 0.05 * rng.normal(size=SHAPE))


class Bench:
    """Two cameras whose pixels respond with 1 %."""

    def __init__(self, seed=1, response=0.01):
        self.rng = np.random.default_rng(seed)
        self.response = [1 + response * self.rng.normal(size=SHAPE) for _ in range(2)]

    def camera(self, *, darks=None, flat=None, frames=None, number=0):
        rng, response = self.rng, self.response[number]
        darks = pages(rng, np.zeros(SHAPE), 4) if darks is None else darks
        flat = pages(rng, 2000 * response, 6) if flat is None else flat
        frames = response if frames is None else frames
        view = ViewSum(SHAPE)
        for _ in range(8):
            view.add(pages(rng, beam(rng) * frames, 1)[0])
        name, empty = f"camera{number + 1}", np.zeros(4096, np.int64)
        measured = measure_camera(
            darks=darks, flats=flat, histogram=empty, shape=SHAPE, camera=name
        )
        return replace(measured, view=view.mean())


def combine(*cameras):
    return make_references(cameras, declared=[DeclaredNoise(GAIN, 8.0)] * 2).references


def faults(one, two):
    return [str(note) for note in find_reference_faults([one, two], combine(one, two))]


@pytest.fixture
def bench():
    return Bench()


@pytest.mark.parametrize("seed", range(5))
def test_a_good_bench_has_no_fault(seed):
    bench = Bench(seed)
    assert faults(bench.camera(), bench.camera(number=1)) == []


def changing(bench):
    return np.concatenate([pages(bench.rng, np.full(SHAPE, 60.0 * (k > 1)), 1) for k in range(4)])


FAULTS = {
    "foreign flat": (
        lambda b: {"flat": pages(b.rng, 2000 * (1 + 0.01 * b.rng.normal(size=SHAPE)), 6)},
        "camera1: the frames do not show the response of the pixels",
    ),
    # 3 % of the whole, 3.1 % of the rest
    "lit dark": (
        lambda b: {"darks": pages(b.rng, 0.03 * beam(b.rng), 4)},
        "camera1: the dark shows 3.",
    ),
    "changing dark": (lambda b: {"darks": changing(b)}, "dark level changes by 34."),
    "few darks": (
        lambda b: {"darks": pages(b.rng, np.zeros(SHAPE), 2)},
        "camera1: 2 dark pages, the other camera has 4",
    ),
    "few flats": (
        lambda b: {"flat": pages(b.rng, 2000 * b.response[0], 5)},
        "camera1: 5 flat pages, the other camera has 6",
    ),
    # the outer of eight blocks are 1/16 of the width from the edge
    "tilted flat": (
        lambda b: {"flat": pages(b.rng, 2000 * np.linspace(0.75, 1.25, 128) * b.response[0], 6)},
        "camera1 and camera2: the ratio is wrong by -",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_camera_1_is_the_only_one_reported(bench, fault):
    taken, words = FAULTS[fault]
    (note,) = faults(bench.camera(**taken(bench)), bench.camera(number=1))
    assert words in note


def test_share_of_the_flat_in_the_frames_is_one_within_its_error(bench):
    one, two = bench.camera(), bench.camera(number=1)
    references = combine(one, two)
    for n, measured in enumerate((one, two)):
        own = find_share(measured.view, measured, references, n)
        other = find_share(measured.view, measured, references, 1 - n)
        assert abs(own.value - 1) < 4 * own.std
        assert abs(other.value) < 4 * other.std
        assert own.std < 0.1


def test_a_dark_brighter_than_the_frames_is_refused(bench):
    darks, flat = (pages(bench.rng, n * bench.response[0], 4) for n in (2000, 3500))
    with pytest.raises(FrameError, match="brighter than its dark"):
        faults(bench.camera(darks=darks, flat=flat), bench.camera(number=1))


def test_even_light_has_no_shape_to_find_in_the_dark():
    """Frames of one count, as a program writes them."""
    histogram = np.zeros(4096, np.int64)
    histogram[900] = 64 * 64
    dark = np.full((64, 64), 64, np.uint16)
    camera = measure_camera(
        darks=iter([dark, dark]), flats=[], histogram=histogram, shape=dark.shape, camera="camera1"
    )
    total = ViewSum(dark.shape)
    total.add(np.full(dark.shape, 900, np.uint16))
    camera = replace(camera, view=total.mean())
    assert faults(camera, camera) == []


def test_a_last_light_level_with_fewer_pages_is_reported(bench):
    cameras = []
    for number in range(2):
        response = bench.response[number]
        flat = [*pages(bench.rng, 1000 * response, 3), *pages(bench.rng, 2000 * response, 1)]
        cameras.append(bench.camera(flat=flat, number=number))
    notes = faults(*cameras)
    assert len(notes) == 2
    assert all("1 page at the last light level of the flat, 3 and" in note for note in notes)


def test_a_flat_with_the_beam_of_the_laser_is_reported(bench):
    y, x = np.mgrid[-1 : 1 : SHAPE[0] * 1j, -1 : 1 : SHAPE[1] * 1j]
    shape = np.exp(-(x**2 + y**2) / 2)
    cameras = [
        bench.camera(flat=pages(bench.rng, 2500 * shape * bench.response[n], 6), number=n)
        for n in range(2)
    ]
    notes = faults(*cameras)
    assert [note.split(":")[0] for note in notes] == ["camera1", "camera2"]
    assert all("an evenly lit target" in note for note in notes)
