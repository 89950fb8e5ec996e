"""A run in real time: the same bytes at the wanted times, and the faults that are asked for."""

import threading
import time

import numpy as np
import pytest
import tifffile

from erlif.core.errors import ModelError
from erlif.rig.live import Fault, dim_light, write_live
from tests.conftest import snapshot


def test_the_run_ends_as_it_was(lab):
    before = snapshot(lab.run)
    begun = time.monotonic()
    write_live(lab.run, rate=20.0, gain=4.4, read_noise=9.0, delay=0.2)
    assert time.monotonic() - begun > 0.2 + 5 / 20
    assert snapshot(lab.run) == before
    assert [path.name for path in lab.directory.iterdir() if path.name.startswith(".")] == []


def test_frames_and_rows_come_one_after_the_other(lab):
    writer = threading.Thread(
        target=write_live,
        args=(lab.run,),
        kwargs={"rate": 5.0, "gain": 4.4, "read_noise": 9.0, "delay": 0.5},
    )
    writer.start()
    time.sleep(0.3)
    assert lab.frames(1) == []
    assert len((lab.run / "encoder.csv").read_text().splitlines()) == 1
    seen = set()
    while writer.is_alive():
        seen.add(len(lab.frames(2)))
        time.sleep(0.02)
    assert {1, 2, 3, 4, 5} <= seen
    writer.join()


def test_a_camera_stops_and_another_loses_a_frame(lab):
    faults = [Fault("camera2-stops", 4), Fault("camera1-loses", 2)]
    write_live(lab.run, rate=100.0, gain=4.4, read_noise=9.0, faults=faults)
    assert [path.name[-5] for path in lab.frames(1)] == list("01345")
    assert [path.name[-5] for path in lab.frames(2)] == list("0123")


def test_the_light_of_a_fading_laser_falls_and_the_dark_stays(lab):
    before = [tifffile.imread(path).astype(float) for path in lab.frames(1)]
    log = (lab.run / "encoder.csv").read_text().splitlines()
    write_live(lab.run, rate=100.0, gain=4.4, read_noise=9.0, faults=[Fault("laser-fades", 3)])
    after = [tifffile.imread(path).astype(float) for path in lab.frames(1)]
    meter = [
        float(new.split(",")[-1]) / float(old.split(",")[-1])
        for old, new in zip(log, (lab.run / "encoder.csv").read_text().splitlines(), strict=True)
        if not old.startswith("frame")
    ]
    assert meter == pytest.approx([1, 1, 1, 1, 0.97, 0.97**2], abs=1e-4)
    shares = [
        np.median(new - 64) / np.median(old - 64) for old, new in zip(before, after, strict=True)
    ]
    assert shares == pytest.approx([1, 1, 1, 1, 0.97, 0.97**2], abs=1e-3)


def test_a_weaker_pulse_has_the_noise_of_its_electrons():
    gain, read_noise, electrons, energy = 4.4, 9.0, 6000, 0.25
    rng = np.random.default_rng(3)
    noisy = rng.poisson(electrons, (400, 400)) + rng.normal(0, read_noise, (400, 400))
    weak = gain * np.rint(dim_light(np.rint(noisy / gain), energy, gain, read_noise, rng))
    assert weak.mean() == pytest.approx(energy * electrons, rel=1e-3)
    # photons, electronics, and two roundings to whole counts
    rounding = gain**2 / 12 * (1 + energy**2)
    assert weak.var() == pytest.approx(energy * electrons + read_noise**2 + rounding, rel=0.02)


@pytest.mark.parametrize("text", ["camera3-stops@4", "laser-fades", "camera1-loses@x", ""])
def test_a_fault_of_another_form_is_refused(text):
    with pytest.raises(ModelError, match="camera2-stops@40"):
        Fault.read(text)
