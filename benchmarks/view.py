"""Time and memory of the viewer on a long run: 5000 triggers of 1280 x 1024 pixels.

Run with ``python benchmarks/view.py DIRECTORY``, which needs 4 GB there and removes them. It
prints, for netCDF and zarr: the time from the command to its address and from the address to the
first map, the times of 40 new triggers, processor time of the server (with profile and statistics),
and the memory of server and page. Needs Chromium and the
packages of the extra ``test``. ``--triggers`` and ``--shape`` choose another run.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

FLAGS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)
CHANGES = 40
"""New triggers that are timed, far from each other, so that no map is in memory."""

SHOW = """(trigger) => new Promise((done) => {
  const canvas = document.querySelector("#panel-a canvas");
  const started = performance.now();
  const watch = new MutationObserver(() => {
    if (!canvas.dataset.text.startsWith(`trigger ${trigger},`)) return;
    watch.disconnect();
    requestAnimationFrame(() => setTimeout(() => done(performance.now() - started)));
  });
  watch.observe(canvas, { attributes: true });
  const slider = document.getElementById("trigger");
  slider.value = trigger;
  slider.dispatchEvent(new Event("input"));
})"""
"""From the movement of the slider until the new map is drawn. [ms]"""


def resident(pid: int) -> float:
    """Memory of a process. [MB]"""
    text = Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    return int(text.partition("VmRSS:")[2].split()[0]) / 1024


def processor_time(pid: int) -> float:
    """Processor time of a process. [s]"""
    text = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(text[11]) + int(text[12])) / os.sysconf("SC_CLK_TCK")


def measure(film: Path, triggers: int, chromium: str) -> None:
    """Print the figures of one film."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=list(FLAGS))
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        command = [sys.executable, "-m", "erlif", "view", "--no-browser", str(film)]
        started = time.perf_counter()
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            assert server.stdout is not None
            address = server.stdout.readline().split()[-1]
            up = time.perf_counter() - started
            page.goto(address)
            page.wait_for_selector("#panel-a canvas[data-text]")
            first = time.perf_counter() - started - up
            page.wait_for_selector("body[data-ready]")
            whole = time.perf_counter() - started - up

            opened = processor_time(server.pid)
            rng = np.random.default_rng(1)
            chosen = rng.choice(triggers, CHANGES, replace=False).tolist()
            times = []
            for trigger in chosen:
                times.append(page.evaluate(SHOW, trigger))
                page.wait_for_load_state("networkidle")
            heap = page.evaluate("performance.memory.usedJSHeapSize") / 2**20
            memory = resident(server.pid)
            each = (processor_time(server.pid) - opened) / CHANGES
            server.send_signal(signal.SIGINT)
            server.wait()
        browser.close()

    print(f"{film.name}")
    print(f"  command to address    {up:6.2f} s")
    print(f"  address to first map  {first:6.2f} s, with profile and cycle {whole:.2f} s")
    low, high = np.percentile(times, 50), np.percentile(times, 95)
    print(f"  new trigger           median {low:.0f} ms, 95 % {high:.0f} ms")
    print(f"  processor time        opening {opened:.2f} s, a new trigger {1e3 * each:.0f} ms")
    print(f"  memory                server {memory:.0f} MB, scripts of the page {heap:.0f} MB")
    print(f"  load of the machine   {os.getloadavg()[0]:.1f}")


def main() -> None:
    """Make the films, measure, remove them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=Path)
    parser.add_argument("--triggers", type=int, default=5000)
    parser.add_argument("--shape", type=int, nargs=2, default=(1024, 1280))
    options = parser.parse_args()
    names = ("chromium", "chromium-browser", "google-chrome")
    chromium = next(filter(None, map(shutil.which, names)), None)
    if chromium is None:
        sys.exit("This benchmark needs Chromium.")

    from scenes.long_film import write_long_film

    for name in ("long.nc", "long.zarr"):
        film = options.directory / name
        try:
            # noise shared by 2 x 2 pixels, so that 5000 maps take 3 GB
            write_long_film(film, triggers=options.triggers, shape=tuple(options.shape), grain=2)
            measure(film, options.triggers, chromium)
        finally:
            shutil.rmtree(film, ignore_errors=True) if film.is_dir() else film.unlink(True)


if __name__ == "__main__":
    main()
