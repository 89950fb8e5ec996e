"""Long runs of damaged files through the readers and the commands, by hand.

Run with ``python benchmarks/fuzz_readers.py --minutes 10 tiff "tiff lzw"``; without names,
all formats are run. ``--list`` shows them. Each damaged file of a camera must give counts of the
stated kind or FrameError, within a second and 100 MB; each damaged product, settings file or log
a result as documented or an ErlifError, within 20 s and 1 GB. A file that does not is kept in the
folder of ``--keep``, to be made a test. The damages are those of tests/scenes/mutations.py and
tests/damages/at_random.py; CI runs each for a second.

The files are read in a second process, because a library may end the process that reads.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import logging
import os
import resource
import select
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from damages.at_random import PRODUCTS, Product
from scenes.mutations import SAMPLES, check_reader, mutate

import erlif

# compiled decoders are loaded here, so that their memory is not that of a file
import erlif.io.readers.imx
from erlif.core.errors import ErlifError
from erlif.rig import RigSettings, simulate

HANGS = 60
"""Duration of one file after which the reading process is ended. [s]"""

ADDRESSES = 8 * 2**30
"""Memory that the reading process may ask for beyond its start. [byte]"""

LONGEST_FAULT = 3000
"""Length of a description of a finding. [character]"""

LONGEST_MESSAGE = 4000
"""Length of a message of erlif that is reported. [character]"""

RIG = RigSettings(
    width=128, height=96, spacing=8.0, fixture_frames=3, dark_pages=4, flat_pages=3, bubbles=0
)
"""The rig of the tests: six triggers of 128 x 96 pixels."""


@dataclass(frozen=True)
class Case:
    """Damaged files of one kind, prepared in a folder.

    Attributes
    ----------
    damage : Callable[[np.random.Generator], list[Path]]
        Puts whole files in place, damages one, and gives what is kept of a finding.
    use : Callable[[], str]
        Reads them; gives the outcome.
    slow, large : float
        Time of the processor [s] and growth of the memory [MB] that are reported.
    """

    damage: Callable[[np.random.Generator], list[Path]]
    use: Callable[[], str]
    slow: float
    large: float


@dataclass
class Tally:
    """What one kind of file came to."""

    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    largest: float = 0.0
    findings: int = 0

    @property
    def files(self) -> int:
        return self.outcomes.total()


def memory() -> float:
    """Highest memory of this process so far. [MB]"""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


# kinds of files


def reader_case(name: str, folder: Path) -> Case:
    """Files of a camera."""
    write, damaged = SAMPLES[name]
    path = write(folder)
    target = folder / damaged
    whole = target.read_bytes()

    def damage(rng: np.random.Generator) -> list[Path]:
        target.write_bytes(mutate(whole, rng))
        return [target]

    return Case(damage, lambda: check_reader(path), slow=1.0, large=100.0)


def product_case(name: str, folder: Path, rig: Path) -> Case:
    """A film, a calibration, settings or a log, and what is done with it."""
    product: Product = PRODUCTS[name]
    whole, work = folder / "whole", folder / "work"
    whole.mkdir()
    product.write(rig, whole)

    def damage(rng: np.random.Generator) -> list[Path]:
        shutil.rmtree(work, ignore_errors=True)
        shutil.copytree(whole, work)
        return [product.damage(work, rng)]

    def use() -> str:
        try:
            product.use(work)
        except ErlifError as error:
            if len(str(error)) > LONGEST_MESSAGE:
                raise AssertionError(f"long message: {str(error)[:200]}") from None
            return "refused"
        return "read"

    return Case(damage, use, slow=20.0, large=1000.0)


def make_rig(folder: Path) -> Path:
    """A run, its fixture, calibration and films."""
    simulate(folder, seed=11, rig=RIG)
    calibration = erlif.calibrate(folder / "fixture")
    erlif.save_calibration(calibration, folder / "fixture" / "calibration.nc")
    for suffix in ("nc", "zarr"):
        output = folder / "run" / f"film.{suffix}"
        erlif.process(folder / "run", calibration=calibration, output=output, workers=1).close()
    return folder


# the process that reads


def read_until(case: Case, end: float, rng: np.random.Generator, place: Path, answer: int) -> None:
    """Damage and read files, and write one line about each; the caller looks for its end."""
    soft = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 + ADDRESSES
    resource.setrlimit(resource.RLIMIT_AS, (soft, soft))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    logging.disable(logging.CRITICAL)
    faulthandler.enable()

    before = memory()
    while time.monotonic() < end:
        kept = case.damage(rng)
        os.write(answer, (json.dumps({"kept": [str(path) for path in kept]}) + "\n").encode())
        faulthandler.dump_traceback_later(HANGS - 2)
        # the time of the processor, because other programs may run beside
        start, fault, outcome = time.process_time(), "", "fault"
        try:
            outcome = case.use()
        except Exception:
            fault = traceback.format_exc(limit=-6)[-LONGEST_FAULT:]
        faulthandler.cancel_dump_traceback_later()
        duration, growth = time.process_time() - start, memory() - before

        if duration > case.slow:
            fault += f"{duration:.1f} s\n"
        if growth > case.large:
            fault += f"{growth:.0f} MB\n"
        line = {"outcome": outcome, "duration": duration, "growth": growth, "fault": fault}
        if fault:
            line["place"] = keep_files(kept, place)
        os.write(answer, (json.dumps(line) + "\n").encode())
        if growth > case.large:
            return  # the highest memory of a process does not fall again


def keep_files(paths: list[Path], place: Path) -> str:
    """Copy the files of a finding; the names of the copies."""
    names = []
    for path in paths:
        number = len(list(place.parent.glob(f"{place.name}_*")))
        kept = place.with_name(f"{place.name}_{number}_{path.name}")
        if path.is_file():
            shutil.copy(path, kept)
        names.append(str(kept))
    return ", ".join(names)


@contextmanager
def started(work: Callable[[int], None]) -> Iterator[tuple[int, int]]:
    """Run work in a child; gives its number and the pipe of its lines."""
    lines, answer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(lines)
        try:
            work(answer)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    os.close(answer)
    try:
        yield child, lines
    finally:
        os.close(lines)


def lines_of(child: int, pipe: int) -> Iterator[dict[str, Any]]:
    """Lines of the child until its end; the last one has its exit status."""
    rest = b""
    while True:
        if not select.select([pipe], [], [], HANGS)[0]:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            yield {"ended": f"hangs: no end after {HANGS} s"}
            return
        found = os.read(pipe, 65536)
        if not found:
            status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
            yield {"ended": "" if status == 0 else f"the process ended with the status {status}"}
            return
        *whole, rest = (rest + found).split(b"\n")
        yield from map(json.loads, whole)


# the run


def run(name: str, case: Case, minutes: float, keep: Path, seed: int) -> int:
    """Damage files of one kind for some minutes; the number of findings."""
    tally, begin = Tally(), time.monotonic()
    end, starts = begin + 60 * minutes, 0
    case.use()
    while time.monotonic() < end:
        rng = np.random.default_rng([seed, starts, *name.encode()])
        starts += 1
        kept: list[str] = []
        place = keep / f"{name.replace(' ', '_')}_{starts}"

        def work(answer: int, rng: np.random.Generator = rng, place: Path = place) -> None:
            read_until(case, end, rng, place, answer)

        with started(work) as (child, pipe):
            for line in lines_of(child, pipe):
                if "kept" in line:
                    kept = line["kept"]
                    continue
                if line.get("ended") == "":
                    break
                tally.outcomes[line.get("outcome", "ended")] += 1
                tally.slowest = max(tally.slowest, line.get("duration", 0))
                tally.largest = max(tally.largest, line.get("growth", 0))
                if fault := line.get("fault") or line.get("ended"):
                    tally.findings += 1
                    found = line.get("place") or keep_files([Path(one) for one in kept], place)
                    print(f"{found}: {fault}", flush=True)

    parts = ", ".join(f"{outcome} {count}" for outcome, count in tally.outcomes.most_common())
    print(
        f"{name}: {tally.files} files in {(time.monotonic() - begin) / 60:.1f} min, "
        f"{tally.findings} findings; {parts}; slowest {tally.slowest:.2f} s, "
        f"largest {tally.largest:.0f} MB",
        flush=True,
    )
    return tally.findings


def main() -> None:
    """Run the formats that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("formats", nargs="*", help="names of formats; default: all")
    parser.add_argument("--minutes", type=float, default=10.0, help="for each format")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, default=Path("findings"), help="folder for findings")
    parser.add_argument("--rig", type=Path, help="folder of a rig made before, or to be made")
    parser.add_argument("--list", action="store_true", help="show the formats")
    options = parser.parse_args()
    known = [*SAMPLES, *PRODUCTS]
    if options.list:
        print("\n".join(known))
        return
    unknown = set(options.formats) - set(known)
    if unknown:
        parser.error(f"unknown: {', '.join(sorted(unknown))}; --list shows the formats")

    options.keep.mkdir(parents=True, exist_ok=True)
    names = options.formats or known
    found = 0
    with tempfile.TemporaryDirectory() as folder:
        rig = options.rig or Path(folder, "rig")
        if not set(names) <= set(SAMPLES) and not rig.exists():
            make_rig(rig)
        for number, name in enumerate(names):
            place = Path(folder, str(number))
            place.mkdir()
            case = reader_case(name, place) if name in SAMPLES else product_case(name, place, rig)
            if name in PRODUCTS:
                shutil.copytree(place / "whole", place / "work")
            found += run(name, case, options.minutes, options.keep, options.seed)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
