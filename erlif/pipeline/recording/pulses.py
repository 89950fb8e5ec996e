"""The laser pulses: their energy in the log, and frame pairs whose images show different ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from erlif.calibration import RunCurve
from erlif.core.arrays import Array
from erlif.core.errors import FrameError
from erlif.core.notes import Note, list_some, warn
from erlif.core.products import EncoderLog
from erlif.io.ingest import FramePairs, read_pair
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.engines.engine import Threads
from erlif.pipeline.engines.results import FrameResult
from erlif.pipeline.passes import measure_pulse
from erlif.ratio import PulseFault, PulseSample, find_pulse_faults
from erlif.thickness import FilmTables

# Names under which a log holds the energy of each pulse; the first one found is used.
ENERGY_COLUMNS = ("pulse_energy", "laser_energy", "pulse_energy_mJ", "laser_energy_mJ", "laser_mJ")

# Pairs at the end of a recording by which a disorder of the first ones is confirmed.
_LAST = 12


class PulseError(FrameError):
    """A recording whose cameras show different laser pulses."""


def read_energies(log: EncoderLog) -> Array | None:
    """Energy of each pulse over the mean of the run.

    Parameters
    ----------
    log : EncoderLog

    Returns
    -------
    array, (frame,), or None
        None where the log has no such column, or one with text, with a negative value or with
        zeros alone. [1]

    Examples
    --------
    >>> import xarray as xr
    >>> log = EncoderLog(xr.Dataset({"laser_mJ": ("frame", [49.0, 51.0])}))
    >>> read_energies(log)
    array([0.98, 1.02])
    """
    for name in ENERGY_COLUMNS:
        if name not in log:
            continue
        energy = log[name].values
        if not np.issubdtype(energy.dtype, np.number) or not np.isfinite(energy).all():
            return None
        if energy.min() < 0 or energy.max() == 0:
            return None
        return np.asarray(energy / energy.mean(), float)
    return None


def complete_energies(chain: FrameChain, calibration: RunCurve) -> FrameChain:
    """Estimate the energy of each pulse from the light of its film, if the log has none.

    Only the light of a dry joint is scaled by it. The film of the mean energy is good enough: where
    the dry joint has 3 % of the light, a pulse that is 10 % off is known to 0.3 %.

    Parameters
    ----------
    chain : FrameChain
    calibration : RunCurve

    Returns
    -------
    FrameChain
        The same where the dry joint was not photographed, or the energies are known. A frame whose
        energy is not found has that of the mean.
    """
    correct, frames = chain.correct, chain.pairs.usable
    if "background_recorded" not in correct.references or correct.energies is not None:
        return chain

    tables, model = FilmTables.of(calibration), calibration.model
    energies = np.full(len(chain.pairs.pages[0]), np.nan)
    Threads().compute(
        lambda frame: measure_pulse(chain.measure(frame), tables, model=model),
        frames,
        energies.__setitem__,
    )
    if np.isfinite(energies).any():
        energies /= np.nanmean(energies)
    energies = np.nan_to_num(energies, nan=1.0)
    return replace(chain, correct=replace(correct, energies=energies))


def refuse_stuck_cameras(pairs: FramePairs) -> None:
    """Refuse a recording in which a camera has one image for all pulses, or both have the same.

    Two exposures never agree to the last count. The ratio of a stuck camera may look like that of
    exchanged cameras, so that this comes first; where all is well, it reads two frame pairs.

    Parameters
    ----------
    pairs : FramePairs

    Raises
    ------
    PulseError
        Names the camera.
    """
    first, *others = pairs.usable
    if not others:
        return
    known, stuck = read_pair(pairs, first).counts, {1, 2}
    copied = np.array_equal(*known)

    # the last one first: a camera may hang for some pulses and go on. Copies at both ends are those
    # of all pairs only with a copy in the middle
    middle = others[len(others) // 2]
    for frame in reversed(others):
        counts = read_pair(pairs, frame).counts
        copied = copied and np.array_equal(*counts)
        stuck -= {n + 1 for n in range(2) if not np.array_equal(known[n], counts[n])}
        if not stuck and copied and np.array_equal(*read_pair(pairs, middle).counts):
            raise PulseError(
                "Expected two bands of light in every frame pair; both cameras show the same "
                "image. Correct files in [camera1] or [camera2], or export the cameras again."
            )
        if not stuck:
            return
    if len(stuck) == 2:
        raise PulseError(_one_image(len(pairs.usable), [page.name for page in pairs.pages[0]]))
    raise PulseError(_missing_in_camera(stuck.pop(), len(pairs.usable), pairs))


def check_pulses(
    frames: Sequence[FrameResult], pairs: FramePairs, *, copies: bool = True
) -> list[Note]:
    """Refuse a recording whose cameras show different pulses in a pair.

    Parameters
    ----------
    frames : sequence of FrameResult
    pairs : FramePairs
    copies : bool
        Whether images that are repeated have a note.

    Returns
    -------
    list of Note
        Images that are repeated, and pairs for which no other partner is found.

    Raises
    ------
    PulseError
        If camera 2 is late, early or reversed as a whole, if images of it are exchanged, or if all
        pairs are copies of one.
    """
    ordered = sorted(frames, key=lambda one: one.frame)
    numbers = [one.frame for one in ordered]
    repeated = _check_stuck(ordered, pairs)
    notes = []
    for fault in find_pulse_faults([one.pulse for one in ordered]):
        if fault.kind == "repeated":
            named = [numbers[k] for k in fault.frames]
            repeated.append(_describe_repeated(named, len(ordered), pairs))
        elif _is_minor(fault, len(ordered)):
            notes.append(_describe_unknown(fault, numbers))
        else:
            raise PulseError(_describe_order(fault, numbers, pairs))
    return [*(repeated if copies else []), *notes]


def check_first_pulses(
    frames: Sequence[FrameResult], pairs: FramePairs, measure: Callable[[int], PulseSample]
) -> None:
    """Refuse a long recording early, where the rest of it cannot change the verdict.

    A camera that was stuck at first, or pairs that are wrong at first alone, are left to
    `check_pulses` at the end of the work, which warns of them.

    Parameters
    ----------
    frames : sequence of FrameResult
        The first ones.
    pairs : FramePairs
    measure : callable
        Number of a frame pair to its sample; it is called for the last pairs where the first ones
        are in disorder.

    Raises
    ------
    PulseError
        If images of camera 2 are exchanged, or the first and the last pairs are in disorder.
    """
    ordered = sorted(frames, key=lambda one: one.frame)
    for fault in find_pulse_faults([one.pulse for one in ordered]):
        if fault.kind == "repeated" or _is_minor(fault, len(ordered)):
            continue
        last = pairs.usable[-_LAST:]
        if fault.kind == "exchanged" or _is_disordered([measure(frame) for frame in last]):
            raise PulseError(_describe_order(fault, [one.frame for one in ordered], pairs))


def _is_minor(fault: PulseFault, count: int) -> bool:
    """Whether a few pairs without a partner are wrong, and not the order as a whole."""
    return fault.kind == "unknown" and 2 * len(fault.frames) <= count


def _is_disordered(samples: Sequence[PulseSample]) -> bool:
    """Whether most of these pairs show different pulses."""
    faults = (fault for fault in find_pulse_faults(samples) if fault.kind != "repeated")
    return any(not _is_minor(fault, len(samples)) for fault in faults)


def _describe_unknown(fault: PulseFault, numbers: list[int]) -> Note:
    """Warn of images of camera 2 that show another pulse where no exchange corrects them."""
    shown = sorted({numbers[n] for n in fault.partners if n >= 0})
    of_pulse = "no frame of camera 1 shows that pulse"
    if shown:
        of_pulse = f"the pulses of pairs {list_some(shown)} are among those shown twice"
    return warn(
        f"frame pairs {list_some(numbers[k] for k in fault.frames)}",
        f"camera 2 shows another laser pulse than camera 1, and {of_pulse}: the film of these "
        "pairs is wrong by the speckle of the laser. Check the triggering of the cameras, and "
        "leave these pairs out",
    )


def _check_stuck(ordered: Sequence[FrameResult], pairs: FramePairs) -> list[Note]:
    """Refuse a camera all of whose files are the same, and note files that are copies."""
    notes = []
    # pairs that are repeated in both cameras have a note of their own
    both = [one.digests for one in ordered if all(one.digests)]
    for camera in range(2):
        known = [one.digests[camera] for one in ordered if one.digests[camera]]
        copies = len(known) - len(set(known)) - (len(both) - len(set(both)))
        if copies < 1:
            continue
        if len(set(known)) == 1 and len(known) == len(ordered):
            raise PulseError(_missing_in_camera(camera + 1, len(known), pairs))
        text = (
            f"{copies} of {len(known)} files are copies of others: the camera was stuck, or its "
            "export; their maps combine two pulses"
        )
        notes.append(warn(f"camera{camera + 1}", text))
    return notes


def _missing_in_camera(camera: int, count: int, pairs: FramePairs) -> str:
    one, two = pairs.pages[camera - 1][:2]
    return (
        f"Expected a new exposure in every frame; all {count} frames of camera{camera} are the "
        f"same ({one.name}, {two.name}, ...): the camera or its export was stuck. Record the run "
        "again, or export it again."
    )


def _one_image(count: int, names: Sequence[str]) -> str:
    return (
        f"Expected a new exposure in every frame pair; all {count} pairs show the same image "
        f"({names[0]}, {names[1]}, ...). Export the recording again, one frame for each pulse."
    )


def _describe_repeated(frames: list[int], count: int, pairs: FramePairs) -> Note:
    names = [pairs.pages[0][k].name for k in frames]
    if len(frames) == count > 1:
        raise PulseError(_one_image(count, names))
    return warn(
        f"frame pairs {list_some(frames)}",
        "they show the same image to the last count: a camera or its export was stuck, or a file "
        "was copied. Each is used as if it were a new exposure",
    )


def _describe_order(fault: PulseFault, numbers: list[int], pairs: FramePairs) -> str:
    """Describe a wrong order of camera 2 and how to correct it."""
    described = (
        "the frames of camera 2 are in reverse order. Number them in the order of the pulses."
    )
    if fault.kind == "unknown":
        described = (
            f"in {len(fault.frames)} of {len(numbers)} pairs camera 2 shows another pulse, in no "
            "simple order. Check the triggering of the cameras and the numbers of the files."
        )
    elif fault.kind == "late":
        number, late = abs(fault.lag), fault.lag > 0
        pulses = "one pulse" if number == 1 else f"{number} pulses"
        frames = "frame" if number == 1 else f"{number} frames"
        first, last = (2, 1) if late else (1, 2)
        described = (
            f"camera 2 is {pulses} {'late' if late else 'early'}. Remove the first {frames} of "
            f"camera {first} and the last {frames} of camera {last}; where a log has a row for "
            "each pair, remove those of the pairs lost as well."
        )
    elif fault.kind == "exchanged":
        one, two = pairs.pages
        pairing = [
            f"{two[numbers[k]].name} shows the pulse of {one[numbers[n]].name}"
            for k, n in zip(fault.frames, fault.partners, strict=True)
        ]
        described = (
            f"images of camera 2 are exchanged: {list_some(pairing)}. Give them the numbers of "
            "their pulses."
        )
    return f"Expected both cameras to show the same laser pulse in every frame pair; {described}"
