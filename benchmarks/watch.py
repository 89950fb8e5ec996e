"""`erlif watch` while another process writes frames: pairs a second, age of the map, memory.

A run of the virtual rig is written again and again, at a fixed rate, under new names; a real
browser shows the page. The age of a map is the time from the end of writing its second file to the
map on the page. Pairs that are not shown were passed by a newer one.

    python benchmarks/watch.py --size 1280x1024 --rate 20 --pairs 5000 --scratch /tmp/watch

Pairs of 1280x1024 at 20 a second are 105 MB/s; 5000 take 26 GB.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
import tifffile

from erlif import calibrate, save_calibration
from erlif.rig import RigSettings, simulate

_BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))))

# Notes when the page shows another map.
_OBSERVE = """() => {
  window.seen = [];
  new MutationObserver(() => {
    requestAnimationFrame(() => window.seen.push([document.body.dataset.shown, Date.now()]));
  }).observe(document.body, { attributes: true, attributeFilter: ["data-shown"] });
}"""


def plain(path: Path) -> bytes:
    """A frame as camera software writes it, without compression."""
    file = io.BytesIO()
    tifffile.imwrite(file, tifffile.imread(path), photometric="minisblack")
    return file.getvalue()


def write_frames(kept: Path, run: Path, rate: float, pairs: int) -> None:
    """Write `pairs` pairs at a rate, and the time at which each was complete as JSON."""
    content = {n: [plain(path) for path in sorted((kept / f"camera{n}").iterdir())] for n in (1, 2)}
    times = []
    begun = time.time()
    for k in range(pairs):
        time.sleep(max(0.0, begun + k / rate - time.time()))
        for n in (1, 2):
            images = content[n]
            (run / f"camera{n}" / f"frame_{k:05d}.tif").write_bytes(images[k % len(images)])
        times.append(time.time())
    (kept / "times.json").write_text(json.dumps(times))


def memory_of(process: int) -> float:
    """Resident memory of a process. [MB]"""
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def seconds_of(process: int) -> float:
    """Processor time of a process so far. [s]"""
    fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def seconds_of_browsers() -> float:
    """Processor time of all processes of the browser so far. [s]"""
    total = 0.0
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if b"chrom" in (folder / "cmdline").read_bytes().split(b"\0")[0]:
                total += seconds_of(int(folder.name))
    return total


def prepare(scratch: Path, width: int, height: int) -> tuple[Path, Path]:
    """The frames that are written, and the run directory that receives them."""
    rig = RigSettings(width=width, height=height, fixture_frames=4)
    simulate(scratch, seed=27, rig=rig)
    save_calibration(calibrate(scratch / "fixture"), scratch / "fixture" / "calibration.nc")
    run, kept = scratch / "run", scratch / "kept"
    kept.mkdir()
    for n in (1, 2):
        shutil.move(run / f"camera{n}", kept / f"camera{n}")
        (run / f"camera{n}").mkdir()
    return kept, run


def follow(run: Path, kept: Path, rate: float, pairs: int, browser: bool) -> None:
    """Start the watch, the browser and the writer, and print what was measured."""
    command = [sys.executable, "-m", "erlif", "watch", str(run), "--no-browser"]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    watch = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert watch.stdout is not None
    address = next(found[0] for line in watch.stdout if (found := re.search(r"http://\S+", line)))
    threading.Thread(target=watch.stdout.read, daemon=True).start()

    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        page = None
        if browser:
            opened = driver.chromium.launch(executable_path=_BROWSER, args=["--no-sandbox"])
            page = opened.new_page(viewport={"width": 1280, "height": 1000})
            page.goto(address)
            page.evaluate(_OBSERVE)
        writer = subprocess.Popen(
            [sys.executable, __file__, "--write", str(kept), str(run), str(rate), str(pairs)]
        )
        memory: list[float] = []
        spent, drawn = seconds_of(watch.pid), seconds_of_browsers()
        while writer.poll() is None:
            time.sleep(0.5)
            memory.append(memory_of(watch.pid))
        times = json.loads((kept / "times.json").read_text())
        state = page.request if page is not None else driver.request.new_context()
        end = time.time()
        news = json.loads(state.get(f"{address}news?version=-1&pairs={pairs}&angles=0").text())
        at_end = news["measured"]
        while news["measured"] < pairs and time.time() - end < 600:
            time.sleep(0.2)
            news = json.loads(state.get(f"{address}news?version=-1&pairs={pairs}&angles=0").text())
        rest = time.time() - end
        spent = seconds_of(watch.pid) - spent
        drawn = seconds_of_browsers() - drawn
        seen = [] if page is None else page.evaluate("window.seen")
        watch.terminate()
        watch.wait()

    print(f"{pairs} pairs at {rate:g} a second, written in {times[-1] - times[0]:.1f} s")
    print(f"measured at the end of writing: {at_end}; the rest took {rest:.1f} s more")
    print(
        f"processor time of the watch: {spent / pairs:.3f} s a pair; "
        f"of the browser: {drawn / (times[-1] - times[0] + rest):.2f} s a second"
    )
    quarter = max(len(memory) // 4, 1)
    second, last = np.mean(memory[quarter : 2 * quarter]), np.mean(memory[-quarter:])
    print(
        f"memory: {max(memory):.0f} MB at most, {second:.0f} MB in the second quarter, "
        f"{last:.0f} MB in the last"
    )
    if seen:
        shown = {
            int(text.split()[1].rstrip(",")): stamp / 1e3 for text, stamp in reversed(seen) if text
        }
        # the start, in which cameras are registered, stands apart
        ages = np.array([shown[k] - times[k] for k in shown if times[k] > times[0] + 5])
        first = min(shown.values()) - times[0]
        print(f"first map {first:.1f} s after the first pair; {len(shown)} of {pairs} maps shown")
        if ages.size:
            median, most = np.percentile(1e3 * ages, [50, 95])
            print(f"age of a map: {median:.0f} ms in the median, {most:.0f} ms at 95 %")


def main() -> None:
    """Measure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="1280x1024")
    parser.add_argument("--rate", type=float, default=20.0)
    parser.add_argument("--pairs", type=int, default=1000)
    parser.add_argument("--no-browser", action="store_true")
    parser.add_argument("--scratch", type=Path, help="kept and used again")
    parser.add_argument("--write", nargs=4, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.write:
        kept, run, rate, pairs = options.write
        write_frames(Path(kept), Path(run), float(rate), int(pairs))
        return
    with tempfile.TemporaryDirectory() as folder:
        scratch = options.scratch or Path(folder)
        if (scratch / "kept").is_dir():
            kept, run = scratch / "kept", scratch / "run"
            for n in (1, 2):
                shutil.rmtree(run / f"camera{n}")
                (run / f"camera{n}").mkdir()
        else:
            width, height = map(int, options.size.split("x"))
            kept, run = prepare(scratch, width, height)
        follow(run, kept, options.rate, options.pairs, not options.no_browser)


if __name__ == "__main__":
    main()
