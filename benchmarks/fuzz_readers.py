"""Long runs of damaged files through the readers, by hand.

Run with ``python benchmarks/fuzz_readers.py --minutes 10 tiff "tiff lzw"``; without names,
all formats are run. ``--list`` shows them. Each damaged file must give counts of the stated kind
or FrameError, within a second and 100 MB. A file that does not is kept in the folder of ``--keep``,
to be made a test. The damages are those of tests/readers/mutations.py; CI runs each for a second.
"""

from __future__ import annotations

import argparse
import faulthandler
import resource
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from readers.mutations import SAMPLES, check_reader, mutate

# compiled decoders are loaded here, so that their memory is not that of a file
import erlif.readers.lzw
import erlif.readers.unpack  # noqa: F401

SLOW = 1.0
"""Time of the processor for one file that is reported. [s]"""

HANGS = 60
"""Duration of one file after which the run ends with a traceback. [s]"""

LARGE = 100
"""Growth of the memory of the program that is reported. [MB]"""


def memory() -> float:
    """Highest memory of this process so far. [MB]"""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def run(name: str, minutes: float, keep: Path, seed: int) -> int:
    """Damage files of one format for some minutes; the number of findings."""
    write, damaged = SAMPLES[name]
    findings, executions, slowest = 0, 0, 0.0
    outcomes: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        path = write(Path(folder))
        target = Path(folder, damaged)
        whole = target.read_bytes()
        check_reader(path)

        rng = np.random.default_rng([seed, *name.encode()])
        before, end = memory(), time.monotonic() + 60 * minutes
        while time.monotonic() < end:
            content = mutate(whole, rng)
            target.write_bytes(content)
            faulthandler.dump_traceback_later(HANGS, exit=True)
            # the time of the processor, because other programs may run beside
            start, fault = time.process_time(), ""
            try:
                outcomes[check_reader(path)] += 1
            except Exception:
                fault = traceback.format_exc(limit=-4)
            duration = time.process_time() - start
            slowest, executions = max(slowest, duration), executions + 1
            if duration > SLOW:
                fault = f"{duration:.1f} s\n"
            if memory() > before + LARGE:
                fault, before = f"{memory() - before:.0f} MB\n", memory()
            if fault:
                findings += 1
                place = keep / f"{name.replace(' ', '_')}_{executions}{target.suffix}"
                place.write_bytes(content)
                print(f"{place}: {fault}", flush=True)
        faulthandler.cancel_dump_traceback_later()

    parts = ", ".join(f"{outcome} {count}" for outcome, count in outcomes.most_common())
    print(f"{name}: {executions} files, {findings} findings; {parts}; slowest {slowest:.2f} s")
    sys.stdout.flush()
    return findings


def main() -> None:
    """Run the formats that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("formats", nargs="*", help="names of formats; default: all")
    parser.add_argument("--minutes", type=float, default=10.0, help="for each format")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, default=Path("findings"), help="folder for findings")
    parser.add_argument("--list", action="store_true", help="show the formats")
    options = parser.parse_args()
    if options.list:
        print("\n".join(SAMPLES))
        return
    unknown = set(options.formats) - set(SAMPLES)
    if unknown:
        parser.error(f"unknown: {', '.join(sorted(unknown))}; --list shows the formats")

    options.keep.mkdir(parents=True, exist_ok=True)
    found = sum(
        run(name, options.minutes, options.keep, options.seed)
        for name in options.formats or SAMPLES
    )
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
