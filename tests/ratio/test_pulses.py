"""Pairs whose images belong to different laser pulses, on synthetic light."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from erlif.ratio import find_pulse_faults, sample_pulse

COUNT = 12


@pytest.fixture
def rng():
    return np.random.default_rng(8)


def recording(rng, *, speckle=0.08, light=1000.0, gain=0.2, order=None, surface=0.05):
    """Samples of pairs with a film that changes, marks, new speckle and shot noise."""
    shape = (96, 128)
    x = np.arange(shape[1])
    marks = surface * gaussian_filter(rng.normal(size=shape), 3) * 10
    grains = [gaussian_filter(rng.normal(size=shape), 1.2) for _ in range(COUNT)]
    pulses = [speckle * grain / grain.std() for grain in grains]
    order = range(COUNT) if order is None else order

    samples = []
    for k, n in enumerate(order):
        film = 5 + 2 * np.sin(k / 3) + ((x - 60) / 40) ** 2 + marks
        one = light * film / 5 * np.exp(pulses[k])
        two = light * (film / 5) ** 1.3 * np.exp(pulses[n])
        noisy = [rng.poisson(np.maximum(image, 0) / gain) * gain for image in (one, two)]
        ratio = np.log(np.maximum(noisy[1], 1) / np.maximum(noisy[0], 1))
        samples.append(
            sample_pulse(
                noisy[0].astype(np.float32), ratio.astype(np.float32), np.zeros(shape, np.uint8)
            )
        )
    return samples


@pytest.mark.parametrize("light", [1000.0, 100.0, 30.0])
@pytest.mark.parametrize("speckle", [0.0, 0.01, 0.08, 0.3])
def test_true_pairs_have_no_fault(rng, light, speckle):
    assert find_pulse_faults(recording(rng, light=light, speckle=speckle)) == []


EXCHANGED = [0, 1, 2, 9, 4, 5, 6, 7, 8, 3, 10, 11]


@pytest.mark.parametrize("light", [1000.0, 100.0])
def test_two_exchanged_images_are_found_with_their_partners(rng, light):
    (fault,) = find_pulse_faults(recording(rng, order=EXCHANGED, light=light))
    assert (fault.kind, fault.frames, fault.partners) == ("exchanged", (3, 9), (9, 3))


@pytest.mark.parametrize("lag", [-3, -1, 1, 2])
def test_a_late_camera_is_found_with_its_lag_and_a_reversed_one(rng, lag):
    (fault,) = find_pulse_faults(recording(rng, order=(np.arange(COUNT) - lag) % COUNT))
    assert (fault.kind, fault.lag) == ("late", lag)
    (fault,) = find_pulse_faults(recording(rng, order=range(COUNT)[::-1]))
    assert fault.kind == "reversed"


def test_copies_of_a_frame_are_found(rng):
    samples = recording(rng)
    samples[7] = samples[2]
    (fault,) = find_pulse_faults(samples)
    assert (fault.kind, fault.frames) == ("repeated", (2, 7))


def test_small_frames_and_frames_without_valid_pixels_are_not_judged():
    dark = np.zeros((64, 64), np.float32)
    flagged = sample_pulse(dark, dark, np.full(dark.shape, 2, np.uint16))
    small = sample_pulse(dark[:40], dark[:40], np.zeros((40, 64), np.uint8))
    assert np.isnan(flagged.light).all()
    assert np.isnan(small.light).all()
    assert find_pulse_faults([flagged, small] * 4) == []


def test_exchanged_images_are_found_beside_one_of_an_unknown_pulse(rng):
    samples, other = recording(rng, order=EXCHANGED), recording(rng)
    samples[6] = samples[6]._replace(
        log_ratio=samples[6].log_ratio + other[6].light_again - samples[6].light_again
    )
    exchanged, unknown = find_pulse_faults(samples)
    assert (exchanged.kind, exchanged.frames) == ("exchanged", (3, 9))
    assert (unknown.kind, unknown.frames, unknown.partners) == ("unknown", (6,), (-1,))
