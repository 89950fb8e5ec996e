"""Bands of a few frame pairs against the whole frames they are taken from."""

import numpy as np
import xarray as xr

from erlif.pipeline.recording import sample as module
from erlif.pipeline.recording.sample import choose_bands, compare_sharpness, sample_frames
from erlif.ratio import BlurMoments


def test_small_frames_are_taken_whole_and_a_quarter_of_large_ones():
    assert choose_bands((600, 800)) == [slice(0, 600)]
    for shape in ((1024, 1280), (1080, 1440), (2048, 2048), (1200, 1600)):
        bands = choose_bands(shape)
        assert len(bands) == 4
        assert all(band.stop - band.start == 64 for band in bands)
        # evenly spread, as far from the edges as half their distance
        middles = [(band.start + band.stop) / 2 for band in bands]
        assert np.ptp(np.diff([-middles[0], *middles, 2 * shape[0] - middles[-1]])) <= 4


def test_bands_hold_the_rows_of_the_whole_frame(prepared, monkeypatch):
    chain = prepared.chain
    bands = [slice(8, 30), slice(60, 90)]
    monkeypatch.setattr(module, "choose_bands", lambda shape: bands)
    sample = sample_frames(chain)[2]
    whole = chain.align(int(sample[0].frame[0]))[1]
    for band, rows in zip(sample, bands, strict=True):
        for name in ("signal", "signal_var", "signal_var_fixed", "flags"):
            xr.testing.assert_equal(band[name], whole[name].isel(y=rows))


def test_sharpness_of_bands_is_that_of_the_frames_within_its_uncertainty(prepared, monkeypatch):
    chain = prepared.chain
    moments = BlurMoments.empty()
    for frame in chain.pairs.usable:
        moments.add(chain.align(frame)[1])
    whole = moments.solve()
    monkeypatch.setattr(module, "choose_bands", lambda shape: [slice(20, 60)])
    found = compare_sharpness(chain, sample_frames(chain))
    assert found.std_x > whole.std_x
    for axis in "xy":
        difference = getattr(found, axis) - getattr(whole, axis)
        assert abs(difference) < 3 * getattr(found, f"std_{axis}")
